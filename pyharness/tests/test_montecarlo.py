# SPDX-License-Identifier: Apache-2.0
"""A campaign gives the same table however often, and by whatever, it was stopped."""

import errno
import json
import os
import signal
import subprocess
import sys

import pytest

from pyharness import campaign_folder, drive_table
from pyharness.errors import HarnessError, OutputError
from pyharness.montecarlo import run_campaign, status_rows
from pyharness.tests.campaign_runs import (
    descendants,
    is_alive,
    rows_of,
    run,
    stub,
    told_pids,
    until,
    write_campaign,
)
from sim.errors import TerrainError

pytestmark = pytest.mark.slow

COMMAND = "import sys; from pyharness.cli import main; sys.argv[0] = 'enav'; main()"


def start(name, out, *options):
    command = [sys.executable, "-c", COMMAND, "montecarlo", "run", name, "-o", str(out), *options]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def finished(out):
    return sorted(path.name for path in (out / "results").glob("*.json"))


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """The quick campaign, run by one worker in one go."""
    folder = tmp_path_factory.mktemp("undisturbed")
    run(write_campaign(folder), folder / "out", workers=1)
    return folder / "out"


def test_any_number_of_workers_gives_the_same_table(undisturbed, tmp_path):
    table = run(write_campaign(tmp_path), tmp_path / "out", workers=3)
    assert rows_of(tmp_path / "out") == rows_of(undisturbed)
    assert len(rows_of(undisturbed)) == 12
    assert table.margins == drive_table.load(undisturbed).margins


def test_a_finished_campaign_runs_nothing_again(undisturbed):
    before = (undisturbed / "drives.csv").read_bytes(), (undisturbed / "run.json").read_bytes()
    seen = []
    run(str(undisturbed / "campaign.yaml"), undisturbed, on_done=lambda *told: seen.append(told))
    assert seen == [("goal_reached", False)] * 12
    assert before == (
        (undisturbed / "drives.csv").read_bytes(),
        (undisturbed / "run.json").read_bytes(),
    )


def test_the_record_of_the_run_says_with_what_and_how_long(undisturbed):
    record = json.loads((undisturbed / "run.json").read_text())
    assert record["workers"] == 1
    assert record["sessions"] == 1
    assert record["started"] <= record["ended"]
    assert record["wall_time_s"] > 0.0
    assert record["versions"] == [f"{record['enav_sim']} {record['revision']}"]


@pytest.mark.faults
def test_a_killed_campaign_leaves_no_process_and_goes_on_to_the_same_table(undisturbed, tmp_path):
    name, out = write_campaign(tmp_path), tmp_path / "out"
    with start(name, out, "--workers", "2") as process:
        until(lambda: len(finished(out)) >= 3)
        children = descendants(process.pid)
        process.kill()
    assert children
    until(lambda: not any(map(is_alive, children)))
    done = finished(out)
    assert 3 <= len(done) < 12
    assert not (out / "drives.csv").exists()

    seen = []
    run(name, out, on_done=lambda *told: seen.append(told))
    assert [is_new for _, is_new in seen].count(False) == len(done)
    assert rows_of(out) == rows_of(undisturbed)
    assert json.loads((out / "run.json").read_text())["sessions"] == 2


@pytest.mark.faults
def test_ctrl_c_ends_a_campaign_at_once_with_a_table_of_what_is_finished(tmp_path):
    hang = {"planner": stub(tmp_path, "Hangs")}
    name = write_campaign(tmp_path, parameter_sets={"own": {}, "hang": hang})
    with start(name, tmp_path / "out", "--workers", "2") as process:
        told_pids(tmp_path, 2)
        children = descendants(process.pid)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=20)
    assert process.returncode == 130
    assert [line for line in said.splitlines() if line] == [
        f"enav: {len(finished(tmp_path / 'out'))} of 24 drives are done;"
        " the same command goes on from there",
        "enav: interrupted",
    ]
    assert not any(map(is_alive, children))
    assert len(rows_of(tmp_path / "out")) == len(finished(tmp_path / "out")) > 0


@pytest.mark.faults
def test_a_drive_that_is_killed_crashes_or_hangs_costs_nothing_but_itself(undisturbed, tmp_path):
    sets = {
        name: {"planner": stub(tmp_path, planner)}
        for name, planner in (("kill", "Killed"), ("crash", "Segfault"), ("hang", "Hangs"))
    }
    changes = {"parameter_sets": {"own": {}, **sets}, "seeds": 1, "time_out_s": 8.0}
    table = run(write_campaign(tmp_path, **changes), tmp_path / "out", workers=4)
    outcomes = {row["parameter_set"]: row["outcome"] for row in table.rows}
    assert outcomes == {
        "own": "goal_reached",
        "kill": "killed",
        "crash": "crashed",
        "hang": "timed_out",
    }
    (lost, *_) = [row for row in rows_of(tmp_path / "out") if row["parameter_set"] == "kill"]
    assert lost["planner"] == "stubs.py:Killed"
    assert lost["mode"] == "avoid_all"
    assert lost["fault_detail"] == "signal SIGKILL"
    assert lost["distance_driven_m"] == lost["rejections_cost"] == ""
    own = [row for row in rows_of(tmp_path / "out") if row["parameter_set"] == "own"]
    for row, expected in zip(own, rows_of(undisturbed), strict=False):
        differing = {key for key in row if row[key] != expected[key]}
        assert differing == {"name", "parameter_set"}


