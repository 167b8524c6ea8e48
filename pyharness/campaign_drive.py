# SPDX-License-Identifier: Apache-2.0
"""One drive of a campaign: a scenario in, a result and the files that are kept out."""

import json
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Literal

from pyharness import margins
from pyharness.dp import native_schema
from pyharness.dp_file import DpWriter
from pyharness.drive_folder import SCENARIO_FILE, summarized_drive, write_products
from pyharness.history import History
from pyharness.planners import load_planner
from pyharness.records import Outcome, Record
from pyharness.scenario import Scenario, check_places, drive_info, make_terrain
from sim.config import dump_model

RESULT_FILE = "result.json"
KEPT_FOLDER = "kept"

Keep = Literal["all", "failures", "none"]


def run_campaign_drive(scenario: Scenario, keep: Keep, folder: Path) -> None:
    """Run one drive; leave its result in a folder, and what is kept of it in a folder below."""
    terrain = make_terrain(scenario)
    check_places(scenario, terrain, None, {})
    planner_class = load_planner(scenario.planner)
    history = History(native_schema(), drive_info(scenario))
    kept = folder / KEPT_FOLDER
    subscribers: list[Callable[[Record], None]] = [history.take]
    with ExitStack() as files:
        if keep == "all":
            kept.mkdir()
            writer = files.enter_context(DpWriter(kept / "drive.dp", history.info))
            subscribers.insert(0, writer.write)
        summary = summarized_drive(scenario, terrain, planner_class, history, subscribers)
    is_reached = Outcome(summary["outcome"]).is_reached
    if keep == "all" or (keep == "failures" and not is_reached):
        kept.mkdir(exist_ok=True)
        (kept / SCENARIO_FILE).write_text(dump_model(scenario), "utf-8")
        write_products(history, terrain, summary, kept, has_truth=keep == "all")
    counted = margins.to_data(margins.margins_of(history.truth))
    write_result(folder, {"summary": summary, "margins": counted})


def write_result(folder: Path, result: dict[str, Any]) -> None:
    """Write a result; it counts when the process ends well."""
    (folder / RESULT_FILE).write_text(json.dumps(result, allow_nan=False), "utf-8")
