# SPDX-License-Identifier: Apache-2.0
"""The command line from outside: what it prints and the exit code."""

import json
import socket
import subprocess
import sys

import pytest

from pyharness import cli
from pyharness.tests.socket_client import SocketClient

FLAT = ["--set", "terrain.size_m=40", "--set", "terrain.cfa=0", "--start=-10,0,0"]
QUICK = [*FLAT, "--goal=10,0", "--set", "executive.time_limit_s=30"]


@pytest.fixture
def enav(tmp_path, monkeypatch, capsys):
    """Run a command in an empty folder; return exit code, output, errors."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["enav", *arguments])
        with pytest.raises(SystemExit) as caught:
            cli.main()
        captured = capsys.readouterr()
        return caught.value.code, captured.out, captured.err

    return run


def test_a_reached_goal_is_0(enav, tmp_path):
    code, out, _ = enav("drive", *FLAT, "--goal", "0,0", "--timeline", "t.png")
    assert code == 0
    assert out.startswith("goal_reached: ")
    assert out.endswith("drives/demo-0\n")
    assert (tmp_path / "t.png").exists()


def test_a_fault_is_3_and_the_folder_is_complete(enav, tmp_path):
    code, out, _ = enav("drive", *QUICK, "-o", "late")
    assert code == 3
    assert out.splitlines()[0].startswith("time_limit: ")
    assert json.loads((tmp_path / "late/summary.json").read_text())["outcome"] == "time_limit"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["drive", "--goal", "900,0"], "--goal: 900, 0 is not on the terrain"),
        (["drive", "--goal", "nine"], "'--goal': expected N,E, got 'nine'"),
        (["drive", "--terrain", "none.pgm"], "none.pgm: no such file"),
        (["drive", "--scenario", "none.yaml"], "none.yaml: no such file"),
        (["drive", "--seed", "-1"], "--seed: expected >= 0, got -1"),
        (["drive", "--set", "seed"], "expected key=value, got 'seed'"),
        (["drive", "--set", "sed=1"], "--set sed: unknown key, did you mean 'seed'?"),
        (["drive", "--set", "navlib.tilt_max_rad=9"], "expected 0.05 to 1.2 rad, got 9"),
        (["drive", "--mode", "fast"], "'fast' is not one of"),
        (["drive", "--planner", "nobody"], "planner nobody: expected"),
        (["drive", "--gaol", "1,2"], "--goal"),
        (["terrain", "generate", "-o", "a.pgm", "--cfa", "7"], "--cfa: expected <= 0.4"),
        (["terrain", "generate", "-o", "a.pgm", "--base", "x.tif"], "x.tif: no such file"),
        (["terrain", "generate"], "Missing option '-o'"),
        (["drvie"], "drvie"),
    ],
)
def test_bad_input_is_2_one_line_and_no_folder(enav, tmp_path, arguments, message):
    code, out, err = enav(*arguments)
    assert code == 2
    assert message in err
    assert err.startswith("enav: ")
    assert len(err.splitlines()) == 1
    assert out == ""
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("header", "pixels", "message"),
    [
        (b"P5\n4 4\n255\n", 16, "16-bit"),
        (b"P5\n4 4\n65535\n", 31, "too short"),
        (b"P2\n4 4\n65535\n", 32, "P5"),
        (b"GIF89a", 100, "P5"),
    ],
)
def test_what_is_no_terrain_is_2(enav, tmp_path, header, pixels, message):
    (tmp_path / "t.pgm").write_bytes(header + bytes(pixels))
    side_car = "z_offset_m: 0\nz_scale_m_per_count: 0.01\ncell_m: 0.1\nrows: 4\ncols: 4\n"
    (tmp_path / "t.yaml").write_text(side_car)
    code, _, err = enav("drive", "--terrain", "t.pgm")
    assert code == 2
    assert "t.pgm" in err
    assert message in err
    assert len(err.splitlines()) == 1
    assert not (tmp_path / "drives").exists()


def test_every_fault_of_a_file_is_a_line(enav, tmp_path):
    (tmp_path / "s.yaml").write_text("sed: 1\ngoal: [x, 0]\n")
    code, _, err = enav("drive", "--scenario", "s.yaml")
    assert code == 2
    assert sorted(err.splitlines()) == [
        "enav: s.yaml:1:1: sed: unknown key, did you mean 'seed'?",
        "enav: s.yaml:2:8: goal.0: expected a number, got 'x'",
    ]


def test_a_second_drive_needs_force(enav):
    assert enav("drive", *QUICK)[0] == 3
    code, _, err = enav("drive", *QUICK)
    assert (code, "--force" in err) == (2, True)
    assert enav("drive", *QUICK, "--force")[0] == 3


def test_a_goal_option_replaces_the_waypoints_of_a_file(enav, tmp_path):
    (tmp_path / "s.yaml").write_text("waypoints: [{goal_site_m: [1, 0]}, {goal_site_m: [2, 0]}]")
    arguments = ("drive", "--scenario", "s.yaml", *QUICK, "--goal", "12,0", "-o", "x")
    assert enav(*arguments)[0] == 3
    assert "goal_site_m: [12.0, 0.0]" in (tmp_path / "x/scenario.yaml").read_text()


def test_a_terrain_is_made_and_driven_on(enav, tmp_path):
    options = ("--size-m", "40", "--cfa", "0.02", "--undulation", "5,0.2", "--seed", "4")
    code, out, _ = enav("terrain", "generate", "-o", "t.pgm", *options, "--start=-10,0,0")
    assert code == 0
    assert out.startswith("t.pgm: 40 x 40 m, ")
    names = {"t.pgm", "t.yaml", "t.rocks.csv"}
    assert {path.name for path in tmp_path.iterdir()} == names
    code, out, _ = enav("drive", "--terrain", "t.pgm", "--start=-10,0,0", "--goal", "0,0")
    assert code == 0, out


@pytest.mark.parametrize("name", ["params", "evrs", "dps"])
@pytest.mark.parametrize("style", ["text", "yaml", "markdown"])
def test_tables_are_listed(enav, name, style):
    code, out, _ = enav(name, "--format", style)
    assert code == 0
    assert len(out.splitlines()) > 10


def test_an_interrupt_is_130_without_a_traceback(enav, monkeypatch):
    def interrupt(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(cli, "cli", interrupt)
    assert enav("drive") == (130, "", "enav: interrupted\n")


def test_help_does_not_load_what_only_drives_need():
    code = "import sys, pyharness.cli; print([m for m in ('numpy', '_navlib') if m in sys.modules])"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout == "[]\n"


def test_a_drive_with_a_port_is_run_by_its_client(tmp_path):
    code = "import sys; sys.argv = ['enav', *sys.argv[1:]]; from pyharness.cli import main; main()"
    arguments = ["drive", *QUICK, "--port", "0", "-o", str(tmp_path / "d")]
    with subprocess.Popen(
        [sys.executable, "-c", code, *arguments], stderr=subprocess.PIPE, text=True, cwd=tmp_path
    ) as process:
        line = process.stderr.readline()
        port = int(line.split("127.0.0.1:")[1].split()[0])
        client = SocketClient(port)
        client.ask(command="run")
        lines = client.read_all()
        client.close()
        assert process.wait(60) == 3
        process.stderr.close()
    assert lines[0]["type"] == "schema"
    assert any(item["type"] == "end" and item["outcome"] == "time_limit" for item in lines)
    assert json.loads((tmp_path / "d/summary.json").read_text())["outcome"] == "time_limit"


def test_a_port_in_use_is_2_and_leaves_nothing(enav, tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        code, _, err = enav("drive", *QUICK, "--port", str(port), "-o", "d")
    assert code == 2
    assert err.startswith(f"enav: port {port} of 127.0.0.1: ")
    assert len(err.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


def test_arcs_that_were_driven_are_0(enav):
    arcs = "[{length_m: 2, mode: unguarded}]"
    code, out, _ = enav("drive", *FLAT, "--set", f"arcs={arcs}", "--set", "slip.enabled=false")
    assert code == 0
    assert out.startswith("arcs_driven: 2.0 m")


def test_the_modes_are_driven_on_a_scenario_of_ones_own(enav, tmp_path):
    (tmp_path / "s.yaml").write_text(
        "name: s\nterrain: {size_m: 40, cfa: 0}\nstart: [-10, 0, 0]\ngoal: [-7, 0]\n"
    )
    code, out, _ = enav("modes", "--scenario", "s.yaml", "-o", "m")
    assert code == 0
    assert [line.split()[0] for line in out.splitlines()[:4]] == list(cli.MODES)
    assert (tmp_path / "m/modes.png").exists()
    assert (tmp_path / "m/guarded/summary.json").exists()
