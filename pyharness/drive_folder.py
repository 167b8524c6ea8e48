# SPDX-License-Identifier: Apache-2.0
"""The folder that a drive leaves: records, summary, tables, picture, scenario."""

import shutil
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pyharness import metrics
from pyharness.command_server import CommandServer
from pyharness.dp import Kind, native_schema
from pyharness.dp_file import DpWriter
from pyharness.drive import drive
from pyharness.errors import OutputError
from pyharness.history import History
from pyharness.messages import Pose6, distance_m
from pyharness.planner import Planner
from pyharness.planners import load_planner
from pyharness.records import Record, RecordStream
from pyharness.scenario import Scenario, drive_info
from sim.config import dump_model
from sim.terrain import Terrain

PRODUCT_FILES = ("drive.dp", "summary.json")
SCENARIO_FILE = "scenario.yaml"


@dataclass(frozen=True, slots=True)
class Progress:
    """How far a drive is."""

    time_s: float
    distance_to_goal_m: float
    planning_cycles: int


ProgressSink = Callable[[Progress], None]


def run_drive(
    scenario: Scenario,
    terrain: Terrain,
    folder: Path,
    force: bool = False,
    progress: ProgressSink | None = None,
    server: CommandServer | None = None,
) -> dict[str, Any]:
    """Run one drive into a folder; return its summary.

    The folder appears under its name when it is complete. Until then it is called `NAME.partial`,
    and stays so when the run is interrupted.

    Raises:
        OutputError: The folder exists already, or cannot be written.
    """
    check_folder(folder, force)
    planner_class = load_planner(scenario.planner)
    partial = partial_folder(folder)
    try:
        if partial.exists():
            shutil.rmtree(partial)
        partial.mkdir(parents=True)
        summary = _run_into(scenario, terrain, planner_class, partial, progress, server)
        _replace(partial, folder)
    except OSError as error:
        raise OutputError(f"{error.filename or partial}: {error.strerror}") from error
    return summary


def partial_folder(folder: Path) -> Path:
    """Return what a folder is called until it is complete."""
    return folder.with_name(f"{folder.name}.partial")


def check_folder(folder: Path, force: bool) -> None:
    """Refuse to overwrite what is no drive, or a drive without being told to."""
    if not folder.name:
        raise OutputError(f"{folder}: expected the name of a folder to make")
    if not folder.exists() and not folder.is_symlink():
        return
    is_drive = folder.is_dir() and all((folder / name).is_file() for name in PRODUCT_FILES)
    is_empty = folder.is_dir() and not any(folder.iterdir())
    if not is_drive and not is_empty:
        raise OutputError(f"{folder}: exists and is not the folder of a drive")
    if is_drive and not force:
        raise OutputError(f"{folder}: holds a finished drive (--force replaces it)")


def _run_into(
    scenario: Scenario,
    terrain: Terrain,
    planner_class: type[Planner],
    folder: Path,
    progress: ProgressSink | None,
    server: CommandServer | None,
) -> dict[str, Any]:
    (folder / SCENARIO_FILE).write_text(dump_model(scenario), "utf-8")
    history = History(native_schema(), drive_info(scenario))
    with DpWriter(folder / "drive.dp", history.info) as writer:
        subscribers: list[Callable[[Record], None]] = [writer.write, history.take]
        if progress is not None:
            subscribers.append(_reporter(history, progress))
        summary = summarized_drive(scenario, terrain, planner_class, history, subscribers, server)
    write_products(history, terrain, summary, folder)
    return summary


def summarized_drive(
    scenario: Scenario,
    terrain: Terrain,
    planner_class: type[Planner],
    history: History,
    subscribers: list[Callable[[Record], None]],
    server: CommandServer | None = None,
) -> dict[str, Any]:
    """Run one drive, whose history is among the subscribers to its records; return its summary."""
    start_s = time.perf_counter()
    drive(scenario, terrain, planner_class, RecordStream(subscribers), server)
    duration_wall_s = time.perf_counter() - start_s
    return with_wall_time(metrics.summarize(history), duration_wall_s)


def write_products(
    history: History,
    terrain: Terrain,
    summary: dict[str, Any],
    folder: Path,
    has_truth: bool = True,
) -> None:
    """Write what is made of a drive's records; without the truth it takes a tenth of the space."""
    from pyharness.overhead import draw_overhead

    draw_overhead(history, terrain, folder / "overhead.png")
    metrics.write(history, summary, folder, has_truth)


def with_wall_time(summary: Mapping[str, Any], duration_wall_s: float) -> dict[str, Any]:
    """Put the wall time, which no record holds, behind the simulated time."""
    result: dict[str, Any] = {}
    for key, value in summary.items():
        if key == "planning_cycles":
            result["duration_wall_s"] = duration_wall_s
        result[key] = value
    return result


def _reporter(history: History, progress: ProgressSink) -> Callable[[Record], None]:
    """Return a subscriber that reports progress at every estimate."""

    def report(record: Record) -> None:
        if record.kind == Kind.ESTIMATE:
            pose = history.estimates[-1]["pose"]
            place = Pose6(*(float(pose[name]) for name in pose.dtype.names or ()))
            goal = history.info.waypoints[-1]
            progress(Progress(record.time_s, distance_m(place, goal), len(history.selections)))

    return report


def _replace(partial: Path, folder: Path) -> None:
    """Give a complete folder its name; the one it replaces disappears last."""
    old = folder.with_name(f"{folder.name}.old")
    with suppress(FileNotFoundError):
        folder.rename(old)
    partial.rename(folder)
    shutil.rmtree(old, ignore_errors=True)
