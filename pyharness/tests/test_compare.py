# SPDX-License-Identifier: Apache-2.0
import csv
import io
import json
from dataclasses import replace

import pytest
from click.testing import CliRunner

from pyharness import compare
from pyharness.cli import cli
from pyharness.errors import HarnessError, OutputError
from sim.errors import SimError

QUICK = {
    "terrain.size_m": 30.0,
    "start": [-8.0, 0.0, 0.0],
    "goal": [8.0, 0.0],
    "camera.cloud_width_px": 40,
    "camera.cloud_height_px": 30,
    "executive.time_limit_s": 150.0,
}


def quick_jobs(folder, planners=("enav",), seeds=(0,)):
    jobs = compare.comparison_jobs(folder, planners, seeds)[:2]
    return [replace(job, overrides={**job.overrides, **QUICK}) for job in jobs]


def result(outcome="goal_reached", inefficiency=0.1, evaluations=50.0):
    names = dict.fromkeys(compare.DRIVE_COLUMNS, 1.0)
    return {
        **names,
        "outcome": outcome,
        "path_inefficiency": inefficiency,
        "ace_evaluations_mean": evaluations,
    }


def test_every_planner_gets_the_same_terrains_and_seeds(tmp_path):
    jobs = compare.comparison_jobs(tmp_path, ["enav", "rrtsharp"], range(10))
    assert len(jobs) == 2 * 40
    places = {
        planner: [(job.cfa, job.slope_deg, job.seed) for job in jobs if job.planner == planner]
        for planner in ("enav", "rrtsharp")
    }
    assert places["enav"] == places["rrtsharp"]
    assert len(set(places["enav"])) == 40


def test_a_planner_of_a_file_is_a_column_by_the_name_of_its_class():
    assert compare.variant("some/mine.py:Mine") == ("Mine", {"planner": "some/mine.py:Mine"})


@pytest.mark.slow
def test_finished_drives_are_not_run_again(tmp_path):
    jobs = quick_jobs(tmp_path)
    seen = []
    results = compare.run_comparison(jobs, 2, lambda _, is_new: seen.append(is_new))
    assert seen == [True, True]
    assert {outcome["outcome"] for _, outcome in results} == {"time_limit"}
    assert not (jobs[0].folder / "drive.dp").exists()
    assert (jobs[0].folder / "overhead.png").exists()

    again = compare.run_comparison(jobs, 1, lambda _, is_new: seen.append(is_new))
    assert seen[2:] == [False, False]
    assert again == results
    table = compare.write_tables(tmp_path, again)
    assert table == (tmp_path / "table.md").read_text("utf-8")

    other = [replace(jobs[0], overrides={**jobs[0].overrides, "executive.time_limit_s": 160.0})]
    with pytest.raises(OutputError, match="a drive with other settings"):
        compare.run_comparison(other, 1, lambda *_: None)


@pytest.mark.slow
def test_a_drive_that_cannot_be_run_is_one_line(tmp_path):
    (job, _) = quick_jobs(tmp_path)
    broken = replace(job, overrides={**job.overrides, "terrain.file": "nowhere.pgm"})
    with pytest.raises(HarnessError, match=r"the drive could not be run: enav:.*file") as error:
        compare.run_comparison([broken], 1, lambda *_: None)
    assert "\n" not in str(error.value)


def test_results_are_counted_by_planner_and_kind_of_terrain(tmp_path):
    jobs = compare.comparison_jobs(tmp_path, ["enav"], [0, 1])
    outcomes = ["goal_reached", "limit_violation", "no_path", "stuck"] * 2
    results = [
        (job, {**result(outcome), "paths_tested_mean": 7.0})
        for job, outcome in zip(jobs, outcomes, strict=True)
    ]
    *cells, total = compare.summary_rows(results)
    assert [(row["CFA, %"], row["slope, deg"]) for row in cells] == [
        ("7", "0"), ("7", "5"), ("10", "0"), ("10", "5"),
    ]  # fmt: skip
    assert [row["reached"] for row in cells] == [2, 0, 0, 0]
    assert [row["inefficiency, %"] for row in cells] == ["10.0", "-", "-", "-"]
    counts = ("drives", "reached", "true limit violated", "no path", "other fault")
    assert [total[name] for name in counts] == [8, 2, 2, 2, 2]
    assert total["candidates a cycle"] == "7.0"


def test_drives_are_listed_one_by_one(tmp_path):
    jobs = compare.comparison_jobs(tmp_path, ["enav"], [3])
    results = [(job, {**result(), "paths_tested_mean": 7.0}) for job in jobs]
    rows = list(csv.DictReader(io.StringIO(compare.drives_csv(results))))
    assert [row["seed"] for row in rows] == ["3"] * 4
    assert rows[0]["outcome"] == "goal_reached"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--planner", "nobody"], "planner nobody: expected file.py:Class or one of enav"),
        (["--seeds", "0"], "0 is not in the range"),
        (["--first-seed", str(2**63)], "seed: expected"),
    ],
)
def test_bad_input_is_refused_before_anything_is_run(tmp_path, options, message):
    answer = CliRunner().invoke(cli, ["compare", "-o", str(tmp_path / "out"), *options])
    said = answer.output + str(answer.exception)
    assert answer.exit_code != 0
    assert message in said
    assert not (tmp_path / "out").exists()
    assert isinstance(answer.exception, HarnessError | SimError | SystemExit)


def test_a_folder_that_cannot_be_made_is_one_line(tmp_path):
    (tmp_path / "file").write_text("")
    answer = CliRunner().invoke(cli, ["compare", "-o", str(tmp_path / "file" / "out")])
    assert isinstance(answer.exception, OutputError)
    assert "file" in str(answer.exception)


def test_results_hold_the_candidates_of_all_cycles(tmp_path):
    (job, *_) = compare.comparison_jobs(tmp_path, ["enav"], [0])
    job.folder.mkdir(parents=True)
    (job.folder / "summary.json").write_text(json.dumps(result()))
    (job.folder / "metrics.csv").write_text("cycle,paths_tested\n1,10\n2,20\n")
    assert compare._result(job)["paths_tested_mean"] == 15.0
