# SPDX-License-Identifier: Apache-2.0
import math

import pytest

from pyharness.campaign_statistics import (
    CALLED_SAFE,
    ELSEWHERE,
    LEAVING,
    all_rejections,
    axis_key,
    by_cell,
    in_order,
    last_rejections,
    mean,
    most_per_metre,
    no_path_causes,
    outcome_counts,
    safety,
    success,
    wilson,
)
from pyharness.status import Reason
from pyharness.tests.campaign_rows import flat_row
from pyharness.thinker import describe_rejections


def test_wilson_interval_is_that_of_the_formula():
    n, z, p = 60, 1.959963984540054, 54 / 60
    middle = (p + z * z / (2 * n)) / (1 + z * z / n)
    half = z * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n)) / (1 + z * z / n)
    rate = wilson(54, 60)
    assert rate.share == pytest.approx(0.9)
    assert rate.low == pytest.approx(middle - half)
    assert rate.high == pytest.approx(middle + half)


def test_wilson_interval_of_all_and_of_none_stays_within_0_and_1():
    assert (wilson(0, 3).low, wilson(3, 3).high) == (0.0, 1.0)
    assert wilson(0, 3).high == pytest.approx(0.5615, abs=1e-4)
    assert wilson(0, 0) is None


def test_success_counts_drives_that_crashed_as_failures():
    rows = [flat_row(), flat_row("crashed", path_inefficiency=None), flat_row("no_path")]
    assert (success(rows).count, success(rows).total) == (1, 3)


def test_mean_is_of_the_drives_that_know():
    rows = [flat_row(clearance_min_m=0.4), flat_row(clearance_min_m=0.5), flat_row()]
    rows[2]["clearance_min_m"] = None
    assert mean(rows, "clearance_min_m").value == pytest.approx(0.45)
    assert mean(rows, "clearance_min_m").count == 2
    assert mean(rows[2:], "clearance_min_m") is None


def test_no_event_in_a_distance_bounds_its_rate_by_the_rule_of_three():
    assert most_per_metre(0, 1000.0) == pytest.approx(-math.log(0.05) / 1000.0)
    assert most_per_metre(0, 0.0) is None


def test_cells_hold_values_that_are_lists():
    rows = [flat_row(start=[1, 2]), flat_row(start=[1, 2]), flat_row(start=[3, 4])]
    cells = by_cell(rows, ["start"])
    assert [len(own) for own in cells.values()] == [2, 1]
    assert next(iter(cells)) == (axis_key([1, 2]),)


def test_drives_are_sorted_by_numbers_before_text():
    rows = [flat_row(x=10, seed=1), flat_row(x="file", seed=0), flat_row(x=2, seed=3)]
    rows.append(flat_row(x=10, seed=0))
    ordered = sorted(rows, key=lambda item: in_order(item, ["x"]))
    assert [(item["x"], item["seed"]) for item in ordered] == [
        (2, 3), (10, 0), (10, 1), ("file", 0),
    ]  # fmt: skip


def test_outcomes_begin_with_success_and_go_on_with_the_most_frequent():
    outcomes = ["stuck", "no_path", "goal_reached", "no_path"]
    assert list(outcome_counts([flat_row(name) for name in outcomes]).items()) == [
        ("goal_reached", 1), ("no_path", 2), ("stuck", 1),
    ]  # fmt: skip


def test_last_rejections_are_read_as_the_executive_writes_them():
    text = describe_rejections({Reason.WHEEL_DROP: 7, Reason.CLEARANCE: 9, Reason.COST: 3})
    detail = f"4 times in a row in mode avoid_all; paths rejected: {text}"
    assert last_rejections(detail) == {"clearance": 9, "wheel_drop": 7}
    assert last_rejections(f"paths rejected: {describe_rejections({})}") == {}
    assert last_rejections("100 m of path without coming nearer") == {}


def test_causes_tell_the_end_from_the_whole_drive():
    causes = no_path_causes([flat_row("no_path"), flat_row("no_path"), flat_row("stuck")])
    assert causes.drives == 2
    assert causes.main_at_end == {"wheel_drop": 2}
    assert causes.main_overall == {"clearance": 2}
    assert causes.paths_at_end == {"wheel_drop": 1800, "clearance": 1000}
    assert causes.paths_overall == {"clearance": 1400, "wheel_drop": 80}
    assert causes.reasons == ["wheel_drop", "clearance"]


def test_dearer_paths_are_no_cause():
    assert "cost" not in all_rejections(flat_row("no_path"))


def test_safety_tells_violations_by_what_had_been_said_of_the_arc():
    rows = [
        flat_row(),
        flat_row("limit_violation", name="safe"),
        flat_row("limit_violation", name="left", violations_called_safe=0, violations_leaving=1),
        flat_row("limit_violation", name="crawl", violations_called_safe=0),
        flat_row("killed", distance_called_safe_m=None, violations_called_safe=None),
    ]
    found = safety(rows)
    assert found.called_safe_m == 4 * 80.0
    assert found.leaving_m == 4.0
    assert found.elsewhere_m == pytest.approx(4 * 7.0)
    assert found.silent == 1
    names = {kind: [row["name"] for row in own] for kind, own in found.violations.items()}
    assert names == {CALLED_SAFE: ["safe"], LEAVING: ["left"], ELSEWHERE: ["crawl"]}
