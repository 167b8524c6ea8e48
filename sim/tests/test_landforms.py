# SPDX-License-Identifier: Apache-2.0
"""Made bases have the shape their name says."""

import typing

import numpy as np
import numpy.typing as npt
import pytest
from scipy.ndimage import label

from sim.landforms import Landform, LandformKind, landform_up_m
from sim.random_streams import rng_for

AXIS: npt.NDArray[np.float64] = (np.arange(400, dtype=np.float64) - 199.5) * 0.1


def made(
    kind: LandformKind, height_m: float = 2.0, width_m: float = 10.0
) -> npt.NDArray[np.float64]:
    form = Landform(kind=kind, height_m=height_m, width_m=width_m)
    return landform_up_m(form, AXIS, AXIS, rng_for(1, "landform"))


@pytest.mark.parametrize("kind", typing.get_args(LandformKind))
def test_every_kind_is_finite_scales_and_repeats(kind: LandformKind) -> None:
    heights = made(kind)
    assert heights.shape == (400, 400)
    assert np.isfinite(heights).all()
    assert 1.0 < np.ptp(heights) <= 2.0 * 1.3
    np.testing.assert_array_equal(heights, made(kind))
    np.testing.assert_allclose(made(kind, height_m=4.0), 2 * heights)


def test_a_crater_is_a_bowl_with_a_rim() -> None:
    heights = made("crater")
    assert heights[200, 200] == pytest.approx(-2.0, abs=0.01)
    assert heights.max() == pytest.approx(0.4, abs=0.05)
    assert abs(heights[0, 0]) < 0.05


def test_a_cliff_rises_east_and_a_slope_north() -> None:
    cliff, slope = made("cliff"), made("slope_transition")
    assert cliff[:, 0].max() == 0
    assert cliff[:, -1].min() == 2
    assert slope[0].max() == 0
    assert slope[-1].min() == pytest.approx(2.0)
    assert (np.diff(slope[:, 0]) >= 0).all()


def test_a_corridor_is_level_between_walls() -> None:
    heights = made("corridor")
    assert (heights == 0).any(axis=1).all()
    assert (heights == 2).any(axis=1).all()


def test_every_cell_of_a_maze_can_be_reached() -> None:
    # 7 x 7 cells of 5 m: inside the outermost walls there is one connected region
    free = made("maze", width_m=5.0)[26:-26, 26:-26] == 0
    assert 0.5 < free.mean() < 1.0
    assert label(free)[1] == 1


@pytest.mark.parametrize("kind", typing.get_args(LandformKind))
def test_a_landform_can_be_turned_and_moved(kind: LandformKind) -> None:
    rng = [rng_for(1, "landform") for _ in range(2)]
    plain = landform_up_m(Landform(kind=kind), AXIS, AXIS, rng[0])
    turned = landform_up_m(Landform(kind=kind, azimuth_deg=90), AXIS, AXIS, rng[1])
    # turned clockwise: what was in the north is in the east
    np.testing.assert_allclose(turned, plain[:, ::-1].T, atol=1e-6)
    moved = landform_up_m(
        Landform(kind="crater", center_m=(5.0, -3.0)), AXIS, AXIS, rng_for(1, "landform")
    )
    row, col = np.unravel_index(np.argmin(moved), moved.shape)
    assert (AXIS[row], AXIS[col]) == pytest.approx((5.0, -3.0), abs=0.1)
