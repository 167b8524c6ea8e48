# SPDX-License-Identifier: Apache-2.0
"""Planners on the same terrains with the same seeds, as one table.

Every drive runs in a process of its own into `DIR/PLANNER/TERRAIN`. One that is there already is
not run again, so a comparison that was stopped goes on where it was; to run a planner anew remove
its folder.
"""

import csv
import io
import json
import shutil
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pyharness import tables
from pyharness.errors import HarnessError, OutputError
from pyharness.scenario import load_scenario
from sim.config import dump_model
from sim.errors import SimError
from sim.terrain_io import write_atomic

CFAS = (0.07, 0.10)
SLOPES_DEG = (0.0, 5.0)

Overrides = Mapping[str, object]

VARIANTS: Mapping[str, Overrides] = {
    "enav": {"planner": "enav"},
    "gestalt": {"planner": "gestalt"},
    "gestalt-25cm": {"planner": "gestalt", "planner_params": {"step_max_m": 0.25}},
    "gestalt-field-d": {"planner": "gestalt", "planner_params": {"global_planner": 1.0}},
    "rrtsharp": {"planner": "rrtsharp"},
}
"""What is compared when nothing is said: a name, and the scenario keys it stands for."""

# large, or made again from the seed by `enav drive --scenario`
DROPPED_FILES = ("drive.dp", "truth.csv")

RUN = "import sys; from pyharness.cli import main; sys.argv[0] = 'enav'; main()"
EXIT_FINE = (0, 3)


@dataclass(frozen=True, slots=True)
class Job:
    """One drive, and its folder."""

    planner: str
    cfa: float
    slope_deg: float
    seed: int
    folder: Path
    overrides: Overrides

    @property
    def scenario_text(self) -> str:
        """Return everything that decides the drive."""
        return dump_model(load_scenario(None, self.overrides))


Done = Callable[[Job, bool], None]


def variant(name: str) -> tuple[str, Overrides]:
    """Return the name of a column of results and what it stands for; `file.py:Class` is one too."""
    if name in VARIANTS:
        return name, VARIANTS[name]
    return name.rpartition(":")[2], {"planner": name}


def comparison_jobs(folder: Path, planners: Sequence[str], seeds: Sequence[int]) -> list[Job]:
    """Return the drives, seed by seed: what is finished of them is a fair sample at any time."""
    columns = dict(map(variant, planners))
    return [
        _job(folder, planner, cfa, slope_deg, seed, given)
        for seed in seeds
        for cfa in CFAS
        for slope_deg in SLOPES_DEG
        for planner, given in columns.items()
    ]


def _job(
    folder: Path, planner: str, cfa: float, slope_deg: float, seed: int, given: Overrides
) -> Job:
    name = f"slope{slope_deg:02g}-cfa{round(100 * cfa):02d}-seed{seed:04d}"
    overrides = {
        "name": name,
        "seed": seed,
        "terrain.cfa": cfa,
        "terrain.slope_deg": slope_deg,
        **given,
    }
    return Job(planner, cfa, slope_deg, seed, folder / planner / name, overrides)


def run_comparison(
    jobs: Sequence[Job], workers: int, on_done: Done
) -> list[tuple[Job, Mapping[str, Any]]]:
    """Run what is missing; return the results of all.

    Raises:
        HarnessError: A drive could not be run, or a folder holds one with other settings. What was
            finished stays.
    """
    missing = []
    for job in jobs:
        if _is_finished(job):
            on_done(job, False)
        else:
            missing.append(job)
    pool = ThreadPoolExecutor(workers)
    try:
        futures = {pool.submit(_run, job): job for job in missing}
        for future in as_completed(futures):
            future.result()
            on_done(futures[future], True)
    finally:
        pool.shutdown(cancel_futures=True)
    return [(job, _result(job)) for job in jobs]


def _is_finished(job: Job) -> bool:
    """Whether the drive is there.

    Raises:
        OutputError: Another one is.
    """
    if not (job.folder / "summary.json").is_file():
        return False
    if (job.folder / "scenario.yaml").read_text("utf-8") != job.scenario_text:
        raise OutputError(
            f"{job.folder}: a drive with other settings, expected none or the same (remove it)"
        )
    return True


def _run(job: Job) -> None:
    """Run one drive in a process of its own."""
    settings = [
        part for key, value in job.overrides.items() for part in ("--set", f"{key}={_yaml(value)}")
    ]
    # the folder appears under its name when it is complete: whatever is in the way is of no use
    shutil.rmtree(job.folder, ignore_errors=True)
    child = subprocess.run(
        [sys.executable, "-c", RUN, "drive", *settings, "-o", str(job.folder)],
        capture_output=True,
        text=True,
        check=False,
    )
    if child.returncode not in EXIT_FINE:
        lines = child.stderr.strip().splitlines() or [f"exit code {child.returncode}"]
        raise HarnessError(f"{job.folder}: the drive could not be run: {lines[-1]}")
    for name in DROPPED_FILES:
        (job.folder / name).unlink()


