# SPDX-License-Identifier: Apache-2.0
"""Sets of terrains and patches of maps: parallel, resumable, the same bytes again."""

import os
import signal
import time
from pathlib import Path

import pytest

from pyharness.errors import HarnessError
from pyharness.terrain_batch import Job, is_finished, make_terrains
from pyharness.terrain_files import generate_terrain
from pyharness.terrain_set import TerrainSet, make_set, set_jobs
from sim.errors import TerrainError
from sim.generate import TerrainRecipe
from sim.terrain_io import read_terrain

SMALL = TerrainRecipe(size_m=12.0)


def wanted(count, **changes):
    return TerrainSet(count=count, recipe=SMALL, **changes)


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture
def data_dir():
    folder = os.environ.get("ENAV_TEST_DATA")
    if not folder:
        pytest.skip("ENAV_TEST_DATA is not set")
    return Path(folder)


def nothing(*_):
    pass


def test_the_standard_set_is_the_published_grid():
    jobs = set_jobs(TerrainSet(), Path("x"))
    assert len(jobs) == len({job.path for job in jobs}) == 1200
    cells = {(job.recipe.slope_deg, job.recipe.cfa) for job in jobs}
    assert cells == {(s, c) for s in (0, 5, 10, 15, 20) for c in (0.07, 0.10, 0.12, 0.15)}
    assert {job.recipe.seed for job in jobs} == set(range(60))
    assert {job.recipe.start_m for job in jobs} == {(-40.0, 0.0)}
    assert jobs[6].path.name == "slope05-cfa12-seed0000.pgm"


@pytest.mark.slow
def test_two_processes_write_what_one_writes_and_go_on_where_they_stopped(tmp_path):
    make_set(wanted(23), tmp_path / "one", 1, nothing)
    counted = []
    make_set(wanted(9), tmp_path / "two", 1, lambda _, is_new: counted.append(is_new))
    make_set(wanted(23), tmp_path / "two", 2, lambda _, is_new: counted.append(is_new))
    assert counted == [True] * 9 + [False] * 9 + [True] * 14
    assert contents(tmp_path / "one") == contents(tmp_path / "two")


@pytest.mark.verify
def test_the_standard_set_takes_at_most_twenty_minutes_on_two_processors(tmp_path):
    begin_s = time.perf_counter()
    make_set(TerrainSet(count=40), tmp_path, 2, nothing)
    # two of every cell of the grid; writing counts, and so does starting the processes
    assert (time.perf_counter() - begin_s) / 40 * 1200 < 20 * 60


def test_every_terrain_of_a_set_can_be_made_again(tmp_path):
    jobs = make_set(wanted(4), tmp_path, 1, nothing)
    generate_terrain(tmp_path / "again.pgm", jobs[3].path.with_suffix(".yaml"), {})
    for suffix in (".pgm", ".yaml", ".rocks.csv"):
        again = (tmp_path / "again.pgm").with_suffix(suffix).read_bytes()
        assert again == jobs[3].path.with_suffix(suffix).read_bytes()


@pytest.mark.parametrize("suffix", [".pgm", ".yaml", ".rocks.csv"])
def test_what_is_missing_or_cut_off_is_made_again(tmp_path, suffix):
    job = make_set(wanted(3), tmp_path, 1, nothing)[1]
    before = contents(tmp_path)
    path = job.path.with_suffix(suffix)
    if suffix == ".pgm":
        path.write_bytes(path.read_bytes()[:100])
    else:
        path.unlink()
    assert not is_finished(job)
    make_set(wanted(3), tmp_path, 1, nothing)
    assert contents(tmp_path) == before


def test_another_set_in_the_folder_is_refused(tmp_path):
    make_set(wanted(3), tmp_path, 1, nothing)
    with pytest.raises(TerrainError, match="another set"):
        make_set(wanted(3, cfas=(0.1,)), tmp_path, 1, nothing)
    with pytest.raises(TerrainError, match="a set of 3, expected a count of at least"):
        make_set(wanted(2), tmp_path, 1, nothing)
    (tmp_path / "set.yaml").unlink()
    with pytest.raises(TerrainError, match="holds other terrains"):
        make_set(wanted(3), tmp_path, 1, nothing)
    job = Job(tmp_path / "slope00-cfa07-seed0000.pgm", SMALL)
    with pytest.raises(TerrainError, match="made from another recipe"):
        make_terrains([job], 1, nothing)


