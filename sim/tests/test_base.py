# SPDX-License-Identifier: Apache-2.0
"""Patches of maps: where they lie, how large their pixels are, and rocks by a map."""

import math
from pathlib import Path

import numpy as np
import pytest

from sim.base import BaseFile, base_z_m, place_patch
from sim.errors import TerrainError
from sim.generate import TerrainRecipe, generate
from sim.raster import open_raster
from sim.rocks import area_fraction
from sim.terrain import centred
from sim.terrain_io import open_map, write_terrain
from sim.tests.map_files import RADIUS_M, eqc, write_map

rasterio = pytest.importorskip("rasterio")

# an incline of 0.1 to the east, as pixels of 1 m in the projection have it
EASTWARD = np.tile(0.1 * np.arange(200.0), (200, 1)).astype(np.float32)


def at_latitude(path: Path, latitude_deg: float, values: np.ndarray, step: float = 1.0) -> Path:
    north = RADIUS_M * math.radians(latitude_deg) + 0.5 * step * values.shape[0]
    transform = rasterio.Affine(step, 0, 7_000_000, 0, -step, north)
    return write_map(path, values, transform=transform)


def test_true_scale_makes_slopes_as_steep_as_they_are(tmp_path: Path) -> None:
    path = at_latitude(tmp_path / "m.tif", 18.44, EASTWARD)
    for true_scale, expected in ((False, 0.1), (True, 0.1 / math.cos(math.radians(18.44)))):
        recipe = TerrainRecipe(size_m=100, base_file=str(path), base_true_scale=true_scale)
        z = generate(recipe).z_site_m
        slope = (z[0, 0] - z[0, -1]) / (0.1 * (z.shape[1] - 1))
        assert slope == pytest.approx(expected, rel=1e-4)


def test_a_true_scale_patch_needs_more_pixels_across(tmp_path: Path) -> None:
    path = at_latitude(tmp_path / "m.tif", 60.0, EASTWARD)
    base = BaseFile(file=str(path), true_scale=True)
    axis = np.linspace(-60.0, 60.0, 101).astype(np.float64)
    with pytest.raises(TerrainError, match=r"not inside the base of 199 x 99\.5"):
        base_z_m(base, axis)
    assert base_z_m(base, 0.8 * axis)[0].shape == (101, 101)


def test_the_spline_runs_through_the_pixels_of_gale(data_dir: Path) -> None:
    source = open_map(data_dir / "gale_hirise_1m.tif")
    base = BaseFile(file=str(source.path), center_m=(37.0, -41.5), true_scale=True)
    axis = (np.arange(1200, dtype=np.float64) - 599.5) * 0.1
    z_m, datum_up_m = base_z_m(base, axis)
    terrain = centred(z_m.astype(np.float32), 0.1)
    patch = place_patch(source, base.center_m, True)
    rows, cols = np.arange(150, 258), np.arange(80, 184)
    north = patch.axis_m(0)[rows] - patch.middle_m[0]
    east = patch.axis_m(1)[cols] - patch.middle_m[1]
    inside_n, inside_e = np.abs(north) < 59, np.abs(east) < 59
    n, e = np.meshgrid(north[inside_n], east[inside_e], indexing="ij")
    found = datum_up_m - terrain.height_at(n, e)
    pixels = source.read(slice(150, 258), slice(80, 184))[np.ix_(inside_n, inside_e)]
    assert n.size > 9000
    assert np.abs(found - pixels).max() < 0.01


def test_holes_inside_and_patches_over_the_edge_are_refused(tmp_path: Path) -> None:
    holed = EASTWARD.copy()
    holed[100, 100] = -9999
    path = write_map(tmp_path / "m.tif", holed, nodata=-9999)
    with pytest.raises(TerrainError, match="no-data nodes inside"):
        generate(TerrainRecipe(size_m=30, base_file=str(path)))
    with pytest.raises(TerrainError, match="not inside the base"):
        generate(TerrainRecipe(size_m=250, base_file=str(path)))
    # the spline's margin would reach the hole, the patch does not
    assert generate(TerrainRecipe(size_m=30, base_file=str(path), base_center_m=(17, 0)))


