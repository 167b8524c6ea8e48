# SPDX-License-Identifier: Apache-2.0
"""`enav terrain` from outside: what it writes, what it prints, exit codes."""

import sys

import numpy as np
import pytest
import yaml

from pyharness import cli
from sim.terrain import centred
from sim.terrain_io import read_terrain, write_terrain


@pytest.fixture
def enav(tmp_path, monkeypatch, capsys):
    """Run a command in an empty folder; return exit code, output, errors."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["enav", "terrain", *arguments])
        with pytest.raises(SystemExit) as caught:
            cli.main()
        captured = capsys.readouterr()
        return caught.value.code, captured.out, captured.err

    return run


@pytest.fixture
def dem(tmp_path):
    """A PGM as a map of 60 x 70 m: hills."""
    n, e = np.meshgrid(np.arange(60.0), np.arange(70.0), indexing="ij")
    up_m = np.float32(np.sin(n / 6) + np.cos(e / 8))
    (tmp_path / "maps").mkdir()
    write_terrain(centred(-up_m, 1.0), tmp_path / "maps/dem.pgm")
    return "maps/dem.pgm"


def test_several_landforms_and_layers_become_a_recipe(enav, tmp_path):
    options = ["--landform", "crater,2,8", "--landform", "valley,1,6,0,3,45", "--size-m", "20"]
    code, _, _ = enav("generate", "-o", "t.pgm", *options, "--undulation", "3,0.1")
    assert code == 0
    recipe = yaml.safe_load((tmp_path / "t.yaml").read_text())["recipe"]
    assert [form["kind"] for form in recipe["landforms"]] == ["crater", "valley"]
    assert recipe["landforms"][1]["center_m"] == [0.0, 3.0]
    assert recipe["landforms"][1]["azimuth_deg"] == 45.0


@pytest.mark.usefixtures("dem")
def test_a_recipe_finds_its_base_beside_itself(enav, tmp_path):
    (tmp_path / "maps/r.yaml").write_text(
        "size_m: 20\nbases:\n- {file: dem.pgm}\n- {file: dem.pgm, scale: 0.5, center_m: [3, 0]}\n"
    )
    assert enav("generate", "-o", "t.pgm", "--recipe", "maps/r.yaml")[0] == 0
    assert enav("generate", "-o", "u.pgm", "--recipe", "t.yaml")[0] == 0
    assert (tmp_path / "t.pgm").read_bytes() == (tmp_path / "u.pgm").read_bytes()


def test_a_set_goes_on(enav, tmp_path):
    (tmp_path / "r.yaml").write_text("size_m: 10\n")
    options = (
        "--recipe",
        "r.yaml",
        "--slopes-deg",
        "0,10",
        "--cfas",
        "0.07,0.15",
        "--workers",
        "1",
    )
    assert enav("set", "s", "--count", "5", *options)[:2] == (0, "s: 5 terrains made\n")
    code, out, _ = enav("set", "s", "--count", "6", *options)
    assert (code, out) == (0, "s: 1 terrains made, 5 were there\n")
    lines = (tmp_path / "s/terrains.csv").read_text().splitlines()
    assert lines[0] == "file,slope_deg,cfa,seed"
    assert lines[6] == "slope00-cfa15-seed0001.pgm,0,0.15,1"


@pytest.mark.usefixtures("dem")
def test_patches_of_a_map_and_a_configuration_file(enav, tmp_path):
    pytest.importorskip("rasterio")
    options = ("--size-m", "20", "--cfa", "0.07", "--workers", "1")
    (tmp_path / "maps/o.yaml").write_text("dem: dem.pgm\nstart_m: null\nlanding_count: 5\n")
    code, out, _ = enav("orbital", "--config", "maps/o.yaml", "-o", "p", "--count", "2", *options)
    assert code == 0
    assert out.startswith("p: 2 terrains made along 40 routes")
    assert read_terrain(tmp_path / "p/patch-0001.pgm").z_site_m.shape == (200, 200)
    places = ("--landing=-20,-20", "--region", "20,20,3", "--seed", "2")
    config = ("--config", "maps/o.yaml", "-o", "q", "--count", "1")
    code, out, _ = enav("orbital", *config, *options, *places)
    assert (code, "along 1 routes" in out) == (0, True)


def test_pictures_are_written(enav, tmp_path):
    assert enav("generate", "-o", "t.pgm", "--size-m", "20", "--cfa", "0.1")[0] == 0
    assert enav("show", "t.pgm", "--rocks-above-m", "0.2")[:2] == (0, "t.png\n")
    assert enav("show", "t.pgm", "--profile=-5,-5:5,5", "-o", "p.png")[0] == 0
    assert enav("show", "t.pgm", "--layer", "all", "-o", "a.png")[0] == 0
    assert enav("show", "t.pgm", "--layer", "rocks", "-o", "r.png")[0] == 0
    assert enav("cfa", "t.pgm")[:2] == (0, "cfa.png\n")
    assert enav("cfa", "--seeds", "2", "-o", "law.png")[0] == 0
    for name in ("t", "p", "a", "r", "cfa", "law"):
        assert (tmp_path / f"{name}.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.usefixtures("dem")
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["generate", "-o", "t.pgm", "--cfa", "0.41"], "--cfa: expected <= 0.4, got 0.41"),
        (["generate", "-o", "t.pgm", "--cfa=-0.1"], "--cfa: expected >= 0"),
        (["generate", "-o", "t.pgm", "--cfa", "nan"], "--cfa: expected a finite number"),
        (["generate", "-o", "t.pgm", "--seed", "-1"], "--seed: expected >= 0"),
        (["generate", "-o", "t.pgm", "--seed", str(2**64)], "--seed: expected <="),
        (["generate", "-o", "t.pgm", "--landform", "hill"], "expected one of crater"),
        (["generate", "-o", "t.pgm", "--landform", "crater,x"], "expected KIND[,HEIGHT_M"),
        (["generate", "-o", "t.pgm", "--base", "maps/dem.pgm"], "not inside the base of 59 x 69"),
        (["generate", "-o", "t.pgm", "--base", "m.tif", "--base-band", "0"], "expected >= 1"),
        (["generate", "-o", "t.pgm", "--base-scale", "2"], "base_scale needs a base_file"),
        (["generate", "-o", "t.pgm", "--rock-diameter-m", "0,1"], "rock_diameter_min_m"),
        (["generate", "-o", "t.pgm", "--rock-diameter-m", "2,1"], "must be less than"),
        (["generate", "-o", "t.pgm", "--start", "70,0,0"], "is not on the terrain"),
        (["generate", "-o", "t.pgm", "--cfa", "0.1", "--cfa-map", "c.tif"], "not both"),
        (["generate", "-o", "t.pgm", "--recipe", "maps"], "maps: not a file"),
        (["set", "s", "--count", "0"], "--count: expected >= 1"),
        (["set", "s", "--cfas", "7"], "expected <= 0.4"),
        (["set", "s", "--cfas", "7;10"], "--cfas: expected numbers separated by commas"),
        (["set", "s", "--recipe", "none.yaml"], "none.yaml: no such file"),
        (["set", "maps"], "maps: holds other terrains"),
        (["orbital", "-o", "p"], "Missing option '--dem'"),
        (["orbital", "-o", "p", "--dem", "none.tif"], "none.tif: no such file"),
        (["orbital", "-o", "p", "--dem", "maps/dem.pgm"], "120 m is larger than the map"),
        (["orbital", "-o", "p", "--dem", "maps/dem.pgm", "--band", "2"], "no band 2"),
        (["orbital", "-o", "p", "--dem", "maps/dem.pgm", "--cfa", "0.5"], "--cfa: expected <= 0.4"),
        (["orbital", "-o", "p", "--dem", "maps/dem.pgm", "--landing", "1"], "expected N,E"),
        (["show", "none.pgm"], "none.pgm: no such file"),
        (["show", "maps/dem.pgm", "--layer", "ground"], "layers are not known"),
        (["show", "maps/dem.pgm", "--profile", "1,2"], "expected N,E:N,E, got '1,2'"),
        (["show", "maps/dem.pgm", "--profile", "0,0:99,0"], "99, 0 is not on the terrain"),
        (["show", "maps/dem.pgm", "--rocks-above-m", "-1"], "expected 0 to 100"),
        (["show", "maps/dem.pgm", "-o", "x.jpg"], "expected a name ending in .png"),
        (["cfa", "maps/dem.pgm"], "not made with a CFA"),
        (["shwo", "x"], "shwo"),
    ],
)  # fmt: skip
def test_bad_input_is_2_and_one_line(enav, tmp_path, arguments, message):
    before = sorted(path.name for path in (tmp_path / "maps").iterdir())
    code, out, err = enav(*arguments)
    assert code == 2
    assert message in err
    assert len(err.splitlines()) == 1
    assert out == ""
    assert sorted(path.name for path in (tmp_path / "maps").iterdir()) == before
    assert not list(tmp_path.glob("*.p?m"))
    assert not list(tmp_path.glob("p/patch*"))
