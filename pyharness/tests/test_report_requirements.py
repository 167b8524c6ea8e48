# SPDX-License-Identifier: Apache-2.0
import pytest

from pyharness.report_requirements import requirement_checks
from pyharness.tests.campaign_rows import GRID, flat_row, made_campaign


def wanted(**requirements):
    return made_campaign(requirements=requirements).requirements


def drives(reached_of_10):
    """Ten drives in every cell, of which as many reach their goal as said."""
    return [
        flat_row(
            "goal_reached" if seed < reached_of_10(slope, cfa) else "stuck",
            **{"terrain.slope_deg": slope, "terrain.cfa": cfa, "seed": seed},
        )
        for slope in GRID["terrain.slope_deg"]
        for cfa in GRID["terrain.cfa"]
        for seed in range(10)
    ]


def only(requirements, rows, variant=""):
    (check,) = requirement_checks(requirements, rows, GRID, variant)
    return check


def test_a_success_rate_is_asked_of_every_cell_chosen():
    rows = drives(lambda slope, cfa: 8 if (slope, cfa) == (10, 0.07) else 10)
    everywhere = only(wanted(success_rate_min=[{"value": 0.9}]), rows)
    assert everywhere.is_met is False
    assert everywhere.measured == "80.0 % (8/10) at slope 10 deg, CFA 7 %"
    assert everywhere.interval == "49 to 94 %"
    level = {"where": {"terrain.slope_deg": [0]}, "value": 0.9}
    check = only(wanted(success_rate_min=[level]), rows)
    assert check.is_met is True
    assert check.requirement == "success rate in every cell of slope 0 deg"
    assert check.threshold == "≥ 90 %"


def test_cells_without_drives_leave_a_requirement_open():
    rows = [row for row in drives(lambda *_: 10) if row["terrain.slope_deg"] == 0]
    assert only(wanted(success_rate_min=[{"value": 0.9}]), rows).is_met is None
    assert only(wanted(success_rate_min=[{"value": 0.9}]), []).is_met is None


def test_a_failed_cell_decides_even_where_others_have_no_drives():
    rows = [row for row in drives(lambda *_: 5) if row["terrain.slope_deg"] == 0]
    assert only(wanted(success_rate_min=[{"value": 0.9}]), rows).is_met is False


def test_means_are_of_drives_that_reached_their_goal():
    rows = [flat_row(drive_rate_m_per_h=90.0), flat_row("stuck", drive_rate_m_per_h=10.0)]
    check = only(wanted(drive_rate_mean_min_m_per_h=80.0), rows)
    assert (check.is_met, check.measured) == (True, "90.0 m/h (n = 1)")
    assert only(wanted(drive_rate_mean_min_m_per_h=80.0), rows[1:]).is_met is None


@pytest.mark.parametrize(
    ("requirement", "at_limit", "beyond", "column", "value"),
    [
        ("clearance_min_m", 0.3, 0.31, "clearance_min_m", 0.3),
        ("wheel_drop_max_m", 0.3, 0.29, "wheel_drop_max_m", 0.3),
        ("tilt_max_deg", 30.1, 29.9, "tilt_max_rad", 0.5236),
        ("violations_called_safe_max", 1, 0, "violations_called_safe", 1),
        ("path_inefficiency_mean_max", 0.3, 0.29, "path_inefficiency", 0.3),
    ],
)
def test_thresholds_may_be_touched_not_crossed(requirement, at_limit, beyond, column, value):
    rows = [flat_row(**{column: value})]
    assert only(wanted(**{requirement: at_limit}), rows).is_met is True
    assert only(wanted(**{requirement: beyond}), rows).is_met is False


def test_the_worst_drive_decides_on_margins():
    rows = [flat_row(clearance_min_m=0.4), flat_row("stuck", clearance_min_m=0.2)]
    assert only(wanted(clearance_min_m=0.3), rows).measured == "0.200 m"


def test_a_variant_is_named():
    check = only(wanted(clearance_min_m=0.3), [flat_row()], "gestalt")
    assert check.requirement == "gestalt: belly clearance at every step"
