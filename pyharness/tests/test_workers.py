# SPDX-License-Identifier: Apache-2.0
"""A real Dask scheduler and two worker processes, started and killed here."""

import json
import os
import subprocess
import sys
from concurrent.futures import CancelledError, Future

import pytest

from pyharness import workers
from pyharness.campaign import load_campaign
from pyharness.child_drives import DriveTask
from pyharness.errors import HarnessError
from pyharness.montecarlo import run_campaign
from pyharness.tests.campaign_runs import (
    descendants,
    is_alive,
    rows_of,
    run,
    stub,
    until,
    write_campaign,
)
from pyharness.workers import dask_workers, local_workers, run_on_worker

QUIET = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}


class Cluster:
    """A scheduler, and workers of one thread."""

    def __init__(self, folder):
        self.folder = folder
        self.processes = []
        self._start("scheduler", "--port", "0", "--no-dashboard", "--no-show")
        self.scheduler = self.processes[0]
        until((folder / "scheduler.json").exists)

    def _start(self, what, *options):
        command = [sys.executable, "-m", f"distributed.cli.dask_{what}", "--scheduler-file"]
        process = subprocess.Popen(
            [*command, str(self.folder / "scheduler.json"), *options], cwd=self.folder, **QUIET
        )
        self.processes.append(process)
        return process

    @property
    def address(self):
        return json.loads((self.folder / "scheduler.json").read_text())["address"]

    def add_worker(self):
        return self._start(
            "worker", "--nthreads", "1", "--no-nanny", "--no-dashboard", "--death-timeout", "60"
        )

    def close(self):
        for process in self.processes:
            process.kill()
        for process in self.processes:
            process.wait()


@pytest.fixture
def cluster(tmp_path):
    pytest.importorskip("distributed")
    (tmp_path / "cluster").mkdir()
    cluster = Cluster(tmp_path / "cluster")
    yield cluster
    children = {pid for process in cluster.processes for pid in descendants(process.pid)}
    cluster.close()
    until(lambda: not any(map(is_alive, children)))


@pytest.mark.faults
@pytest.mark.slow
def test_a_cluster_that_loses_a_worker_gives_the_table_of_one_machine(tmp_path, cluster):
    victim, _ = cluster.add_worker(), cluster.add_worker()
    name = write_campaign(tmp_path)
    killed = []

    def kill_worker(*_):
        if not killed:
            killed.extend(until(lambda: descendants(victim.pid)))
            victim.kill()

    with dask_workers(cluster.address) as pool:
        assert pool.about["scheduler"] == cluster.address
        run_campaign(load_campaign(name), tmp_path / "out", pool, kill_worker)
    assert killed
    until(lambda: not any(map(is_alive, killed)))
    run(name, tmp_path / "here")
    assert rows_of(tmp_path / "out") == rows_of(tmp_path / "here")
    assert len(rows_of(tmp_path / "out")) == 12


@pytest.mark.faults
@pytest.mark.slow
def test_drives_on_a_cluster_crash_hang_and_are_kept_as_on_one_machine(tmp_path, cluster):
    cluster.add_worker()
    sets = {
        "kill": {"planner": stub(tmp_path, "Killed")},
        "hang": {"planner": stub(tmp_path, "Hangs")},
        "short": {"executive.time_limit_s": 20.0},
    }
    name = write_campaign(
        tmp_path, axes={}, parameter_sets=sets, seeds=1, time_out_s=8.0, keep="failures"
    )
    with dask_workers(cluster.address) as pool:
        table, _ = run_campaign(load_campaign(name), tmp_path / "out", pool, lambda *_: None)
    assert [row["outcome"] for row in table.rows] == ["killed", "timed_out", "time_limit"]
    kept = tmp_path / "out/drives/short-seed0000"
    assert (kept / "overhead.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.faults
@pytest.mark.slow
def test_without_its_scheduler_a_campaign_stops_in_one_line_and_goes_on_here(tmp_path, cluster):
    worker = cluster.add_worker()
    name = write_campaign(tmp_path)

    def kill_scheduler(*_):
        cluster.scheduler.kill()

    with pytest.raises(HarnessError) as error, dask_workers(cluster.address) as pool:
        run_campaign(load_campaign(name), tmp_path / "out", pool, kill_scheduler)
    assert str(error.value) == f"{cluster.address}: the Dask scheduler is gone"
    done = len(rows_of(tmp_path / "out"))
    assert 0 < done < 12
    worker.kill()
    seen = []
    run(name, tmp_path / "out", on_done=lambda *told: seen.append(told))
    assert [is_new for _, is_new in seen].count(False) == done


@pytest.mark.faults
def test_an_address_without_a_scheduler_is_one_line(monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr(workers, "DASK_TIME_OUT_S", 1)
    with pytest.raises(HarnessError) as error, dask_workers("tcp://127.0.0.1:9"):
        pass
    assert str(error.value).startswith("--scheduler tcp://127.0.0.1:9: no Dask scheduler answers")
    assert "\n" not in str(error.value)


def test_without_the_extra_it_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(HarnessError, match="the extra `cluster`"), dask_workers("tcp://x:1"):
        pass


def test_a_worker_of_another_version_runs_nothing():
    with pytest.raises(HarnessError, match=r"a worker has enav-sim .*, expected 99.0"):
        run_on_worker(DriveTask("", "none", 1.0), "99.0")


@pytest.mark.faults
@pytest.mark.parametrize(
    ("error", "expected"),
    [
        (ModuleNotFoundError("No module named 'pyharness'"), "a worker cannot run drives: Module"),
        (HarnessError("a worker has enav-sim 1.0"), "a worker has enav-sim 1.0"),
        (CancelledError(), "the Dask scheduler is gone"),
    ],
)
def test_what_a_cluster_cannot_do_is_one_line(cluster, error, expected):
    future = Future()
    future.set_exception(error)
    with dask_workers(cluster.address) as pool, pytest.raises(HarnessError, match=expected):
        pool.result(future)


@pytest.mark.faults
def test_a_drive_whose_workers_all_died_was_killed(cluster):
    killed = pytest.importorskip("distributed").KilledWorker
    future = Future()
    future.set_exception(killed("task", None, 4))
    with dask_workers(cluster.address) as pool:
        result = pool.result(future)
    assert (result.outcome, result.summary) == ("killed", None)


def test_nothing_runs_on_after_local_workers_are_gone():
    before = descendants(os.getpid())
    with local_workers(2) as pool:
        assert pool.about == {"workers": 2, "scheduler": None}
    assert descendants(os.getpid()) == before
