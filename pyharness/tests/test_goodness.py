# SPDX-License-Identifier: Apache-2.0
import math
from dataclasses import replace

import numpy as np
import pytest

from pyharness.planners.goodness import Heights, Limits, goodness_map
from pyharness.status import Reason

CELL_M = 0.1
LIMITS = Limits(
    cell_heights=2,
    disc_radius_m=1.4,
    disc_known_min=0.4,
    step_window_m=0.6,
    tilt_max_rad=math.radians(20.0),
    roughness_max_m=0.1,
    step_max_m=0.3,
)


def heights_of(function, size_m=10.0):
    """Heights z down of a function of north and east, the middle at 0, 0."""
    count = round(size_m / CELL_M)
    first = -count // 2
    axis_m = (first + np.arange(count) + 0.5) * CELL_M
    north_m, east_m = np.meshgrid(axis_m, axis_m, indexing="ij")
    return Heights(np.asarray(function(north_m, east_m)) + 0.0 * north_m, first, first, CELL_M)


def judged(function, at=(0.05, 0.05), limits=LIMITS):
    goodness, reason = goodness_map(heights_of(function), limits).at(np.array([at]))
    return float(goodness[0]), int(reason[0])


def test_level_ground_is_as_good_as_can_be():
    assert judged(lambda n, _: 0.0 * n)[0] == pytest.approx(1.0)


def test_a_plain_slope_costs_its_tilt_alone_in_every_direction():
    strict = replace(LIMITS, step_max_m=0.1)
    for azimuth_rad in (0.0, 1.0, 2.5):
        slope = math.tan(math.radians(10.0))
        goodness, _ = judged(
            lambda n, e, a=azimuth_rad, s=slope: s * (n * math.cos(a) + e * math.sin(a)),
            limits=strict,
        )
        assert goodness == pytest.approx(0.5, abs=0.01)


def test_a_slope_over_the_limit_is_impassable_for_its_tilt():
    assert judged(lambda n, _: math.tan(math.radians(21.0)) * n) == (0.0, Reason.TILT)


def rock(north_m, east_m, height_m, radius_m):
    def ground(n, e):
        away_m = np.hypot(n - north_m, e - east_m)
        return np.where(away_m <= radius_m, -height_m, 0.0)

    return ground


def test_a_rock_is_a_step_for_every_place_whose_disc_holds_it():
    ground = rock(0.0, 1.2, 0.35, 0.15)
    assert judged(ground) == (0.0, Reason.WHEEL_DROP)
    assert judged(rock(0.0, 2.4, 0.35, 0.15))[0] == pytest.approx(1.0, abs=0.01)


def test_goodness_falls_with_the_height_of_a_rock():
    goodness = [judged(rock(0.0, 0.5, height_m, 0.2))[0] for height_m in (0.05, 0.15, 0.25)]
    assert goodness[0] > goodness[1] > goodness[2] > 0.0


def test_rough_ground_without_steps_is_impassable_for_its_roughness():
    # a wave as long as the disc: 0.15 m rms, at most 0.15 m of rise in a step's window
    smooth = replace(LIMITS, step_max_m=1.0)
    goodness, reason = judged(lambda n, _: 0.21 * np.cos(2 * np.pi * n / 2.8), limits=smooth)
    assert (goodness, reason) == (0.0, Reason.CLEARANCE)


def test_ground_that_is_hardly_seen_is_unknown():
    def ground(n, _):
        return np.where(n > 0.7, 0.0, np.nan)

    goodness, reason = judged(ground)
    assert math.isnan(goodness)
    assert reason == Reason.UNKNOWN
    assert judged(ground, at=(2.5, 0.0))[0] == pytest.approx(1.0)


def test_outside_the_map_all_is_unknown():
    goodness, reason = judged(lambda n, _: 0.0 * n, at=(20.0, 0.0))
    assert math.isnan(goodness)
    assert reason == Reason.UNKNOWN


def test_goodness_does_not_depend_on_how_high_the_ground_lies():
    ground = rock(0.3, 0.5, 0.2, 0.2)
    low = goodness_map(heights_of(ground), LIMITS).goodness
    high = goodness_map(heights_of(lambda n, e: ground(n, e) - 2500.0), LIMITS).goodness
    assert high == pytest.approx(low, abs=1e-6, nan_ok=True)