def _yaml(value: object) -> str:
    """Return a value as YAML on one line, which JSON is."""
    return json.dumps(value)


def _result(job: Job) -> Mapping[str, Any]:
    """Return the summary of a finished drive, and the candidates tested per planning cycle."""
    summary: dict[str, Any] = json.loads((job.folder / "summary.json").read_text("utf-8"))
    with (job.folder / "metrics.csv").open(encoding="utf-8") as rows:
        tested = [float(row["paths_tested"]) for row in csv.DictReader(rows)]
    return {**summary, "paths_tested_mean": float(np.mean(tested)) if tested else None}


# ------------------------------------------------------------------ results as tables

DRIVE_COLUMNS = (
    "outcome",
    "path_inefficiency",
    "drive_rate_m_per_h",
    "planning_cycles",
    "ace_evaluations_mean",
    "paths_tested_mean",
    "clearance_min_m",
    "tilt_max_rad",
    "rocker_max_rad",
    "bogie_max_rad",
    "wheel_drop_max_m",
    "duration_wall_s",
    "fault_detail",
)


def drives_csv(results: Sequence[tuple[Job, Mapping[str, Any]]]) -> str:
    """Return one row per drive."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["planner", "cfa", "slope_deg", "seed", *DRIVE_COLUMNS])
    for job, result in results:
        place = [job.planner, job.cfa, job.slope_deg, job.seed]
        writer.writerow([*place, *(result[name] for name in DRIVE_COLUMNS)])
    return text.getvalue()


def summary_rows(results: Sequence[tuple[Job, Mapping[str, Any]]]) -> list[tables.Row]:
    """Return one row per planner and kind of terrain, and one per planner over all."""
    cells = dict.fromkeys((job.planner, job.cfa, job.slope_deg) for job, _ in results)
    rows = []
    for planner in dict.fromkeys(job.planner for job, _ in results):
        own = [(job, result) for job, result in results if job.planner == planner]
        for _, cfa, slope_deg in (cell for cell in cells if cell[0] == planner):
            chosen = [result for job, result in own if (job.cfa, job.slope_deg) == (cfa, slope_deg)]
            rows.append(_row(planner, f"{100 * cfa:g}", f"{slope_deg:g}", chosen))
        rows.append(_row(planner, "all", "all", [result for _, result in own]))
    return rows


def _row(
    planner: str, cfa_percent: str, slope_deg: str, results: Sequence[Mapping[str, Any]]
) -> tables.Row:
    outcomes = [result["outcome"] for result in results]
    reached = [result for result in results if result["outcome"] == "goal_reached"]
    violations = outcomes.count("limit_violation")
    no_path = outcomes.count("no_path")
    return {
        "planner": planner,
        "CFA, %": cfa_percent,
        "slope, deg": slope_deg,
        "drives": len(results),
        "reached": len(reached),
        "true limit violated": violations,
        "no path": no_path,
        "other fault": len(results) - len(reached) - violations - no_path,
        "inefficiency, %": _mean(reached, "path_inefficiency", 100.0),
        "rate, m/h": _mean(reached, "drive_rate_m_per_h", 1.0),
        "ACE poses a cycle": _mean(results, "ace_evaluations_mean", 1.0),
        "candidates a cycle": _mean(results, "paths_tested_mean", 1.0),
    }


def _mean(results: Sequence[Mapping[str, Any]], name: str, scale: float) -> str:
    values = [result[name] for result in results if result[name] is not None]
    return f"{scale * float(np.mean(values)):.1f}" if values else "-"


def write_tables(folder: Path, results: Sequence[tuple[Job, Mapping[str, Any]]]) -> str:
    """Write drives.csv and table.md into the folder; return the table."""
    table = tables.to_markdown(summary_rows(results))
    write_atomic(folder / "drives.csv", drives_csv(results).encode())
    write_atomic(folder / "table.md", table.encode())
    return table


def check_jobs(jobs: Sequence[Job]) -> None:
    """Refuse what cannot be run before anything is.

    Raises:
        HarnessError: Of the first planner that cannot be loaded or set.
    """
    for job in {job.planner: job for job in jobs}.values():
        try:
            load_scenario(None, job.overrides)
        except SimError as error:
            raise HarnessError(f"{job.planner}: {error}") from None
