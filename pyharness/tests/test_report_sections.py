# SPDX-License-Identifier: Apache-2.0
from pyharness.campaign_statistics import safety
from pyharness.report_sections import (
    appendix_tables,
    failed_blocks,
    metric_blocks,
    outcome_table,
    safety_blocks,
)
from pyharness.tests.campaign_rows import GRID, flat_row, rows_of

ENAV = ("enav", "default")


def test_an_appendix_has_means_and_the_worst_of_all_drives():
    rows = [flat_row(clearance_min_m=value, tilt_max_rad=value) for value in (0.3, 0.4, 0.5)]
    _, extremes = appendix_tables(rows, {}, "")
    (values,) = extremes.rows
    titles = [column.title for column in extremes.columns]
    found = dict(zip(titles, values, strict=True))
    assert found["clearance, m"] == "0.400 (0.300)"
    assert found["tilt, deg"] == "22.92 (28.65)"


def test_drive_rate_and_inefficiency_are_of_drives_that_reached_their_goal():
    rows = [flat_row(), flat_row("stuck", drive_rate_m_per_h=1.0, ace_evaluations_mean=320.0)]
    performance, _ = appendix_tables(rows, {}, "")
    titles = [column.title for column in performance.columns]
    found = dict(zip(titles, performance.rows[0], strict=True))
    assert found["reached"] == "1/2"
    assert found["drive rate, m/h"] == "88.0"
    assert found["ACE evaluations, mean"] == "220.0"


def test_a_grid_of_means_says_of_how_many_drives():
    rows = rows_of(lambda slope, _, seed: "stuck" if slope and seed else "goal_reached")
    rate, _, evaluations, _ = metric_blocks(rows, GRID, "")
    assert [row.cells[0].sub for row in rate.rows] == ["n = 3", "n = 1"]
    assert [row.cells[0].sub for row in evaluations.rows] == ["n = 3", "n = 3"]


def test_outcomes_add_up():
    table = outcome_table(rows_of(lambda slope, *_: "stuck" if slope else "goal_reached"), GRID, "")
    assert [column.title for column in table.columns][2:] == ["goal reached", "stuck"]
    assert table.rows[0] == ["0", "7", "3", ""]
    assert table.rows[-1] == [{"strong": "all"}, "", "6", "6"]


def test_violations_under_leave_limits_are_listed_and_do_not_count_as_safe():
    row = flat_row("limit_violation", violations_called_safe=0, violations_leaving=1)
    _, statement, table, listed = safety_blocks([(ENAV, "enav", safety([row]))])
    assert statement.tone == "good"
    assert table.rows[1][2] == {"text": "1", "tone": "bad"}
    assert listed.rows[0][1] == "leave limits"


def test_every_failed_drive_is_listed_by_cell():
    (table,) = failed_blocks(rows_of(lambda _, __, seed: "stuck" if seed else "no_path"), GRID)
    names = [row[0]["code"] for row in table.rows]
    assert len(names) == 12
    assert names[:3] == [f"slope0-cfa0.07-seed000{seed}" for seed in range(3)]
