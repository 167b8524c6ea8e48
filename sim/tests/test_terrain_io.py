# SPDX-License-Identifier: Apache-2.0
"""Terrain files: round trips, foreign files, and every kind of bad one in one clear line."""

import builtins
import json
import sys
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

from sim.errors import TerrainError
from sim.generate import TerrainRecipe, generate, recipe_of
from sim.terrain import centred
from sim.terrain_io import read_terrain, rocks_path, write_terrain

SIDE_CAR = {"z_offset_m": 1.0, "z_scale_m_per_count": 0.01, "cell_m": 0.5, "rows": 2, "cols": 3}
HEADER = b"P5\n3 2\n65535\n"
PIXELS = np.array([[10, 20, 30], [40, 50, 65535]], ">u2").tobytes()


def write_pgm(folder: Path, content: bytes, side_car: dict[str, Any] | None = None) -> Path:
    path = folder / "t.pgm"
    path.write_bytes(content)
    path.with_suffix(".json").write_text(json.dumps(side_car or SIDE_CAR))
    return path


def fault(path: Path) -> str:
    with pytest.raises(TerrainError) as caught:
        read_terrain(path)
    text = str(caught.value)
    assert "\n" not in text
    assert path.stem in text
    return text


def test_row_0_is_north_and_up_becomes_down(tmp_path: Path) -> None:
    terrain = read_terrain(write_pgm(tmp_path, HEADER + PIXELS))
    assert terrain.z_site_m.shape == (2, 3)
    np.testing.assert_allclose(terrain.z_site_m[1], [-1.1, -1.2, -1.3], rtol=1e-6)
    assert terrain.z_site_m[0, 2] == pytest.approx(-(1.0 + 655.35))
    assert terrain.north_min_m == -0.25
    assert len(terrain.rocks) == 0


def test_a_written_terrain_reads_back(tmp_path: Path) -> None:
    recipe = TerrainRecipe(size_m=12, cfa=0.1, slope_deg=5, seed=3)
    terrain = generate(recipe)
    path = tmp_path / "t.pgm"
    write_terrain(terrain, path)
    back = read_terrain(path)
    step = float(np.ptp(terrain.z_site_m)) / 65535
    np.testing.assert_allclose(back.z_site_m, terrain.z_site_m, atol=step)
    assert back.resolution_m == terrain.resolution_m
    assert back.north_min_m == terrain.north_min_m
    for name in ("north_m", "east_m", "diameter_m", "height_m"):
        np.testing.assert_allclose(back.rocks[name], terrain.rocks[name], atol=1e-4)
    stored = recipe_of(back)
    assert stored == recipe
    again = generate(stored)
    np.testing.assert_array_equal(again.z_site_m, terrain.z_site_m)


def test_the_same_terrain_gives_the_same_bytes(tmp_path: Path) -> None:
    for name in ("a", "b"):
        write_terrain(generate(TerrainRecipe(size_m=8, cfa=0.1, seed=3)), tmp_path / f"{name}.pgm")
    for suffix in (".pgm", ".yaml", ".rocks.csv"):
        assert (tmp_path / f"a{suffix}").read_bytes() == (tmp_path / f"b{suffix}").read_bytes()


def test_a_level_terrain_can_be_stored(tmp_path: Path) -> None:
    write_terrain(centred(np.full((4, 4), 2.5, np.float32), 1.0), tmp_path / "t.pgm")
    np.testing.assert_array_equal(read_terrain(tmp_path / "t.pgm").z_site_m, 2.5)


