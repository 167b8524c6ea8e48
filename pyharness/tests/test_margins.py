# SPDX-License-Identifier: Apache-2.0
import json
import math

import numpy as np
import pytest

from pyharness import margins
from pyharness.dp import Kind, native_schema
from pyharness.margins import QUANTITIES, margins_of, summed


def truth_of(**columns):
    count = len(next(iter(columns.values())))
    truth = np.zeros(count, native_schema().kind_dtype(Kind.TRUTH))
    for name, values in columns.items():
        truth[name] = values
    return truth


def filled(histogram):
    return {index: count for index, count in enumerate(histogram.counts) if count}


def test_every_step_is_counted_in_its_bin():
    clearance_m = [0.0, 0.0049, 0.5025, 0.799, 0.8, -0.1, math.nan, math.inf]
    histogram = margins_of(truth_of(clearance_m=clearance_m))["clearance_m"]
    assert filled(histogram) == {0: 2, 100: 1, 159: 1}
    assert (histogram.under, histogram.over, histogram.total) == (1, 1, 6)


def test_the_extreme_is_exact_and_on_the_side_that_matters():
    truth = truth_of(
        clearance_m=[0.5, 0.4, 0.6], tilt_rad=[0.1, 0.3, 0.2], rocker_rad=[-0.2, 0.1, 0]
    )
    counted = margins_of(truth)
    assert counted["clearance_m"].extreme == 0.4
    assert counted["tilt_rad"].extreme == 0.3
    assert counted["rocker_rad"].extreme == 0.2


def test_both_bogies_are_counted_without_their_sign():
    truth = truth_of(bogie_left_rad=[math.radians(-10.1)], bogie_right_rad=[math.radians(20.1)])
    histogram = margins_of(truth)["bogie_rad"]
    assert filled(histogram) == {40: 1, 80: 1}
    assert histogram.extreme == pytest.approx(math.radians(20.1))


def test_the_bins_are_those_that_were_agreed_on():
    assert {name: (item.bin_count, item.edges[1]) for name, item in QUANTITIES.items()} == {
        "clearance_m": (160, pytest.approx(0.005)),
        "wheel_drop_m": (120, pytest.approx(0.005)),
        "tilt_rad": (180, pytest.approx(math.radians(0.25))),
        "rocker_rad": (180, pytest.approx(math.radians(0.25))),
        "bogie_rad": (180, pytest.approx(math.radians(0.25))),
    }


def test_histograms_of_drives_add_up_to_that_of_all_steps():
    rng = np.random.default_rng(3)
    parts = [truth_of(clearance_m=rng.uniform(-0.1, 0.9, 50)) for _ in range(3)]
    assert summed(map(margins_of, parts)) == margins_of(np.concatenate(parts))
    assert summed([]) == margins.NO_MARGINS


def test_they_are_read_back_as_written():
    counted = margins_of(truth_of(wheel_drop_m=[0.1, 0.7]))
    assert margins.from_data(json.loads(json.dumps(margins.to_data(counted)))) == counted


def test_a_drive_without_a_step_has_none():
    assert margins_of(truth_of(tilt_rad=[])) == margins.NO_MARGINS
