# SPDX-License-Identifier: Apache-2.0
"""Campaigns of drives that take a third of a second, and the processes they run in."""

import csv
import json
import os
import shutil
import signal
import time
from contextlib import suppress
from pathlib import Path

from pyharness.campaign import load_campaign
from pyharness.montecarlo import run_campaign
from pyharness.tests import stub_planners
from pyharness.tests.quick_drive import QUICK_DRIVE
from pyharness.workers import local_workers

QUICK_CAMPAIGN = {
    "name": "quick",
    "scenario": QUICK_DRIVE,
    "axes": {"terrain.slope_deg": [0, 5], "terrain.cfa": [0.03, 0.15]},
    "seeds": 3,
    "keep": "none",
}
WAIT_S = 60.0


def write_campaign(folder, **changes):
    """Write a campaign's file; return its name."""
    path = folder / "quick.yaml"
    path.write_text(json.dumps(QUICK_CAMPAIGN | changes))
    return str(path)


def stub(folder, name):
    """Return the name of a stub planner whose file lies in a folder."""
    path = folder / "stubs.py"
    if not path.exists():
        shutil.copy(stub_planners.__file__, path)
    return f"{path}:{name}"


def run(name, out, workers=2, on_done=lambda *_: None):
    """Run a campaign here; return its table."""
    with local_workers(workers) as pool:
        return run_campaign(load_campaign(name), out, pool, on_done)[0]


def rows_of(out):
    """Return the rows of drives.csv without wall times."""
    with (out / "drives.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        del row["duration_wall_s"]
    return rows


def until(condition):
    """Wait for something to become true; return it."""
    end_s = time.monotonic() + WAIT_S
    while time.monotonic() < end_s:
        if found := condition():
            return found
        time.sleep(0.02)
    raise AssertionError("waited in vain")


def told_pids(folder, count=1):
    """Wait until as many stubs have told their processes; return all of these."""
    paths = until(lambda: len(found := list(folder.glob("*.pids"))) >= count and found)
    return [int(text) for path in paths for text in path.read_text().split()]


def kill_told(folder):
    """Kill what a test that failed has left of its stubs."""
    for path in folder.glob("*.pids"):
        for pid in map(int, path.read_text().split()):
            if is_alive(pid):
                os.kill(pid, signal.SIGKILL)


def is_alive(pid):
    """Whether a process runs; one that only waits to be reaped does not."""
    with suppress(OSError):
        stat = Path(f"/proc/{pid}/stat").read_text()
        return stat.rpartition(")")[2].split()[0] not in "ZX"
    return False


def descendants(pid):
    """Return the processes that a process has started, and those that they have."""
    parents = {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            parents[int(path.parent.name)] = int(path.read_text().rpartition(")")[2].split()[1])
    found, new = set(), {pid}
    while new:
        new = {child for child, parent in parents.items() if parent in new} - found
        found |= new
    return found