@pytest.mark.parametrize(
    "head",
    [
        b"P5 3 2 65535\n",
        b"P5\n# scale 0.01\n3 2\n65535\n",
        b"P5\n3 # width\n2\n# height\n65535\n",
        b"P5#x\n3\t2\r\n65535 ",
    ],
)
def test_every_legal_header_is_read(tmp_path: Path, head: bytes) -> None:
    assert read_terrain(write_pgm(tmp_path, head + PIXELS)).z_site_m.shape == (2, 3)


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"", "expected a binary PGM"),
        (b"P2\n3 2\n65535\n1 2 3 4 5 6", "expected a binary PGM"),
        (b"P6" + HEADER[2:] + PIXELS, "expected a binary PGM"),
        (b"p5" + HEADER[2:] + PIXELS, "expected a binary PGM"),
        (b"\xef\xbb\xbf" + HEADER + PIXELS, "expected a binary PGM"),
        (b"P53 2 65535\n" + PIXELS, "expected a binary PGM"),
        (b"P5\n# no end", "header ends before the width"),
        (b"P5\n3 2\n", "header ends before the maxval"),
        (b"P5\n3 2\n65535", "white space"),
        (b"P5\n0 2\n65535\n", "width is '0'"),
        (b"P5\n-3 2\n65535\n" + PIXELS, "width is '-3'"),
        (b"P5\n03 2\n65535\n" + PIXELS, "width is '03'"),
        (b"P5\n3 +2\n65535\n" + PIXELS, "height is '+2'"),
        (b"P5\n3 1e2\n65535\n" + PIXELS, "height is '1e2'"),
        (b"P5\n1000000000 1000000000\n65535\n", "width is"),
        (b"P5\n65536 2\n65535\n", "65536 x 2 pixels"),
        (b"P5\n65535 65535\n65535\n", "at most"),
        (b"P5\n1 6\n65535\n" + PIXELS, "1 x 6 pixels"),
        (b"P5\n3 2\n255\n" + PIXELS, "maxval is 255"),
        (b"P5\n3 2\n65536\n" + PIXELS, "maxval is 65536"),
        (HEADER + PIXELS[:-1], "too short: 11 bytes"),
        (HEADER + PIXELS + b"x", "too long: 13 bytes"),
        (HEADER, "too short: 0 bytes"),
        (HEADER + PIXELS + HEADER + PIXELS, "too long"),
        (b"P5\n2 3\n65535\n" + PIXELS, "its side-car says 2 x 3"),
        (b"P5\n#" + b"x" * 5000 + b"\n3 2\n65535\n" + PIXELS, "header ends"),
    ],
)
def test_bad_images_give_one_clear_line(tmp_path: Path, content: bytes, expected: str) -> None:
    assert expected in fault(write_pgm(tmp_path, content))


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"z_scale_m_per_count": 0}, "z_scale_m_per_count: expected > 0.0, got 0"),
        ({"z_scale_m_per_count": -1}, "expected > 0.0"),
        ({"z_scale_m_per_count": 1e30}, "expected <= 100.0"),
        ({"z_scale_m_per_count": "0.1"}, "expected a number, got '0.1'"),
        ({"z_scale_m_per_count": 90.0}, "heights beyond"),
        ({"z_scale_m_per_count": float("nan")}, "expected a number"),
        ({"cell_m": 0}, "cell_m: expected > 0.0"),
        ({"rows": 2.5}, "rows: expected an integer"),
        ({"row0": "south"}, "row0: expected one of north"),
        ({"cel_m": 1}, "unknown key, did you mean 'cell_m'?"),
    ],
)
def test_bad_side_cars_give_one_clear_line(
    tmp_path: Path, change: dict[str, Any], expected: str
) -> None:
    assert expected in fault(write_pgm(tmp_path, HEADER + PIXELS, {**SIDE_CAR, **change}))


def test_missing_things_are_named(tmp_path: Path) -> None:
    path = tmp_path / "t.pgm"
    assert "no such file" in fault(path)
    path.mkdir()
    assert "not a file" in fault(path)
    path.rmdir()
    path.write_bytes(HEADER + PIXELS)
    assert "no side-car t.yaml" in fault(path)
    path.with_suffix(".json").write_bytes(b"\xff\xfe")
    assert "cannot be read" in fault(path)
    path.with_suffix(".json").write_text("{}")
    assert "z_offset_m: missing key" in fault(path)


