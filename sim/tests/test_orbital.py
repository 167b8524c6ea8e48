# SPDX-License-Identifier: Apache-2.0
"""Highways and patches of orbital maps."""

import math
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from sim.errors import TerrainError
from sim.generate import generate, generate_layers
from sim.orbital import Ellipse, OrbitalConfig, Region, plan_orbital, read_ground
from sim.terrain import centred
from sim.terrain_io import open_map, write_terrain
from sim.tests.map_files import write_map

rasterio = pytest.importorskip("rasterio")

N, E = np.meshgrid(np.arange(90.0)[::-1], np.arange(80.0), indexing="ij")
# a ridge along north with a gap in the north
RIDGE = (12 * np.exp(-(((E - 40) / 4) ** 2)) * (1 / (1 + np.exp((N - 70) / 2)))).astype(np.float32)
SMALL = {"size_m": 20.0, "start_m": None, "resolution_m": 0.5}


def config_of(path: Path, **changes: object) -> OrbitalConfig:
    return OrbitalConfig.model_validate({"dem": str(path), **SMALL, **changes})


def test_routes_take_the_gap_and_patches_lie_on_them(tmp_path: Path) -> None:
    path = write_map(tmp_path / "m.tif", RIDGE)
    plan = plan_orbital(
        config_of(
            path,
            landing_points_m=((-30.0, -30.0), (-20.0, -25.0)),
            regions=(Region(center_m=(-30.0, 30.0), radius_m=5.0),),
            count=30,
        )
    )
    assert len(plan.highways.routes) == 2
    crossing = [int(route[np.argmax(route % 80 >= 40)] // 80) for route in plan.highways.routes]
    assert min(crossing) > 65
    assert (plan.highways.driven_m[tuple(plan.cells.T)] > 0).all()
    # a patch has ground everywhere
    assert (plan.cells >= 10).all()
    assert (plan.cells <= np.array([79, 69])).all()
    first = generate(plan.recipes[0])
    assert np.isfinite(first.z_site_m).all()
    assert len({tuple(cell) for cell in plan.cells.tolist()}) == 30


def test_where_a_patch_came_from_is_where_its_heights_are(tmp_path: Path) -> None:
    path = write_map(tmp_path / "m.tif", RIDGE)
    plan = plan_orbital(config_of(path, count=3, true_scale=True))
    with rasterio.open(path) as dataset:
        for recipe, origin in zip(plan.recipes, plan.origins, strict=True):
            line, sample = dataset.index(origin["map_x"], origin["map_y"])
            assert (origin["pixel_line"], origin["pixel_sample"]) == (line, sample)
            layers = generate_layers(recipe)
            assert layers.datum_up_m is not None
            middle_up_m = layers.datum_up_m - layers.terrain.height_at(0.0, 0.0)
            assert middle_up_m == pytest.approx(RIDGE[line, sample], abs=0.02)


def test_the_same_seed_draws_the_same_and_more_begin_like_fewer(tmp_path: Path) -> None:
    path = write_map(tmp_path / "m.tif", RIDGE)
    few, many = (plan_orbital(config_of(path, count=count, seed=4)) for count in (3, 8))
    assert many.recipes[:3] == few.recipes
    assert plan_orbital(few.config).recipes == few.recipes
    assert plan_orbital(config_of(path, count=3, seed=5)).recipes != few.recipes


def test_landings_are_drawn_from_an_ellipse_on_level_ground(tmp_path: Path) -> None:
    path = write_map(tmp_path / "m.tif", RIDGE)
    ellipse = Ellipse(center_m=(-20.0, -25.0), sigma_m=(6.0, 2.0), azimuth_deg=0.0)
    plan = plan_orbital(config_of(path, landing_ellipse=ellipse, landing_count=200))
    points = np.array(plan.config.landing_points_m)
    assert points.mean(axis=0) == pytest.approx([-20.0, -25.0], abs=1.5)
    assert points[:, 0].std() > 1.3 * points[:, 1].std()


def test_rocky_ground_is_driven_around_and_sprinkled_by_the_map(tmp_path: Path) -> None:
    dem = write_map(tmp_path / "m.tif", 0 * RIDGE)
    cfa = np.full((45, 40), 0.02, np.float32)
    cfa[10:, 18:22] = 0.35
    transform = rasterio.Affine(2, 0, 500, 0, -2, 900)
    path = write_map(tmp_path / "c.tif", cfa, transform=transform)
    plan = plan_orbital(
        config_of(
            dem,
            cfa_file=str(path),
            landing_points_m=((-30.0, -30.0),),
            regions=(Region(center_m=(-30.0, 30.0)),),
            count=20,
        )
    )
    (route,) = plan.highways.routes
    assert route.max() // 80 >= 69
    means = [origin["cfa_mean"] for origin in plan.origins]
    rocks = [len(generate(recipe).rocks) for recipe in plan.recipes]
    assert max(means) > 2 * min(means)
    assert np.corrcoef(means, rocks)[0, 1] > 0.95


def test_a_pgm_is_a_map_without_a_place(tmp_path: Path) -> None:
    write_terrain(centred(-RIDGE[::-1], 1.0), tmp_path / "m.pgm")
    plan = plan_orbital(config_of(tmp_path / "m.pgm", count=2))
    assert "map_x" not in plan.origins[0]
    assert plan.ground.place is not None
    assert plan.ground.place.crs_wkt == ""


def test_large_maps_are_averaged_in_blocks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_map(tmp_path / "m.tif", RIDGE)
    fine = read_ground(config_of(path))
    monkeypatch.setattr("sim.orbital.CELLS_MAX", 1000)
    monkeypatch.setattr("sim.orbital.STRIP_NODES", 1000)
    coarse = read_ground(config_of(path))
    assert (fine.block, coarse.block) == (1, 3)
    expected = fine.slope_rad[:90, :78].reshape(30, 3, 26, 3).mean(axis=(1, 3))
    np.testing.assert_allclose(coarse.slope_rad, expected)
    row, col = coarse.cell_at((3.0, -7.0))
    assert abs(float(coarse.offset_m(row, 0)) - 3.0) <= 1.5
    assert abs(float(coarse.offset_m(col, 1)) + 7.0) <= 1.5
    plan = plan_orbital(config_of(path, count=4))
    assert np.isfinite(generate(plan.recipes[3]).z_site_m).all()


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"size_m": 120.0}, "patch of 120 m is larger than the map of 89 x 79 m"),
        ({"band": 2}, "no band 2, expected 1 to 1"),
        ({"landing_points_m": ((500.0, 0.0),)}, "500, 0 m from its middle is not on the map"),
        ({"regions": ({"center_m": (0.0, -99.0)},)}, "0, -99 m from its middle is not on the map"),
        ({"size_m": 78.0}, "no place on a route where a patch of 78 m has ground"),
        ({"cost": {"slope_double_deg": 1e-3, "slope_max_deg": 1e-3}}, "no ground that can be|now"),
        ({"dem": "none.tif"}, "none.tif: no such file"),
        ({"cfa_file": "none.tif"}, "none.tif: no such file"),
    ],
)
def test_bad_input_is_one_clear_line(
    tmp_path: Path, change: dict[str, object], expected: str
) -> None:
    up_m = RIDGE + np.float32(0.05) * np.float32(np.sin(E))
    path = write_map(tmp_path / "m.tif", up_m)
    with pytest.raises(TerrainError, match=expected) as caught:
        plan_orbital(config_of(path, **change))
    assert len(str(caught.value).splitlines()) == 1


