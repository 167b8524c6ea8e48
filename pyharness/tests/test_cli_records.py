# SPDX-License-Identifier: Apache-2.0
"""`enav replay` and `enav evaluate-arc` from outside: what they print and the exit code."""

import json
import shutil
import sys

import pytest

from pyharness import cli
from pyharness.dp import Kind
from pyharness.dp_file import DpReader
from pyharness.replay import read_history


@pytest.fixture
def enav(tmp_path, monkeypatch, capsys, quick_drive):
    """Run a command in a folder with a drive.dp; return exit code, output, errors."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(quick_drive, tmp_path / "drive.dp")

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["enav", *arguments])
        with pytest.raises(SystemExit) as caught:
            cli.main()
        captured = capsys.readouterr()
        return caught.value.code, captured.out, captured.err

    return run


def test_a_replay_shows_every_cycle_and_the_outcome(enav, quick_drive):
    code, out, err = enav("replay", "drive.dp")
    cycles = len(read_history(quick_drive)[0].selections)
    lines = out.splitlines()
    assert (code, err) == (0, "")
    assert [line.split()[:2] for line in lines[:-1]] == [
        ["cycle", str(number)] for number in range(1, cycles + 1)
    ]
    assert lines[-1].startswith("goal_reached: ")
    code, out, _ = enav("replay", "drive.dp", "--from-cycle", str(cycles), "--speed", "1e5")
    assert len(out.splitlines()) == 2


def test_a_replay_writes_the_metrics_of_the_drive(enav, tmp_path):
    arguments = ("--set", "terrain.size_m=40", "--set", "terrain.cfa=0", "--start=-10,0,0")
    assert enav("drive", *arguments, "--goal=0,0", "-o", "live")[0] == 0
    assert enav("replay", "live/drive.dp", "-o", "again")[0] == 0
    for name in ("metrics.csv", "truth.csv", "evr.log"):
        assert (tmp_path / "again" / name).read_text() == (tmp_path / "live" / name).read_text()
    live, again = (
        json.loads((tmp_path / name / "summary.json").read_text()) for name in ("live", "again")
    )
    del live["duration_wall_s"]
    assert again == live


def test_a_rerun_says_identical(enav):
    code, out, _ = enav("replay", "drive.dp", "--rerun")
    assert code == 0
    assert out.startswith("identical: ")


def test_a_rerun_that_differs_is_4_and_names_record_field_and_both_values(
    enav, tmp_path, record_quick_drive
):
    (tmp_path / "mine.py").write_text(
        "from pyharness.planners.enav import Enav\n"
        "class Mine(Enav):\n"
        "    def _process_disparity(self, request):\n"
        "        request['points']['z_m'] -= self.params['product_level']\n"
        "        return super()._process_disparity(request)\n"
    )
    settings = {"planner": "mine.py:Mine", "navlib": {"product_level": 1.0}}
    record_quick_drive(tmp_path / "mine.dp", settings)
    assert enav("replay", "mine.dp", "--rerun")[0] == 4
    code, out, _ = enav("replay", "mine.dp", "--rerun")
    assert code == 4
    assert "identical, then differs: record " in out
    assert ": recorded " in out
    assert ", re-run " in out


def test_a_what_if_prints_a_table_and_writes_the_drive_as_it_would_be(enav, tmp_path):
    arguments = ("replay", "drive.dp", "--rerun", "--set", "navlib.product_level=1")
    code, out, _ = enav(*arguments, "-o", "new")
    assert code == 0
    assert "selected arcs that changed: 0 of" in out
    assert {path.name for path in (tmp_path / "new").iterdir()} == {
        "drive.dp", "summary.json", "metrics.csv", "truth.csv", "evr.log",
    }  # fmt: skip
    with DpReader(tmp_path / "new/drive.dp") as reader:
        assert Kind.TREE in {record.kind for record in reader.records()}
        assert reader.damage is None
    code, _, err = enav(*arguments, "-o", "new")
    assert (code, "--force" in err) == (2, True)
    assert enav(*arguments, "-o", "new", "--force")[0] == 0


@pytest.mark.faults
def test_of_a_damaged_file_the_intact_part_is_used_and_the_exit_code_is_2(enav, tmp_path):
    whole = (tmp_path / "drive.dp").read_bytes()
    (tmp_path / "drive.dp").write_bytes(whole[:-1000])
    for arguments in ([], ["--rerun"], ["--rerun", "--set", "navlib.product_level=1"]):
        code, out, err = enav("replay", "drive.dp", *arguments)
        assert code == 2
        assert out
        assert len(err.splitlines()) == 1
        assert err.startswith("enav: drive.dp: damaged at byte ")
    code, out, err = enav("evaluate-arc", "drive.dp", "--arc", "1,0")
    assert (code, len(err.splitlines())) == (2, 1)
    assert "margin" in out
    assert enav("evaluate-arc", "drive.dp", "--arc", "1,0", "--time", "150")[0] == 0
    code, out, _ = enav("replay", "drive.dp", "-o", "metrics")
    assert code == 2
    assert (tmp_path / "metrics/metrics.csv").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["replay", "none.dp"], "none.dp: cannot be read: No such file"),
        (["replay", "."], "not a file"),
        (["replay", "mine.txt"], "not a data product file"),
        (["replay", "drive.dp", "--speed", "0"], "--speed: expected more than 0"),
        (["replay", "drive.dp", "--speed", "nan"], "--speed: expected more than 0"),
        (["replay", "drive.dp", "--set", "navlib.tilt_max_rad=0.3"], "give --rerun too"),
        (["replay", "drive.dp", "--planner", "enav"], "give --rerun too"),
        (["replay", "drive.dp", "--rerun", "--planner", "nobody"], "planner nobody: expected"),
        (["replay", "drive.dp", "--rerun", "--set", "seed=1"], "--set seed: expected navlib.NAME"),
        (["replay", "drive.dp", "--export", "csv"], "expected -o"),
        (["replay", "drive.dp", "--rerun", "-o", "x"], "nothing to write"),
        (["replay", "drive.dp", "--rerun", "--speed", "2"], "without --rerun"),
        (["replay", "drive.dp", "--from-cycle", "0"], "--from-cycle"),
        (["replay", "drive.dp", "-o", ".", "--force"], "drive.dp lies there"),
        (["replay", "drive.dp", "-o", "mine.txt"], "mine.txt: exists and is no folder"),
        (["replay", "drive.dp", "-o", "mine.txt/in"], "mine.txt/in: Not a directory"),
        (["evaluate-arc", "drive.dp", "--arc", "1"], "expected LENGTH_M,HEADING_DEG"),
        (["evaluate-arc", "drive.dp", "--arc", "nan,1"], "--arc: expected finite numbers"),
        (["evaluate-arc", "drive.dp", "--arc", "99,0"], "outside its allowed range"),
        (["evaluate-arc", "drive.dp", "--arc", "1,0", "--time", "0"], "no terrain had been"),
        (["evaluate-arc", "none.pgm", "--arc", "1,0", "--pose", "0,0,0"], "none.pgm: no such"),
        (["evaluate-arc", "none.pgm", "--arc", "1,0"], "--pose: required for a terrain"),
        (["evaluate-arc", "none.pgm", "--arc", "1,0", "--time", "1"], "--time: a terrain has"),
    ],
)
def test_bad_input_is_2_one_line_and_writes_nothing(enav, tmp_path, arguments, message):
    (tmp_path / "mine.txt").write_text("my thesis, line by line")
    code, out, err = enav(*arguments)
    assert code == 2
    assert message in err
    assert err.startswith("enav: ")
    assert len(err.splitlines()) == 1
    assert out == ""
    assert {path.name for path in tmp_path.iterdir()} == {"drive.dp", "mine.txt"}


def test_an_arc_is_evaluated_on_a_drive_and_on_a_terrain(enav):
    code, out, _ = enav("evaluate-arc", "drive.dp", "--time", "150", "--arc", "1,0")
    assert code == 0
    assert out.startswith(("safe\n", "not safe: "))
    options = ("--size-m", "40", "--cfa", "0", "--seed", "4")
    assert enav("terrain", "generate", "-o", "t.pgm", *options)[0] == 0
    code, out, _ = enav("evaluate-arc", "t.pgm", "--pose", "0,0,45", "--arc", "3,20")
    assert code == 0
    assert out.startswith("safe\narc of 3.00 m, +20.0 deg from north 0.00 m")


@pytest.mark.parametrize(
    ("style", "name"), [("csv", "TRUTH.csv"), ("parquet", "TRUTH.parquet"), ("mcap", "drive.mcap")]
)
def test_a_drive_is_exported(enav, tmp_path, style, name):
    code, out, err = enav("replay", "drive.dp", "--export", style, "-o", "out")
    assert (code, err) == (0, "")
    assert f"out/{name}: " in out
    assert (tmp_path / "out" / name).stat().st_size > 10_000
    code, _, err = enav("replay", "drive.dp", "--export", style, "-o", "out")
    assert (code, "--force" in err) == (2, True)
