# SPDX-License-Identifier: Apache-2.0
"""The slope of the ground around every place."""

import numpy as np
import pytest

from sim.generate import TerrainRecipe, generate
from sim.ground import CELL_M, PATCH_CELLS, ground_slope
from sim.terrain import Terrain, centred


def plane(resolution_m: float, north: float, east: float) -> Terrain:
    """A 20 m square of z = north x + east y."""
    axis = (np.arange(round(20 / resolution_m)) + 0.5) * resolution_m - 10
    z = north * axis[:, None] + east * axis
    return centred(z.astype(np.float32), resolution_m)


@pytest.mark.parametrize("resolution_m", [0.1, 0.25, 1.0])
def test_a_plane_has_its_own_slope_everywhere(resolution_m: float) -> None:
    slope = ground_slope(plane(resolution_m, 0.3, -0.2))
    known = np.isfinite(slope.gradient[..., 0])
    assert known.mean() > 0.9
    np.testing.assert_allclose(slope.gradient[known], [[0.3, -0.2]] * known.sum(), atol=1e-5)


def test_it_is_the_least_squares_plane_of_the_nodes_of_the_square() -> None:
    terrain = generate(TerrainRecipe(size_m=20, cfa=0.15, seed=3))
    slope = ground_slope(terrain)
    half_m = 0.5 * PATCH_CELLS * CELL_M
    for row, col in ((10, 12), (20, 20), (31, 7)):
        north_m = slope.north_min_m + (row + 0.5) * CELL_M
        east_m = slope.east_min_m + (col + 0.5) * CELL_M
        rows = np.abs(terrain.north_m - north_m) < half_m
        cols = np.abs(terrain.east_m - east_m) < half_m
        north, east = np.meshgrid(terrain.north_m[rows], terrain.east_m[cols], indexing="ij")
        matrix = np.stack([np.ones(north.size), north.ravel(), east.ravel()], axis=1)
        z = terrain.z_site_m[np.ix_(rows, cols)].ravel().astype(float)
        (_, *expected), *_ = np.linalg.lstsq(matrix, z, rcond=None)
        np.testing.assert_allclose(slope.gradient[row, col], expected, atol=1e-6)


def test_nodes_without_ground_are_left_out() -> None:
    full = plane(0.1, 0.1, 0.4)
    z = full.z_site_m.copy()
    z[:100] = np.nan
    gradient = ground_slope(centred(z, 0.1)).gradient
    assert np.isnan(gradient[:15]).all()
    np.testing.assert_allclose(gradient[25, 20], [0.1, 0.4], atol=1e-5)