@pytest.mark.faults
def test_a_killed_process_is_one_clear_error(tmp_path, monkeypatch):
    # the parent hands each job to the pool by name: a job that kills its process
    monkeypatch.setattr("pyharness.terrain_batch.make_terrain_of", kill_this_process)
    jobs = [Job(tmp_path / f"{name}.pgm", SMALL) for name in "ab"]
    with pytest.raises(HarnessError, match="died"):
        make_terrains(jobs, 2, nothing)
    assert list(tmp_path.iterdir()) == []


def kill_this_process(_):
    os.kill(os.getpid(), signal.SIGKILL)


def test_an_unusable_recipe_in_a_process_is_its_own_error(tmp_path):
    bad = SMALL.model_copy(update={"base_file": str(tmp_path / "none.tif")})
    jobs = [Job(tmp_path / f"{name}.pgm", bad) for name in "ab"]
    with pytest.raises(TerrainError, match=r"none\.tif: no such file"):
        make_terrains(jobs, 2, nothing)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"cfas": (0.5,)}, "less than or equal to 0.4"),
        ({"cfas": (0.1, 0.1)}, "given twice"),
        ({"slopes_deg": ()}, "at least one value"),
        ({"count": 0}, "greater than or equal to 1"),
    ],
)
def test_bad_sets_are_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        TerrainSet(**changes)


def test_patches_of_gale_come_with_their_chart_and_their_places(tmp_path, data_dir):
    rasterio = pytest.importorskip("rasterio")
    from pyharness.terrain_orbital import make_orbital
    from sim.orbital import OrbitalConfig

    config = OrbitalConfig(dem=str(data_dir / "gale_hirise_1m.tif"), cfa=0.07, count=2)
    plan = make_orbital(config, tmp_path / "a", 1, nothing)
    names = {"highways.png", "highways.tif", "orbital.yaml", "patches.csv"}
    for patch in ("patch-0000", "patch-0001"):
        names |= {patch + suffix for suffix in (".pgm", ".yaml", ".rocks.csv")}
    assert set(contents(tmp_path / "a")) == names
    with rasterio.open(tmp_path / "a/highways.tif") as chart, rasterio.open(config.dem) as dem:
        assert chart.transform == dem.transform
        assert chart.crs == dem.crs
        share = chart.read(1)
        assert share.max() == pytest.approx(plan.highways.likelihood.max(), rel=1e-6)
        rows = (tmp_path / "a/patches.csv").read_text().splitlines()
        values = dict(zip(rows[0].split(","), rows[1].split(","), strict=True))
        line, sample = chart.index(float(values["map_x"]), float(values["map_y"]))
        assert share[line, sample] > 0
    # run again from what it wrote: nothing to make; elsewhere: the same bytes
    from sim.config import load_model

    again = load_model(tmp_path / "a/orbital.yaml", OrbitalConfig)
    counted = []
    make_orbital(again, tmp_path / "a", 1, lambda _, is_new: counted.append(is_new))
    assert counted == [False, False]
    make_orbital(again, tmp_path / "b", 1, nothing)
    assert contents(tmp_path / "a") == contents(tmp_path / "b")
    with pytest.raises(TerrainError, match="of another run"):
        make_orbital(again.model_copy(update={"seed": 9}), tmp_path / "a", 1, nothing)
    generate_terrain(tmp_path / "c.pgm", tmp_path / "a/patch-0001.yaml", {})
    assert (tmp_path / "c.pgm").read_bytes() == (tmp_path / "a/patch-0001.pgm").read_bytes()
    assert read_terrain(tmp_path / "a/patch-0000.pgm").z_site_m.shape == (1200, 1200)
