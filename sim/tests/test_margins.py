# SPDX-License-Identifier: Apache-2.0
"""Clearance and wheel drop: what the ground leaves to a settled rover."""

import math

import numpy as np
import numpy.typing as npt
import pytest

from sim.frames import rotation
from sim.generate import TerrainRecipe, generate
from sim.ground import CELL_M, GroundSlope, ground_slope
from sim.settle import Settler
from sim.terrain import Terrain, centred
from sim.tests.conftest import terrain_of
from sim.vehicle import Vehicle

Array = npt.NDArray[np.float64]


def _under(half_m: float, height_m: float, north_m: float, east_m: float) -> Terrain:
    return terrain_of(
        lambda n, e: np.where(
            (np.abs(n - north_m) <= half_m) & (np.abs(e - east_m) <= half_m), height_m, 0.0
        ),
        size_m=12,
    )


def test_a_rock_under_the_belly_takes_its_height_from_the_clearance(vehicle: Vehicle) -> None:
    state = Settler(_under(0.2, 0.25, -0.2, 0.0), vehicle).settle(0, 0, 0)
    assert state.clearance_m == pytest.approx(0.35, abs=1e-4)
    assert state.tilt_rad == pytest.approx(0.0, abs=1e-6)


def test_a_step_under_a_wheel_is_its_wheel_drop(vehicle: Vehicle) -> None:
    hub = vehicle.hubs_m[0]
    state = Settler(_under(0.11, 0.10, hub[0], hub[1]), vehicle).settle(0, 0, 0)
    assert state.wheel_drop_m == pytest.approx(0.10, abs=0.02)


def _nodes(terrain: Terrain, state: np.void) -> tuple[Array, Array]:
    """All nodes of a terrain from the rover's origin: in SITE axes, and in body axes."""
    north, east = np.meshgrid(terrain.north_m, terrain.east_m, indexing="ij")
    site = np.stack([north, east, terrain.z_site_m.astype(np.float64)], axis=-1).reshape(-1, 3)
    site -= [state["x_m"], state["y_m"], state["z_m"]]
    axes = rotation(state["roll_rad"], state["pitch_rad"], state["yaw_rad"])
    return site, site @ axes


def _clearance_m(body: Array, vehicle: Vehicle) -> float:
    belly = vehicle.belly
    inside = (body[:, 0] >= belly.rear_m) & (body[:, 0] <= belly.front_m)
    inside &= np.abs(body[:, 1]) <= belly.half_width_m
    return float(body[inside, 2].min()) + belly.height_m


def _wheel_drop_m(
    site: Array, body: Array, state: np.void, vehicle: Vehicle, slope: GroundSlope
) -> float:
    cell = (
        math.floor((state["x_m"] - slope.north_min_m) / CELL_M),
        math.floor((state["y_m"] - slope.east_min_m) / CELL_M),
    )
    normal = np.array([*-slope.gradient[cell].astype(np.float64), 1.0])
    depth = site @ (normal / np.linalg.norm(normal))
    axes = rotation(state["roll_rad"], state["pitch_rad"], state["yaw_rad"])
    origin = np.array([state["x_m"], state["y_m"], state["z_m"]])
    drops = []
    for hub in (state["hub_site_m"] - origin) @ axes:
        inside = np.abs(body[:, 0] - hub[0]) <= vehicle.geometry.wheel_radius_m
        inside &= np.abs(body[:, 1] - hub[1]) <= 0.5 * vehicle.geometry.wheel_width_m
        drops.append(np.ptp(depth[inside]))
    return float(max(drops))


def test_margins_are_the_extremes_over_every_node_in_their_boxes(vehicle: Vehicle) -> None:
    terrain = generate(
        TerrainRecipe(size_m=24, cfa=0.15, slope_deg=20, slope_azimuth_deg=70, seed=5)
    )
    slope = ground_slope(terrain)
    rng = np.random.default_rng(6)
    poses = np.column_stack([rng.uniform(-8, 8, (200, 2)), rng.uniform(-math.pi, math.pi, 200)])
    # along the grid's lines too, where a box begins and ends with a row
    poses[:40, 2] = np.arange(40) * (math.pi / 2)
    settled = Settler(terrain, vehicle).settle_many(poses)
    assert settled["on_map"].all()
    for state in settled:
        site, body = _nodes(terrain, state)
        assert state["clearance_m"] == pytest.approx(_clearance_m(body, vehicle), abs=1e-9)
        drop_m = _wheel_drop_m(site, body, state, vehicle, slope)
        assert state["wheel_drop_m"] == pytest.approx(drop_m, abs=1e-9)


@pytest.mark.parametrize(
    ("place", "unknown"),
    [
        ((0.3, 0.2), "clearance_m"),
        ((0.0, -1.1845 + 0.15), "wheel_drop_m"),
        ((1.185, 1.0625 - 0.12), "wheel_drop_m"),
    ],
)
def test_a_hole_beside_the_contacts_leaves_its_quantity_unknown(
    flat: Terrain, vehicle: Vehicle, place: tuple[float, float], unknown: str
) -> None:
    z = flat.z_site_m.copy()
    row, col = np.abs(flat.north_m - place[0]).argmin(), np.abs(flat.east_m - place[1]).argmin()
    z[row, col] = np.nan
    state = Settler(centred(z, flat.resolution_m), vehicle).settle(0.0, 0.0, 0.0)
    assert state.on_map
    assert state.converged
    for name in ("clearance_m", "wheel_drop_m"):
        assert math.isnan(getattr(state, name)) == (name == unknown)
    # the pose itself does not depend on it
    assert state.tilt_rad == Settler(flat, vehicle).settle(0.0, 0.0, 0.0).tilt_rad
