# SPDX-License-Identifier: Apache-2.0
"""Whatever a drive does, it is an outcome; and nothing of it outlives the one who asked."""

import os
import signal
import subprocess
import sys
import threading

import pytest

from pyharness.child_drives import DriveTask, Servers, StoppedError
from pyharness.errors import HarnessError
from pyharness.scenario import load_scenario
from pyharness.tests.campaign_runs import descendants, is_alive, kill_told, stub, told_pids, until
from pyharness.tests.quick_drive import QUICK_DRIVE

pytestmark = [pytest.mark.faults, pytest.mark.slow]


@pytest.fixture
def servers():
    servers = Servers()
    yield servers
    servers.stop()


@pytest.fixture(autouse=True)
def own_folder(tmp_path, monkeypatch):
    """Leave no temporary file and no process of a test behind."""
    (tmp_path / "temporary").mkdir()
    monkeypatch.setenv("TMPDIR", str(tmp_path / "temporary"))
    yield tmp_path / "temporary"
    kill_told(tmp_path)


def task(planner="enav", keep="none", time_out_s=100.0, **overrides):
    scenario = load_scenario(None, {**QUICK_DRIVE, "planner": planner, **overrides})
    return DriveTask(scenario.model_dump_json(), keep, time_out_s)


def none_alive(pids):
    return not any(map(is_alive, pids))


def test_a_drive_comes_back_as_data(servers):
    result = servers.run(task())
    assert result.outcome == ""
    assert result.summary["outcome"] == "goal_reached"
    assert result.summary["seed"] == 0
    assert set(result.margins) >= {"clearance_m", "bogie_rad"}
    assert result.files == {}


def test_a_process_is_used_for_drive_after_drive_with_the_same_result(servers):
    first, second = servers.run(task()), servers.run(task())
    assert len(descendants(os.getpid())) == 1
    assert first.margins == second.margins
    wall = {"duration_wall_s": 0.0}
    assert first.summary | wall == second.summary | wall


@pytest.mark.parametrize(
    ("keep", "planner", "names"),
    [
        ("all", "enav", "drive.dp evr.log metrics.csv overhead.png scenario.yaml summary.json"
         " truth.csv"),
        ("failures", "enav", ""),
        ("none", "enav", ""),
    ],
)  # fmt: skip
def test_files_are_kept_by_policy(servers, keep, planner, names):
    assert sorted(servers.run(task(planner, keep)).files) == names.split()


def test_of_a_failure_all_but_the_large_files_is_kept(servers):
    files = servers.run(task(keep="failures", **{"executive.time_limit_s": 20.0})).files
    assert sorted(files) == [
        "evr.log",
        "metrics.csv",
        "overhead.png",
        "scenario.yaml",
        "summary.json",
    ]
    assert files["overhead.png"].startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("planner", "outcome", "detail"),
    [
        ("Killed", "killed", "signal SIGKILL"),
        ("Segfault", "crashed", "signal SIGSEGV"),
        ("RealTimeSignal", "crashed", "signal 40"),
        ("Exits", "crashed", "exit code 7"),
        ("CannotStart", "crashed", "ValueError: <object object at 0x...> is not what it was"),
    ],
)
def test_what_ends_a_drive_is_its_outcome_and_the_next_one_is_run(
    servers, tmp_path, planner, outcome, detail
):
    result = servers.run(task(stub(tmp_path, planner)))
    assert (result.outcome, result.detail, result.summary) == (outcome, detail, None)
    assert servers.run(task()).summary["outcome"] == "goal_reached"


def test_a_drive_that_cannot_be_run_says_why(servers):
    result = servers.run(task(goal=[500.0, 0.0]))
    assert result.outcome == "crashed"
    assert "500, 0 is not on the terrain" in result.detail


def test_a_drive_that_hangs_is_given_up_with_all_it_started(servers, tmp_path):
    result = servers.run(task(stub(tmp_path, "BreedsAndHangs"), time_out_s=1.0))
    assert (result.outcome, result.detail) == ("timed_out", "over 1 s of wall time")
    pids = told_pids(tmp_path)
    assert len(pids) == 3
    assert none_alive(pids)


def test_what_a_finished_drive_left_behind_is_killed(servers, tmp_path):
    result = servers.run(task(stub(tmp_path, "Breeds")))
    assert result.summary["outcome"] == "goal_reached"
    assert none_alive(told_pids(tmp_path))


def test_a_planner_that_prints_disturbs_nobody(servers, tmp_path):
    assert servers.run(task(stub(tmp_path, "Chatters"))).summary["outcome"] == "goal_reached"
    assert servers.run(task()).summary["outcome"] == "goal_reached"


def test_stopping_ends_drives_at_once(tmp_path):
    servers = Servers()
    seen = []

    def run():
        try:
            servers.run(task(stub(tmp_path, "BreedsAndHangs")))
        except StoppedError as error:
            seen.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    pids = told_pids(tmp_path)
    servers.stop()
    thread.join(10.0)
    assert len(seen) == 1
    assert none_alive(pids)
    with pytest.raises(StoppedError):
        servers.run(task())


def test_a_killed_supervisor_takes_its_drive_along_and_is_replaced(servers, tmp_path):
    results = []
    hanging = task(stub(tmp_path, "Hangs"))
    thread = threading.Thread(target=lambda: results.append(servers.run(hanging)))
    thread.start()
    (drive,) = told_pids(tmp_path)
    (supervisor,) = descendants(os.getpid()) - {drive}
    os.kill(supervisor, signal.SIGKILL)
    thread.join(10.0)
    until(lambda: not is_alive(drive))
    assert (results[0].outcome, results[0].detail) == ("killed", "signal SIGKILL")
    assert servers.run(task()).summary["outcome"] == "goal_reached"


ASK = """
import sys
from pyharness.child_drives import DriveTask, Servers
Servers().run(DriveTask(sys.argv[1], "none", 1000.0))
"""


def test_a_drive_dies_with_the_process_that_asked_for_it(tmp_path):
    scenario = task(stub(tmp_path, "BreedsAndHangs")).scenario
    with subprocess.Popen([sys.executable, "-c", ASK, scenario]) as asking:
        pids = told_pids(tmp_path)
        everything = descendants(asking.pid)
        assert set(pids) < everything
        asking.kill()
    until(lambda: none_alive(everything))


def test_where_no_drive_can_be_run_that_is_an_error_and_not_an_outcome(
    servers, monkeypatch, tmp_path
):
    (tmp_path / "numpy.py").write_text("raise ImportError('no numpy here')")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with pytest.raises(HarnessError, match="no drive can be run: ImportError: no numpy here"):
        servers.run(task())


def test_a_process_that_cannot_be_started_is_one_line(servers, monkeypatch):
    monkeypatch.setattr(sys, "executable", "/nowhere/python")
    with pytest.raises(HarnessError, match="no drive can be run: No such file or directory"):
        servers.run(task())


def test_drives_leave_nothing_in_the_folder_for_temporary_files(own_folder):
    servers = Servers()
    servers.run(task(keep="all"))
    assert len(list(own_folder.iterdir())) == 1
    servers.stop()
    assert list(own_folder.iterdir()) == []
