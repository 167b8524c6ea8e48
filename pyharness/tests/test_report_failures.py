# SPDX-License-Identifier: Apache-2.0
from pyharness.report_failures import PICTURES_MAX, choose_failures
from pyharness.tests.campaign_rows import GRID, rows_of


def test_failures_are_chosen_by_outcome_in_turn_lowest_cell_and_seed_first():
    def outcome(slope, cfa, seed):
        if (slope, cfa, seed) == (10, 0.1, 2):
            return "limit_violation"
        return "stuck" if (slope, seed) == (10, 1) else "no_path" if seed else "goal_reached"

    rows = rows_of(outcome)
    chosen = choose_failures(rows, list(GRID), lambda _: True)
    assert [row["outcome"] for row in chosen] == [
        "limit_violation", "no_path", "stuck", "no_path", "stuck", "no_path",
    ]  # fmt: skip
    assert [row["name"] for row in chosen if row["outcome"] == "no_path"] == [
        "slope0-cfa0.07-seed0001", "slope0-cfa0.1-seed0001", "slope10-cfa0.07-seed0002",
    ]  # fmt: skip


def test_only_drives_with_a_picture_are_chosen_and_not_too_many():
    rows = rows_of(lambda *_: "no_path", seeds=5)
    assert len(choose_failures(rows, list(GRID), lambda _: True)) == PICTURES_MAX
    assert choose_failures(rows, list(GRID), lambda _: False) == []
