# SPDX-License-Identifier: Apache-2.0
"""The planner that the documentation shows drives."""

import json
import re
from pathlib import Path

import pytest
from click.testing import CliRunner

from pyharness.cli import cli

PAGE = Path(__file__).resolve().parents[2] / "docs/planners.md"
GROUND = {
    "terrain": {"size_m": 40.0, "cfa": 0.0},
    "start": [-10.0, 0.0, 0.0],
    "camera": {"cloud_width_px": 80, "cloud_height_px": 60},
}


@pytest.fixture
def template(tmp_path):
    """The code of the page in a file of its own."""
    code = re.search(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)[1]
    assert code.count("\n") < 60
    path = tmp_path / "mine.py"
    path.write_text(code)
    return path


def drive(template, folder, goal, *options):
    settings = [part for key, value in GROUND.items()
                for part in ("--set", f"{key}={json.dumps(value)}")]  # fmt: skip
    command = ["drive", "--planner", f"{template}:StraightOn", "--goal", goal, *settings, *options]
    answer = CliRunner().invoke(cli, [*command, "-o", str(folder)], standalone_mode=False)
    assert answer.exception is None, answer.exception
    return json.loads((folder / "summary.json").read_text())


def test_the_template_reaches_a_goal_ahead_and_one_to_the_side(template, tmp_path):
    for name, goal in (("ahead", "8,0"), ("side", "0,8")):
        summary = drive(template, tmp_path / name, goal)
        assert summary["outcome"] == "goal_reached"
        assert summary["planner"] == "mine.py:StraightOn"
        assert (tmp_path / name / "overhead.png").stat().st_size > 10_000


def test_the_template_stops_before_rocks(template, tmp_path):
    rocky = ("--set", "terrain.cfa=0.15", "--set", "planner_params.height_max_m=0.15")
    summary = drive(template, tmp_path / "rocks", "12,0", *rocky)
    assert summary["outcome"] == "no_path"
    assert summary["rejections"]["clearance"] > 0