def test_no_data_everywhere_is_refused_and_holes_are_avoided(tmp_path: Path) -> None:
    holed = RIDGE.copy()
    holed[60:, 20:60] = -9999
    path = write_map(tmp_path / "m.tif", holed, nodata=-9999)
    plan = plan_orbital(config_of(path, count=40))
    for recipe in plan.recipes:
        assert np.isfinite(generate(recipe).z_site_m).all()
    empty = write_map(tmp_path / "e.tif", 0 * RIDGE - 9999, nodata=-9999)
    with pytest.raises(TerrainError, match="every pixel is no-data"):
        plan_orbital(config_of(empty))


@pytest.mark.parametrize(
    "bad",
    [
        {"cfa": 0.41},
        {"cfa": -0.1},
        {"cfa": 0.1, "cfa_file": "c.tif"},
        {"landing_points_m": ((0, 0),), "landing_ellipse": {"sigma_m": (1, 1)}},
        {"start_m": (70, 0), "size_m": 120},
        {"rock_diameter_min_m": 2.0},
        {"count": 0},
        {"landing_ellipse": {"sigma_m": (0, 1)}},
    ],
)
def test_contradictions_are_refused(bad: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        OrbitalConfig.model_validate({"dem": "m.tif", **bad})


def test_the_patches_of_gale_keep_the_map_to_a_centimetre(data_dir: Path) -> None:
    """Every pixel of the map inside a patch, looked up in the patch without its rocks."""
    dem = str(data_dir / "gale_hirise_1m.tif")
    plan = plan_orbital(OrbitalConfig(dem=dem, cfa=0.07, count=5, seed=1))
    source = open_map(dem)
    pixels = source.read(slice(0, source.shape[0]), slice(0, source.shape[1]))
    worst_m = 0.0
    for recipe, origin in zip(plan.recipes, plan.origins, strict=True):
        layers = generate_layers(recipe)
        ground = centred(layers.ground.astype(np.float32), 0.1)
        row, col = source.shape[0] - 1 - origin["pixel_line"], origin["pixel_sample"]
        i, j = np.meshgrid(np.arange(source.shape[0]), np.arange(source.shape[1]), indexing="ij")
        north = (i - row) * origin["pixel_north_m"]
        east = (j - col) * origin["pixel_east_m"]
        inside = (np.abs(north) <= 59.9) & (np.abs(east) <= 59.9)
        assert layers.datum_up_m is not None
        found = layers.datum_up_m - ground.height_at(north[inside], east[inside])
        assert inside.sum() > 14_000
        worst_m = max(worst_m, float(np.abs(found - pixels[inside]).max()))
    assert worst_m < 0.01


def test_routes_over_gale_merge_into_a_few_highways(data_dir: Path) -> None:
    plan = plan_orbital(OrbitalConfig(dem=str(data_dir / "gale_hirise_1m.tif"), cfa=0.07, count=1))
    assert len(plan.highways.routes) == 512
    driven = np.sort(plan.highways.driven_m.reshape(-1))[::-1]
    share = np.cumsum(driven) / driven.sum()
    # half of all driving happens on less than 1 % of the map
    assert share[math.ceil(0.01 * driven.size)] > 0.5
    slope_deg = np.degrees(plan.ground.slope_rad)
    on_routes = np.average(slope_deg, weights=plan.highways.driven_m)
    assert on_routes < 0.75 * slope_deg.mean()
