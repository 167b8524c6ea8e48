# SPDX-License-Identifier: Apache-2.0
"""Ground that no rover can stand on ends a drive with a reason and exit 3, never otherwise."""

import json
import sys

import numpy as np
import pytest

from pyharness import cli
from sim.terrain import centred
from sim.terrain_io import write_terrain

SIZE, CELL_M = 400, 0.1
QUICK = ("--start=-10,0,0", "--goal=10,0", "--mode", "unguarded")
SMALL = (
    "--set",
    "camera.cloud_width_px=40",
    "--set",
    "camera.cloud_height_px=30",
    "--set",
    "executive.time_limit_s=1200",
)


def summary_of(monkeypatch, tmp_path, terrain_file, *arguments):
    """Drive towards the middle; return exit code and summary."""
    monkeypatch.chdir(tmp_path)
    command = ["enav", "drive", "--terrain", str(terrain_file), *QUICK, *SMALL, "-o", "drive"]
    monkeypatch.setattr(sys, "argv", [*command, *arguments])
    with pytest.raises(SystemExit) as caught:
        cli.main()
    return caught.value.code, json.loads((tmp_path / "drive/summary.json").read_text())


def north_m():
    return (np.arange(SIZE) - 0.5 * (SIZE - 1)) * CELL_M


@pytest.mark.parametrize("height_m", [50.0, 2.0, -2.0, -50.0])
def test_a_cliff_is_a_limit_violation(monkeypatch, tmp_path, height_m):
    z_m = np.where(north_m()[:, None] > -2.0, -height_m, 0.0) * np.ones(SIZE)
    write_terrain(centred(z_m.astype(np.float32), CELL_M), tmp_path / "cliff.pgm")
    code, summary = summary_of(monkeypatch, tmp_path, "cliff.pgm")
    assert code == 3
    assert summary["outcome"] == "limit_violation"
    assert summary["fault_detail"]
    assert 5.0 < summary["distance_driven_m"] < 8.5


def test_the_edge_of_the_map_is_left_map(monkeypatch, tmp_path):
    flat = centred(np.zeros((SIZE, SIZE), np.float32), CELL_M)
    write_terrain(flat, tmp_path / "flat.pgm")
    code, summary = summary_of(monkeypatch, tmp_path, "flat.pgm", "--start=15,0,0", "--goal=10,10")
    assert code == 3
    assert summary["outcome"] == "left_map"
    assert "true position north" in summary["fault_detail"]
    assert "over the edge of the map" in summary["fault_detail"]


@pytest.mark.parametrize("east_m", [(-20.0, 20.0), (0.9, 1.3), (-0.6, 0.6)])
def test_a_hole_in_a_raster_ends_the_drive(monkeypatch, tmp_path, east_m):
    rasterio = pytest.importorskip("rasterio")
    up_m = np.zeros((SIZE, SIZE), np.float32)
    rows = (north_m()[::-1] > -3.0) & (north_m()[::-1] < 3.0)
    cols = (north_m() > east_m[0]) & (north_m() < east_m[1])
    up_m[np.ix_(rows, cols)] = -9999.0
    with rasterio.open(
        tmp_path / "holed.tif", "w", driver="GTiff", width=SIZE, height=SIZE, count=1,
        dtype="float32", nodata=-9999.0, crs="EPSG:32633",
        transform=rasterio.Affine(CELL_M, 0, 0, 0, -CELL_M, SIZE * CELL_M),
    ) as file:  # fmt: skip
        file.write(up_m, 1)
    code, summary = summary_of(monkeypatch, tmp_path, "holed.tif")
    assert code == 3
    assert summary["outcome"] in ("left_map", "limit_violation")
    assert summary["fault_detail"]
    assert 4.5 < summary["distance_driven_m"] < 9.5
