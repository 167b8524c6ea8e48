# SPDX-License-Identifier: Apache-2.0
import random

import numpy as np
import pytest
from scipy import stats

from pyharness.campaign_pairs import METRICS, compare, holm, mcnemar, paired_difference
from pyharness.tests.campaign_rows import flat_row

AXES = ["slope"]


def drives(outcome_of, seeds=50, slopes=(0, 5, 10, 15), **changes):
    return [
        flat_row(outcome_of(slope, seed), slope=slope, seed=seed, **changes)
        for seed in range(seeds)
        for slope in slopes
    ]


def by_chance(share):
    def outcome(slope, seed):
        reached = random.Random(f"{slope} {seed}").random() < share
        return "goal_reached" if reached else "no_path"

    return outcome


def test_mcnemar_is_the_exact_test_of_the_pairs_that_differ():
    pairs = [(True, True)] * 50 + [(True, False)] * 9 + [(False, True)] + [(False, False)] * 7
    test = mcnemar(pairs)
    assert (test.both, test.only_before, test.only_after, test.neither) == (50, 9, 1, 7)
    # twice the chance of at most 1 of 10 heads: 2 * (1 + 10) / 1024
    assert test.p == pytest.approx(22 / 1024)
    assert test.difference == pytest.approx(-8 / 67)


def test_mcnemar_without_differing_pairs_shows_nothing():
    assert mcnemar([(True, True), (False, False)]).p == 1.0


def test_paired_difference_is_of_pairs_not_of_groups():
    before = np.linspace(0.0, 100.0, 30)
    after = before + 1.0 + 0.01 * np.sin(before)
    result = paired_difference("drive_rate_m_per_h", before, after)
    assert result.difference == pytest.approx(float((after - before).mean()))
    assert 0.98 < result.low < 1.0 < result.high < 1.02
    assert result.p == pytest.approx(float(stats.wilcoxon(after - before).pvalue))
    assert result.p < 1e-6


def test_equal_metrics_show_no_difference():
    values = np.linspace(0.0, 1.0, 20)
    result = paired_difference("tilt_max_rad", values, values)
    assert (result.difference, result.low, result.high, result.p) == (0.0, 0.0, 0.0, 1.0)


def test_holm_corrects_step_by_step_and_never_down():
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([0.9, 0.8]) == [1.0, 1.0]
    assert holm([]) == []


def test_identical_campaigns_show_no_difference():
    rows = drives(by_chance(0.8))
    result = compare(rows, rows, AXES)
    assert (len(result.pairs), result.success.p, result.violations.p) == (200, 1.0, 1.0)
    assert not result.gained
    assert not result.lost
    assert {item.p_holm for item in result.cells} == {1.0}
    assert {item.p_holm for item in result.metrics} == {1.0}
    assert [item.difference.metric for item in result.metrics] == list(METRICS)


def test_a_planted_regression_is_found_in_200_pairs():
    result = compare(drives(by_chance(0.9)), drives(by_chance(0.8)), AXES)
    assert result.success.p < 0.01
    assert result.success.difference < 0.0
    assert len(result.lost) > len(result.gained) == 0
    assert all(pair[0]["outcome"] == "goal_reached" for pair in result.lost)


def test_a_regression_in_one_cell_is_found_there():
    def worse(slope, seed):
        return "no_path" if slope == 15 and seed % 2 else by_chance(0.95)(slope, seed)

    result = compare(drives(by_chance(0.95)), drives(worse), AXES)
    assert [item.cell for item in result.cells if item.p_holm < 0.05] == [(15,)]


def test_only_pairs_that_both_reached_their_goal_tell_of_metrics():
    before = drives(by_chance(1.0), seeds=10)
    after = drives(by_chance(1.0), seeds=10, drive_rate_m_per_h=50.0)
    after[0] |= {"outcome": "stuck", "drive_rate_m_per_h": 1.0}
    rate = next(
        item
        for item in compare(before, after, AXES).metrics
        if item.difference.metric == "drive_rate_m_per_h"
    )
    assert (rate.difference.pairs, rate.difference.after) == (39, 50.0)
    assert rate.p_holm < 0.01


def test_drives_without_a_partner_are_left_out_and_named():
    before = drives(by_chance(1.0), seeds=4, slopes=(0, 5))
    after = drives(by_chance(1.0), seeds=3, slopes=(5, 10))
    result = compare(before, after, AXES)
    assert {(pair[0]["slope"], pair[1]["slope"]) for pair in result.pairs} == {(5, 5)}
    assert len(result.pairs) == 3
    assert len(result.left_out_before) == 5
    assert len(result.left_out_after) == 3


def test_violations_on_arcs_called_safe_are_compared_too():
    before = drives(by_chance(1.0), seeds=10)
    after = drives(lambda *_: "limit_violation", seeds=10)
    after[0]["violations_called_safe"] = None
    result = compare(before, after, AXES)
    assert (result.violations.pairs, result.violations.only_after) == (39, 39)
    assert result.violations.p < 0.01


def test_no_common_drive_is_no_error():
    result = compare(drives(by_chance(1.0), slopes=(0,)), drives(by_chance(1.0), slopes=(5,)), AXES)
    assert result.pairs == []
    assert result.success.p == 1.0