def test_tabs_in_a_json_side_car_are_fine(tmp_path: Path) -> None:
    path = write_pgm(tmp_path, HEADER + PIXELS)
    path.with_suffix(".json").write_text(json.dumps(SIDE_CAR, indent="\t"))
    assert read_terrain(path).resolution_m == 0.5


@pytest.mark.parametrize(
    "text",
    [
        "",
        "n,e,d,h\n1,2,3,4\n",
        "north_m,east_m,diameter_m,height_m\n1,2,3\n",
        "north_m,east_m,diameter_m,height_m\n1,2,0,1\n",
        "north_m,east_m,diameter_m,height_m\n1,2,nan,1\n",
        "north_m,east_m,diameter_m,height_m\n1,2,x,1\n",
        "north_m,east_m,diameter_m,height_m\n1,2,1,-1\n",
    ],
)
def test_bad_rock_lists_name_the_line(tmp_path: Path, text: str) -> None:
    path = write_pgm(tmp_path, HEADER + PIXELS)
    rocks_path(path).write_text(text)
    line = fault(path)
    assert "t.rocks.csv:" in line
    assert "north_m,east_m,diameter_m,height_m" in line


def test_writing_refuses_holes_names_and_places(tmp_path: Path) -> None:
    level = centred(np.zeros((4, 4), np.float32), 1.0)
    with pytest.raises(TerrainError, match="without ground"):
        write_terrain(centred(np.full((4, 4), np.nan, np.float32), 1.0), tmp_path / "t.pgm")
    with pytest.raises(TerrainError, match="expected a name ending"):
        write_terrain(level, tmp_path / "t.png")
    with pytest.raises(TerrainError, match="cannot be written"):
        write_terrain(level, tmp_path / "no" / "t.pgm")


def test_a_failed_write_leaves_nothing_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    full = OSError(28, "No space left on device")
    monkeypatch.setattr(Path, "replace", Mock(side_effect=full))
    with pytest.raises(TerrainError, match="No space left"):
        write_terrain(centred(np.zeros((4, 4), np.float32), 1.0), tmp_path / "t.pgm")
    assert list(tmp_path.iterdir()) == []


