# SPDX-License-Identifier: Apache-2.0
"""Runs campaigns: what is missing of one, and how far it is."""

import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import contextmanager, suppress
from datetime import UTC, datetime
from pathlib import Path

from pyharness import drive_table
from pyharness.campaign import Campaign, Drive, drives_of, scenario_of
from pyharness.campaign_folder import land, opened_folder, read_run, write_run
from pyharness.child_drives import DriveResult, DriveTask
from pyharness.drive_table import DriveTable
from pyharness.errors import HarnessError
from pyharness.provenance import provenance
from pyharness.records import Outcome
from pyharness.scenario import drive_info
from pyharness.tables import Row
from pyharness.workers import Workers
from sim.errors import SimError

# enough for the largest cluster, and few enough to hold in memory
AHEAD_MAX = 1000
RUN_FILE_PERIOD_S = 10.0

Done = Callable[[str, bool], None]
"""Told of every drive: its outcome, and whether it was run now."""


def run_campaign(
    campaign: Campaign, folder: Path, workers: Workers, on_done: Done
) -> tuple[DriveTable, bool]:
    """Run what is missing of a campaign; return what it found, and whether Parquet was written.

    Whatever ends the run, what is finished stays, is listed in drives.csv, and is not run again.

    Raises:
        HarnessError: The folder cannot be used or written, or the workers are gone.
    """
    with opened_folder(folder, campaign):
        missing = []
        for drive in drives_of(campaign):
            path = drive_table.result_path(folder, drive)
            if path.exists():
                on_done(drive_table.read_result(path)[0]["outcome"], False)
            else:
                missing.append(drive)
        try:
            if missing:
                with _run_record(folder, workers) as tick:
                    _run_drives(campaign, missing, folder, workers, on_done, tick)
        except BaseException:
            with suppress(HarnessError, SimError):
                drive_table.write_tables(drive_table.load(folder))
            raise
        table = drive_table.load(folder)
        return table, drive_table.write_tables(table)


def _run_drives(
    campaign: Campaign,
    drives: Sequence[Drive],
    folder: Path,
    workers: Workers,
    on_done: Done,
    tick: Callable[[], None],
) -> None:
    running: dict[Future[DriveResult], tuple[Drive, str]] = {}

    def take_in(count_max: int) -> None:
        """Wait until no more than that many are running."""
        while len(running) > count_max:
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                drive, mode = running.pop(future)
                result = workers.result(future)
                land(folder, drive, drive.place(campaign), mode, result)
                on_done(result.summary["outcome"] if result.summary else result.outcome, True)
                tick()

    for drive in drives:
        scenario = scenario_of(campaign, drive)
        task = DriveTask(scenario.model_dump_json(), campaign.keep, campaign.time_out_s)
        running[workers.submit(task)] = (drive, drive_info(scenario).waypoints[-1].mode)
        take_in(AHEAD_MAX)
    take_in(0)


@contextmanager
def _run_record(folder: Path, workers: Workers) -> Iterator[Callable[[], None]]:
    """Keep run.json up to date; wall times of all runs are summed."""
    before = read_run(folder)
    start_s = time.monotonic()
    now = _now()
    source = provenance()
    version = " ".join(filter(None, (source["enav_sim"], source["revision"])))
    run = {
        **source,
        **workers.about,
        "versions": list(dict.fromkeys([*before.get("versions", []), version])),
        "started": before.get("started", now),
        "ended": None,
        "wall_time_s": 0.0,
        "sessions": before.get("sessions", 0) + 1,
    }
    written_s = start_s

    def write(ended: str | None) -> None:
        run["ended"] = ended
        run["wall_time_s"] = round(before.get("wall_time_s", 0.0) + time.monotonic() - start_s, 1)
        write_run(folder, run)

    def tick() -> None:
        nonlocal written_s
        if time.monotonic() - written_s > RUN_FILE_PERIOD_S:
            written_s = time.monotonic()
            write(None)

    write(None)
    try:
        yield tick
    except BaseException:
        with suppress(SimError):
            write(_now())
        raise
    write(_now())


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")


# ------------------------------------------------------------------ status


def status_rows(table: DriveTable) -> list[Row]:
    """Return one row per cell and one for all: drives done and missing, and their outcomes."""
    keys = table.campaign.place_columns[1:-1]
    found = {row["name"]: row["outcome"] for row in table.rows}
    cells: dict[tuple[str, ...], list[str | None]] = {}
    for drive in drives_of(table.campaign):
        cells.setdefault(tuple(map(str, drive.cell)), []).append(found.get(drive.name))
    everything = [outcome for outcomes in cells.values() for outcome in outcomes]
    names = sorted(set(found.values()), key=lambda name: (not Outcome(name).is_reached, name))
    rows = [_status_row(keys, cell, outcomes, names) for cell, outcomes in cells.items()]
    return [*rows, _status_row(keys, ["all"] * len(keys), everything, names)]


def _status_row(
    keys: Sequence[str], cell: Sequence[str], outcomes: Sequence[str | None], names: Sequence[str]
) -> Row:
    missing = outcomes.count(None)
    counts = {name: outcomes.count(name) for name in names}
    place = zip(keys, cell, strict=True)
    return {**dict(place), "done": len(outcomes) - missing, "missing": missing, **counts}
