# SPDX-License-Identifier: Apache-2.0
"""Shared terrains and the default vehicle."""

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from sim.generate import TerrainRecipe, generate
from sim.stereo_noise import slid_points_m
from sim.terrain import Terrain, centred
from sim.vehicle import Vehicle, load_vehicle

Surface = Callable[[npt.NDArray[np.float64], npt.NDArray[np.float64]], npt.NDArray[np.float64]]


def terrain_of(up_m: Surface, size_m: float = 20.0, resolution_m: float = 0.1) -> Terrain:
    """Terrain whose height (up) is a function of north and east."""
    count = round(size_m / resolution_m)
    axis = (np.arange(count) - 0.5 * (count - 1)) * resolution_m
    north, east = np.meshgrid(axis, axis, indexing="ij")
    return centred((-up_m(north, east)).astype(np.float32), resolution_m)


def range_sigma_m(
    ranges_m: npt.NDArray[np.float64],
    directions: npt.NDArray[np.float64],
    baseline_m: npt.NDArray[np.float64],
    pixel_sigma_rad: float,
) -> npt.NDArray[np.float64]:
    """Standard deviation [n] of the range: how far a million of them slide the points."""
    million = np.full(len(ranges_m), 1e6)
    ranges = ranges_m.astype(np.float32)
    points = slid_points_m(ranges, directions, np.zeros(3), baseline_m, pixel_sigma_rad, million)
    slid_m = np.linalg.norm(points.astype(float), axis=1) - ranges
    sigma_m: npt.NDArray[np.float64] = slid_m / million
    return sigma_m


@pytest.fixture(scope="session")
def vehicle() -> Vehicle:
    return load_vehicle()


@pytest.fixture(scope="session")
def rocky() -> Terrain:
    """Forty metres of the worst standard cell: CFA 15 %, slope 20 degrees."""
    return generate(TerrainRecipe(size_m=40, cfa=0.15, slope_deg=20, slope_azimuth_deg=70, seed=5))


@pytest.fixture(scope="session")
def flat() -> Terrain:
    return terrain_of(lambda north, _east: 0.0 * north, size_m=40.0)


@pytest.fixture
def data_dir() -> Path:
    """Folder with real data that is not part of the repository."""
    folder = os.environ.get("ENAV_TEST_DATA")
    if not folder:
        pytest.skip("set ENAV_TEST_DATA to the folder with gale_hirise_1m.tif to run this")
    return Path(folder)
