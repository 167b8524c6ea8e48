# SPDX-License-Identifier: Apache-2.0
import pytest

from pyharness.margins import NO_MARGINS, QUANTITIES
from pyharness.report_margins import limit_lines, margin_blocks
from pyharness.scenario import load_scenario
from pyharness.tests.campaign_rows import counted_margins


@pytest.mark.parametrize(
    ("name", "navlib", "true"),
    [
        ("clearance_m", 0.35, 0.25),
        ("wheel_drop_m", 0.35, 0.45),
        ("tilt_rad", 30.0, 35.0),
        ("rocker_rad", 8.2, 12.0),
        ("bogie_rad", 30.0, 38.0),
    ],
)
def test_limits_are_navlibs_and_the_true_ones_in_the_unit_shown(name, navlib, true):
    lines = limit_lines(name, [load_scenario(None, {})])
    assert [(line.name, line.is_true) for line in lines] == [("Navlib", False), ("fault", True)]
    assert [line.value for line in lines] == pytest.approx([navlib, true])


def test_limits_that_differ_between_cells_are_all_drawn():
    scenarios = [load_scenario(None, {"navlib.clearance_min_m": value}) for value in (0.3, 0.4)]
    assert [line.value for line in limit_lines("clearance_m", scenarios)] == [0.3, 0.4, 0.25]


def test_every_quantity_has_a_figure():
    files = {}
    about, *pictures = margin_blocks([counted_margins(), NO_MARGINS], [], "-2", files)
    assert sorted(files) == sorted(f"margin-{name}-2.svg" for name in QUANTITIES)
    assert [block.pictures[0].file for block in pictures] == [
        f"margin-{name}-2.svg" for name in QUANTITIES
    ]
    assert "1/8 s" in about.text


def test_without_steps_there_is_no_figure():
    files = {}
    (block,) = margin_blocks([NO_MARGINS], [], "", files)
    assert block.text == "No drive has told its margins."
    assert files == {}