@pytest.fixture
def small_disk(tmp_path):
    """A disk with room for a few results."""
    folder = tmp_path / "disk"
    folder.mkdir()
    options = ["-t", "tmpfs", "-o", "size=48k", "tmpfs", str(folder)]
    if os.geteuid() != 0 or subprocess.run(["mount", *options], check=False).returncode:
        pytest.skip("only root can mount a small disk")
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


@pytest.mark.faults
def test_a_full_disk_is_one_line_and_costs_nothing_that_is_finished(
    undisturbed, tmp_path, small_disk
):
    name, out = write_campaign(tmp_path), small_disk / "out"
    with start(name, out, "--workers", "2") as process:
        _, said = process.communicate(timeout=100)
    assert process.returncode == 2
    done = finished(out)
    assert 0 < len(done) < 12
    (line,) = said.splitlines()
    assert line.startswith(f"enav: {out}/")
    assert line.endswith(
        f": No space left on device; {len(done)} of 12 drives are done, the same command goes on"
    )
    subprocess.run(["mount", "-o", "remount,size=4m", str(small_disk)], check=True)
    seen = []
    run(name, out, on_done=lambda *told: seen.append(told))
    assert [is_new for _, is_new in seen].count(False) == len(done)
    assert rows_of(out) == rows_of(undisturbed)


@pytest.mark.faults
def test_a_write_that_fails_stops_the_campaign_and_the_same_command_goes_on(
    undisturbed, tmp_path, monkeypatch
):
    name, out = write_campaign(tmp_path), tmp_path / "out"
    write = campaign_folder.write_atomic

    def write_until_full(path, content):
        if path.parent.name == "results" and len(finished(out)) == 2:
            raise TerrainError(f"{path}: cannot be written: {os.strerror(errno.ENOSPC)}")
        write(path, content)

    with monkeypatch.context() as patch:
        patch.setattr(campaign_folder, "write_atomic", write_until_full)
        with pytest.raises(TerrainError, match="No space left"):
            run(name, out)
    assert len(rows_of(out)) == len(finished(out)) == 2
    run(name, out)
    assert rows_of(out) == rows_of(undisturbed)


@pytest.mark.faults
def test_no_room_for_temporary_files_is_no_outcome(tmp_path, small_disk, monkeypatch):
    monkeypatch.setenv("TMPDIR", str(small_disk))
    name, out = write_campaign(tmp_path, keep="all"), tmp_path / "out"
    with pytest.raises(OutputError, match="no space left on device"):
        run(name, out)
    assert finished(out) == []


@pytest.mark.faults
def test_two_runs_into_one_folder_are_refused(tmp_path):
    name = write_campaign(tmp_path)
    out = tmp_path / "out"

    def run_again(*_):
        with start(name, out) as process:
            _, said = process.communicate(timeout=60)
        assert process.returncode == 2
        assert "another run is at work there" in said
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(name, out, on_done=run_again)


def test_kept_folders_are_those_of_failures(tmp_path):
    sets = {"short": {"executive.time_limit_s": 20.0}, "long": {}}
    name = write_campaign(tmp_path, parameter_sets=sets, seeds=1, axes={}, keep="failures")
    table = run(name, tmp_path / "out")
    failed = {row["name"] for row in table.rows if row["outcome"] == "time_limit"}
    assert len(failed) == 1
    assert {path.name for path in (tmp_path / "out/drives").iterdir()} == failed


def test_status_counts_outcomes_by_cell(tmp_path):
    sets = {"short": {"executive.time_limit_s": 20.0}, "long": {}}
    axes = {"terrain.cfa": [0.03, 0.15]}
    run(write_campaign(tmp_path, parameter_sets=sets, seeds=2, axes=axes), tmp_path / "out")
    (tmp_path / "out/results/short-cfa0.15-seed0001.json").unlink()
    table = drive_table.load(tmp_path / "out")
    *cells, total = status_rows(table)
    assert len(cells) == 4
    assert list(total) == [
        "planner", "parameter_set", "terrain.cfa", "done", "missing", "goal_reached", "time_limit",
    ]  # fmt: skip
    assert list(total.values()) == ["all"] * 3 + [7, 1, 4, 3]
    assert list(cells[-2].values()) == ["enav", "short", "0.15", 1, 1, 0, 1]


def test_a_result_that_is_damaged_is_one_line(tmp_path):
    name, out = write_campaign(tmp_path, axes={}, seeds=1), tmp_path / "out"
    run(name, out)
    (path,) = (out / "results").iterdir()
    path.write_text('{"row": ')
    with pytest.raises(HarnessError, match="not the result of a drive"):
        run_campaign(drive_table.read_campaign(out), out, None, lambda *_: None)
