# SPDX-License-Identifier: Apache-2.0
"""Maps through GDAL: formats, windows, and the size of a pixel on the ground."""

import math
from pathlib import Path

import numpy as np
import pytest

from sim.errors import TerrainError
from sim.generate import TerrainRecipe, generate
from sim.raster import MapPlace, geotiff, open_raster
from sim.terrain import centred
from sim.terrain_io import open_map, read_terrain, write_terrain
from sim.tests.map_files import MISSING, RADIUS_M, eqc, write_map, write_pds3

pytest.importorskip("rasterio")

N, E = np.meshgrid(np.arange(60.0)[::-1], np.arange(50.0), indexing="ij")
GROUND = (0.05 * N + 0.4 * np.sin(E / 7) + 0.3 * np.cos(N / 5)).astype(np.float32)


def all_of(path: Path) -> np.ndarray:
    source = open_map(path)
    return source.read(slice(0, source.shape[0]), slice(0, source.shape[1]))


@pytest.mark.parametrize("name", ["m.tif", "m.xml", "m.cub"])
def test_formats_that_hold_floats_agree(tmp_path: Path, name: str) -> None:
    path = write_map(tmp_path / name, GROUND)
    np.testing.assert_array_equal(all_of(path)[::-1], GROUND)
    assert open_map(path).cell_m == 1.0


@pytest.mark.parametrize("detached", [False, True])
def test_a_pds3_image_is_read_with_its_label(tmp_path: Path, detached: bool) -> None:
    holed = GROUND.copy()
    holed[3, 4] = MISSING
    name = "m.lbl" if detached else "m.IMG"
    path = write_pds3(tmp_path / name, holed, 500, 900, detached)
    found = all_of(path)[::-1]
    assert np.isnan(found[3, 4])
    found[3, 4] = GROUND[3, 4]
    np.testing.assert_array_equal(found, GROUND)
    assert open_map(path).place is not None


def test_a_jpeg_2000_is_read_to_its_last_bit(tmp_path: Path) -> None:
    counts = np.uint16(np.rint((GROUND + 1) / 1e-3))
    path = write_map(tmp_path / "m.jp2", counts, QUALITY=100, REVERSIBLE="YES")
    np.testing.assert_array_equal(all_of(path)[::-1], counts)


def test_geotiff_pds3_and_pgm_of_the_same_ground_give_the_same_terrain(tmp_path: Path) -> None:
    tif = write_map(tmp_path / "m.tif", GROUND)
    img = write_pds3(tmp_path / "p.IMG", GROUND, 500, 900)
    pgm = tmp_path / "g.pgm"
    write_terrain(centred(-GROUND[::-1], 1.0), pgm)
    made = [
        generate(TerrainRecipe(size_m=30, base_file=str(path), base_center_m=(4, -3), cfa=0.05))
        for path in (tif, img, pgm)
    ]
    assert made[0].z_site_m.tobytes() == made[1].z_site_m.tobytes()
    step_m = float(np.ptp(GROUND)) / 65535
    np.testing.assert_allclose(made[0].z_site_m, made[2].z_site_m, atol=2 * step_m)
    assert made[0].rocks.tobytes() == made[2].rocks.tobytes()
    for path in (img, pgm):
        np.testing.assert_allclose(
            read_terrain(path).z_site_m, read_terrain(tif).z_site_m, atol=2 * step_m
        )


def test_windows_are_read_alike_whichever_way_rows_and_columns_run(tmp_path: Path) -> None:
    import rasterio

    for across, down in ((1, -1), (1, 1), (-1, -1), (-1, 1)):
        west, north = (500 if across > 0 else 550), (900 if down < 0 else 840)
        values = GROUND[:: -1 if down > 0 else 1, :: -1 if across < 0 else 1]
        transform = rasterio.Affine(across, 0, west, 0, down, north)
        path = write_map(tmp_path / f"m{across}{down}.tif", values, transform=transform)
        source = open_raster(path)
        window = source.read(slice(10, 14), slice(3, 9))
        np.testing.assert_array_equal(window, GROUND[::-1][10:14, 3:9])
        assert source.place is not None
        assert source.place.xy(0, 0) == (500.5, 840.5)


def test_a_pixel_is_as_wide_as_its_latitude_makes_it(tmp_path: Path) -> None:
    import rasterio

    for latitude_deg in (0.0, -4.7, 18.44, 60.0):
        north = RADIUS_M * math.radians(latitude_deg) + 30
        transform = rasterio.Affine(1, 0, 8_142_406, 0, -1, north)
        source = open_raster(write_map(tmp_path / "m.tif", GROUND, transform=transform))
        north_m, east_m = source.cell_true_m(29.5, 24.5)
        assert north_m == pytest.approx(1.0, rel=1e-7)
        assert east_m == pytest.approx(math.cos(math.radians(latitude_deg)), rel=1e-6)
    true_here = write_map(tmp_path / "t.tif", GROUND, transform=transform, crs=eqc(60.0))
    assert open_raster(true_here).cell_true_m(29.5, 24.5)[1] == pytest.approx(1.0, rel=1e-6)


def test_the_place_of_gale(data_dir: Path) -> None:
    source = open_raster(data_dir / "gale_hirise_1m.tif")
    assert source.place is not None
    longitude, latitude = source.place.lonlat_deg(168, 173.5)
    assert (longitude, latitude) == pytest.approx((137.3703, -4.6668), abs=2e-4)
    assert source.cell_true_m(168, 173.5) == pytest.approx((1.0, 0.99669), abs=1e-5)


@pytest.mark.parametrize(
    ("bands", "band", "expected"),
    [(3, None, "3 bands, expected one"), (3, 4, "no band 4, expected 1 to 3"), (1, 2, "no band 2")],
)
def test_a_wrong_band_is_one_clear_line(
    tmp_path: Path, bands: int, band: int | None, expected: str
) -> None:
    path = write_map(tmp_path / "m.tif", np.stack([GROUND] * bands))
    with pytest.raises(TerrainError, match=expected):
        open_raster(path, band)


def test_the_wanted_band_is_read(tmp_path: Path) -> None:
    path = write_map(tmp_path / "m.tif", np.stack([0 * GROUND, GROUND]))
    recipe = TerrainRecipe(size_m=20, base_file=str(path), base_band=2)
    assert np.ptp(generate(recipe).z_site_m) > 0.5


def test_a_written_geotiff_comes_back(tmp_path: Path) -> None:
    place = MapPlace(eqc(), 100.5, 40.5, 2.0)
    values = np.arange(24, dtype=np.float32).reshape(2, 3, 4)
    values[0, 1, 1] = np.nan
    (tmp_path / "c.tif").write_bytes(geotiff(values, place, ["a", "b"]))
    source = open_raster(tmp_path / "c.tif", 1)
    np.testing.assert_array_equal(source.read(slice(0, 3), slice(0, 4)), values[0])
    assert source.place is not None
    assert source.place.xy(0, 0) == (100.5, 40.5)
