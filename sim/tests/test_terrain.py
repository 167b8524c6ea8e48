# SPDX-License-Identifier: Apache-2.0
"""The terrain grid."""

import numpy as np
import pytest

from sim.errors import TerrainError
from sim.terrain import Terrain, centred


def test_a_120_m_terrain_spans_59_95_m() -> None:
    terrain = centred(np.zeros((1200, 1200), np.float32), 0.1)
    assert terrain.north_min_m == pytest.approx(-59.95)
    assert terrain.east_max_m == pytest.approx(59.95)
    assert terrain.north_m[-1] == pytest.approx(terrain.north_max_m)


def test_heights_are_bilinear_and_nan_outside() -> None:
    terrain = Terrain(np.array([[0, 1], [2, 5]], np.float32), 1.0, 10.0, 20.0)
    assert terrain.height_at(10.0, 21.0) == 1.0
    assert terrain.height_at(11.0, 20.0) == 2.0
    assert terrain.height_at(10.5, 20.5) == 2.0
    assert np.isnan(terrain.height_at([9.99, 10.0, np.nan], [20.0, 21.01, 20.0])).all()


def test_contains_respects_the_margin() -> None:
    terrain = centred(np.zeros((11, 11), np.float32), 1.0)
    assert terrain.contains(5, -5)
    assert not terrain.contains(4.5, 0, margin_m=1)
    assert not terrain.contains(float("nan"), 0)


def test_the_grid_is_frozen_and_the_callers_array_is_not() -> None:
    z = np.zeros((3, 3), np.float32)
    terrain = centred(z, 1.0)
    with pytest.raises(ValueError, match="read-only"):
        terrain.z_site_m[0, 0] = 1
    z[0, 0] = 7
    assert terrain.z_site_m[0, 0] == 0


def test_any_layout_becomes_contiguous_float32() -> None:
    terrain = centred(np.asfortranarray(np.ones((4, 3))), 1.0)
    assert terrain.z_site_m.flags["C_CONTIGUOUS"]
    assert terrain.z_site_m.dtype == np.float32


@pytest.mark.parametrize("shape", [(1, 5), (5, 1), (0, 0), (4,)])
def test_too_small_grids_are_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(TerrainError, match="2 x 2"):
        Terrain(np.zeros(shape, np.float32), 1.0, 0.0, 0.0)


@pytest.mark.parametrize("resolution_m", [0.0, -1.0, float("nan"), float("inf")])
def test_bad_resolutions_are_refused(resolution_m: float) -> None:
    with pytest.raises(TerrainError, match="resolution"):
        Terrain(np.zeros((2, 2), np.float32), resolution_m, 0.0, 0.0)