def test_rocks_follow_a_map_of_cfa(tmp_path: Path) -> None:
    dem = at_latitude(tmp_path / "m.tif", 0.0, 0 * EASTWARD)
    halves = np.full((20, 20), 0.05, np.float32)
    halves[:, 10:] = 0.15
    cfa = at_latitude(tmp_path / "c.tif", 0.0, halves, step=10.0)
    recipe = TerrainRecipe(base_file=str(dem), cfa_file=str(cfa), seed=3, size_m=180)
    rocks = generate(recipe).rocks
    # away from the seam, where the map is interpolated
    for k, side in ((0.05, rocks["east_m"] < -5), (0.15, rocks["east_m"] > 5)):
        found = float((0.25 * np.pi * rocks["diameter_m"][side] ** 2).sum()) / (85 * 180)
        assert found == pytest.approx(float(area_fraction(k, 0.1)), rel=0.08)


def test_a_constant_map_gives_the_rocks_of_its_value(tmp_path: Path) -> None:
    dem = write_map(tmp_path / "m.tif", EASTWARD)
    cfa = write_map(tmp_path / "c.tif", 0 * EASTWARD + np.float32(0.125))
    one = generate(TerrainRecipe(size_m=40, base_file=str(dem), cfa=0.125))
    two = generate(TerrainRecipe(size_m=40, base_file=str(dem), cfa_file=str(cfa)))
    assert one.rocks.tobytes() == two.rocks.tobytes()
    assert one.z_site_m.tobytes() == two.z_site_m.tobytes()
    none = write_map(tmp_path / "n.tif", 0 * EASTWARD)
    recipe = TerrainRecipe(size_m=40, base_file=str(dem), cfa_file=str(none))
    assert len(generate(recipe).rocks) == 0


def test_a_map_of_cfa_without_a_place_lies_on_the_middle(tmp_path: Path) -> None:
    cfa = np.full((40, 40), 0.05, np.float32)
    cfa[:, 20:] = 0.0
    write_terrain(centred(-cfa, 1.0), tmp_path / "c.pgm")
    rocks = generate(TerrainRecipe(size_m=30, cfa_file=str(tmp_path / "c.pgm"))).rocks
    assert len(rocks) > 100
    assert rocks["east_m"].max() < 0.6


@pytest.mark.parametrize(
    ("value", "changes", "expected"),
    [
        (0.41, {}, "CFA 0.41, expected fractions of 0 to 0.4"),
        (-0.01, {}, "CFA -0.01"),
        (7.0, {}, "CFA 7"),
        (-9999, {"nodata": -9999}, "no-data inside"),
        (0.1, {"crs": eqc(40.0)}, "another projection"),
        (0.1, {"transform": rasterio.Affine(1, 0, 700, 0, -1, 900)}, "does not cover"),
        (0.1, {"crs": "EPSG:4326"}, "coordinates in degrees"),
    ],
)
def test_a_bad_map_of_cfa_is_one_clear_line(
    tmp_path: Path, value: float, changes: dict[str, object], expected: str
) -> None:
    dem = write_map(tmp_path / "m.tif", EASTWARD)
    cfa = write_map(tmp_path / "c.tif", 0 * EASTWARD + np.float32(value), **changes)
    with pytest.raises(TerrainError, match=expected) as caught:
        generate(TerrainRecipe(size_m=20, base_file=str(dem), cfa_file=str(cfa)))
    assert len(str(caught.value).splitlines()) == 1


def test_a_large_map_is_read_by_windows(tmp_path: Path) -> None:
    # 90 million pixels, most never written: more than is ever read at once
    path = tmp_path / "big.tif"
    profile = {
        "driver": "GTiff", "dtype": "float32", "count": 1, "height": 30_000, "width": 3_000,
        "crs": eqc(), "transform": rasterio.Affine(1, 0, 500, 0, -1, 900), "tiled": True,
        "sparse_ok": True,
    }  # fmt: skip
    with rasterio.open(path, "w", **profile) as dataset:
        window = rasterio.windows.Window(1400, 14_900, 200, 200)
        dataset.write(EASTWARD, 1, window=window)
    assert open_raster(path).shape == (30_000, 3_000)
    assert np.ptp(generate(TerrainRecipe(size_m=60, base_file=str(path))).z_site_m) > 5