def test_without_rasterio_the_extra_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real_import = builtins.__import__

    def no_rasterio(name: str, *args: Any, **kwargs: Any) -> Any:
        if name.startswith("rasterio"):
            raise ImportError(name)
        return real_import(name, *args, **kwargs)

    for name in [name for name in sys.modules if name.startswith("rasterio")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(builtins, "__import__", no_rasterio)
    (tmp_path / "t.tif").write_bytes(b"II*\0")
    assert "enav-sim[orbital]" in fault(tmp_path / "t.tif")


def write_tiff(path: Path, heights: Any, **profile: Any) -> Path:
    rasterio = pytest.importorskip("rasterio")
    heights = np.atleast_3d(np.asarray(heights, np.float32)).transpose(2, 0, 1)
    crs = "+proj=eqc +R=3396190 +units=m +no_defs"
    settings = {
        "driver": "GTiff",
        "dtype": "float32",
        "count": heights.shape[0],
        "height": heights.shape[1],
        "width": heights.shape[2],
        "crs": crs,
        "transform": rasterio.Affine(1, 0, 500, 0, -1, 900),
        **profile,
    }
    with rasterio.open(path, "w", **settings) as dataset:
        dataset.write(heights)
    return path


def test_a_geotiff_is_read_north_up_with_holes(tmp_path: Path) -> None:
    path = write_tiff(tmp_path / "t.tif", [[1, 2], [3, -9999]], nodata=-9999)
    terrain = read_terrain(path)
    np.testing.assert_array_equal(terrain.z_site_m, [[-3, np.nan], [-1, -2]])
    assert terrain.resolution_m == 1.0


def test_a_south_up_geotiff_is_turned(tmp_path: Path) -> None:
    rasterio = pytest.importorskip("rasterio")
    path = write_tiff(
        tmp_path / "t.tif", [[1, 2], [3, 4]], transform=rasterio.Affine(2, 0, 0, 0, 2, 0)
    )
    np.testing.assert_array_equal(read_terrain(path).z_site_m, [[-1, -2], [-3, -4]])


@pytest.mark.parametrize(
    ("heights", "changes", "expected"),
    [
        ([[1, 2], [3, 4]], {"crs": "EPSG:4326"}, "coordinates in degrees"),
        ([[1, 2], [3, 4]], {"transform": (1, 0, 0, 0, -2, 0)}, "expected square ones"),
        ([[1, 2], [3, 4]], {"transform": (1, 1, 0, -1, 1, 0)}, "rotated"),
        ([[1, 2], [3, 4]], {"crs": None, "transform": (1, 0, 0, 0, 1, 0)}, "no georeference"),
        ([[-9999, -9999]] * 2, {"nodata": -9999}, "every pixel is no-data"),
        ([[-3.4e38, -3.4e38]] * 2, {}, "every pixel is no-data"),
        ([[1, 2]], {}, "2 x 1 pixels"),
        (np.ones((2, 2, 3)), {}, "3 bands"),
    ],
)
@pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
def test_bad_rasters_give_one_clear_line(
    tmp_path: Path, heights: Any, changes: dict[str, Any], expected: str
) -> None:
    rasterio = pytest.importorskip("rasterio")
    if "transform" in changes:
        changes = {**changes, "transform": rasterio.Affine(*changes["transform"])}
    assert expected in fault(write_tiff(tmp_path / "t.tif", heights, **changes))


def test_not_a_raster_gives_one_clear_line(tmp_path: Path) -> None:
    pytest.importorskip("rasterio")
    for content in (b"", b"hello", b"II*\0" + b"\0" * 40):
        (tmp_path / "t.tif").write_bytes(content)
        assert "not a raster" in fault(tmp_path / "t.tif")


def test_the_two_forms_of_gale_agree(data_dir: Path) -> None:
    pytest.importorskip("rasterio")
    pgm = read_terrain(data_dir / "gale_hirise_1m.pgm")
    tif = read_terrain(data_dir / "gale_hirise_1m.tif")
    assert pgm.z_site_m.shape == (337, 348)
    np.testing.assert_allclose(pgm.z_site_m, tif.z_site_m, atol=1e-3)
    assert -tif.z_site_m.max() == pytest.approx(-4472.670, abs=1e-3)


def test_the_marias_pass_pgm_is_read(data_dir: Path) -> None:
    terrain = read_terrain(data_dir / "marias_pass_025m.pgm")
    assert terrain.north_max_m == pytest.approx(60.0)


def test_one_spike_and_a_place_on_a_planet_survive_storing(tmp_path: Path) -> None:
    z = np.zeros((20, 30), np.float32)
    z[4, 5] = -900.0
    write_terrain(centred(z, 1.0), tmp_path / "t.pgm", {"map_x": 1.5, "dem": "m.tif"})
    found = read_terrain(tmp_path / "t.pgm").z_site_m
    np.testing.assert_allclose(found, z, atol=900 / 65535)
    assert "origin: {map_x: 1.5, dem: m.tif}" in (tmp_path / "t.yaml").read_text()


@pytest.mark.parametrize("hole", [np.nan, -3.4e38, -9999.0])
def test_all_kinds_of_no_data_are_holes(tmp_path: Path, hole: float) -> None:
    nodata = {"nodata": hole} if hole == -9999.0 else {}
    terrain = read_terrain(write_tiff(tmp_path / "t.tif", [[1, 2], [3, hole]], **nodata))
    assert np.isnan(terrain.z_site_m[0, 1])
    assert np.isfinite(terrain.z_site_m).sum() == 3
