# SPDX-License-Identifier: Apache-2.0
"""Recordings of drives that take a tenth of a second: short, small clouds, all else real."""

from collections.abc import Mapping
from pathlib import Path

from pyharness.dp_file import DpWriter
from pyharness.drive import drive
from pyharness.planners import load_planner
from pyharness.records import Outcome, RecordStream
from pyharness.scenario import drive_info, load_scenario, make_terrain

QUICK_DRIVE = {
    "terrain": {"size_m": 40.0, "cfa": 0.05},
    "start": [-10.0, 0.0, 0.0],
    "goal": [0.0, 0.0],
    "camera": {"cloud_width_px": 64, "cloud_height_px": 48},
}


def record_drive(path: Path, overrides: Mapping[str, object]) -> Outcome:
    """Record a drive; return how it ended."""
    scenario = load_scenario(None, {**QUICK_DRIVE, **overrides})
    planner_class = load_planner(scenario.planner)
    with DpWriter(path, drive_info(scenario)) as writer:
        return drive(scenario, make_terrain(scenario), planner_class, RecordStream([writer.write]))
