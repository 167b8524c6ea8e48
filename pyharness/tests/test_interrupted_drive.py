# SPDX-License-Identifier: Apache-2.0
"""A drive that is killed, or whose disk is full: nothing that happened is lost."""

import json
import os
import random
import signal
import subprocess
import sys
import time

import pytest

from pyharness.dp import Kind
from pyharness.dp_file import DpReader
from pyharness.drive_folder import run_drive
from pyharness.errors import OutputError
from pyharness.scenario import load_scenario, make_terrain
from pyharness.tests.quick_drive import QUICK_DRIVE

pytestmark = pytest.mark.faults

OPTIONS = json.dumps(QUICK_DRIVE)
CHILD = """
import json, os, signal, sys
from pathlib import Path
from pyharness import dp_file
from pyharness.drive_folder import run_drive
from pyharness.scenario import load_scenario, make_terrain

options, folder, last = json.loads(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3])
write = dp_file.DpWriter.write

def write_and_die(self, record):
    write(self, record)
    if record.sequence == last:
        os.kill(os.getpid(), signal.SIGKILL)

dp_file.DpWriter.write = write_and_die
scenario = load_scenario(None, options)
terrain = make_terrain(scenario)
print("driving", flush=True)
run_drive(scenario, terrain, folder)
"""


def start(folder, last=-1):
    command = [sys.executable, "-c", CHILD, OPTIONS, str(folder), str(last)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)


@pytest.fixture(scope="module")
def undisturbed(quick_drive):
    with DpReader(quick_drive) as reader:
        return list(reader.records())


def recovered(folder):
    """Return the records of a drive that was killed."""
    assert not folder.exists()
    with DpReader(folder.with_name(f"{folder.name}.partial") / "drive.dp") as reader:
        records = list(reader.records())
        assert reader.damage.reason.startswith("the file ends ")
        return records


@pytest.mark.parametrize(("behind_cycle", "more"), [(0, 5), (1, 0), (3, 60)])
def test_a_killed_drive_loses_its_current_cycle_at_most(tmp_path, undisturbed, behind_cycle, more):
    ends = [item.sequence for item in undisturbed if item.kind == Kind.SELECT_ARC_OUT]
    last = (ends[behind_cycle - 1] if behind_cycle else 0) + more
    process = start(tmp_path / "killed", last)
    assert process.communicate(timeout=110)[0]
    assert process.returncode == -signal.SIGKILL
    records = recovered(tmp_path / "killed")
    assert records == undisturbed[: len(records)]
    whole_cycles = sum(end <= last for end in ends)
    assert len(records) >= (ends[whole_cycles - 1] + 1 if whole_cycles else 0)


def test_a_drive_killed_at_any_moment_leaves_its_beginning(tmp_path, undisturbed):
    process = start(tmp_path / "killed")
    assert process.stdout.readline() == "driving\n"
    time.sleep(random.Random().uniform(0.0, 0.15))
    process.kill()
    process.communicate(timeout=110)
    if process.returncode == 0:
        pytest.skip("the drive was over before it could be killed")
    path = tmp_path / "killed.partial/drive.dp"
    if path.exists() and path.stat().st_size > 0:
        records = recovered(tmp_path / "killed")
        assert records == undisturbed[: len(records)]


def test_after_a_kill_the_same_command_drives_again(tmp_path, undisturbed):
    start(tmp_path / "drive", 100).communicate(timeout=110)
    scenario = load_scenario(None, QUICK_DRIVE)
    run_drive(scenario, make_terrain(scenario), tmp_path / "drive")
    with DpReader(tmp_path / "drive/drive.dp") as reader:
        assert list(reader.records()) == undisturbed
    assert [path.name for path in tmp_path.iterdir()] == ["drive"]


LIMITED = """
import resource, sys
from pyharness.cli import main
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]), int(sys.argv[1])))
sys.argv = ["enav", *sys.argv[2:]]
main()
"""


@pytest.mark.parametrize("size_bytes", [100, 300_000])
def test_a_file_that_cannot_grow_is_one_line_and_what_was_recorded_stays(
    tmp_path, undisturbed, size_bytes
):
    (tmp_path / "s.yaml").write_text(OPTIONS)
    command = [sys.executable, "-c", LIMITED, str(size_bytes), "drive", "--scenario", "s.yaml"]
    run = subprocess.run([*command, "-o", "out"], cwd=tmp_path, capture_output=True, text=True)
    assert run.returncode == 2
    assert run.stdout == ""
    assert len(run.stderr.splitlines()) == 1
    assert run.stderr.startswith("enav: out.partial")
    assert run.stderr.endswith(": File too large\n")
    assert not (tmp_path / "out").exists()
    if size_bytes > 100_000:
        records = recovered(tmp_path / "out")
        assert records == undisturbed[: len(records)]
        assert len(records) > 100


@pytest.mark.parametrize("write_number", [0, 3, 60])
def test_a_disk_full_at_any_write_is_one_error(tmp_path, monkeypatch, write_number):
    from pyharness import dp_file

    write, numbers = dp_file.DpWriter.write, iter(range(1_000_000))

    def write_until_full(self, record):
        if next(numbers) >= write_number:
            raise OSError(28, os.strerror(28))
        write(self, record)

    monkeypatch.setattr(dp_file.DpWriter, "write", write_until_full)
    scenario = load_scenario(None, QUICK_DRIVE)
    with pytest.raises(OutputError, match="No space left on device"):
        run_drive(scenario, make_terrain(scenario), tmp_path / "out")
