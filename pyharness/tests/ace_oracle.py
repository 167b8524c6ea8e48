# SPDX-License-Identifier: Apache-2.0
"""Settling against ACE: the same poses on the same ground, and how far one leaves the other."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pyharness.clib import ffi, lib
from pyharness.dp import Kind, Message, new_message
from pyharness.layout import dtype_of
from pyharness.messages import Pose6, cloud_requests
from pyharness.navlib import Navlib
from pyharness.params import param_values
from sim.ground import CELL_M
from sim.settle import Settler
from sim.terrain import Terrain
from sim.vehicle import load_vehicle

TOLERANCE = 2e-4  # of the settling: 0.1 mm of gap under a wheel
INTERVALS = {
    "z_m": ("z_min_site_m", "z_max_site_m"),
    "roll_rad": ("roll_min_rad", "roll_max_rad"),
    "pitch_rad": ("pitch_min_rad", "pitch_max_rad"),
    "rocker_rad": ("rocker_min_rad", "rocker_max_rad"),
    "bogie_left_rad": ("bogie_left_min_rad", "bogie_left_max_rad"),
    "bogie_right_rad": ("bogie_right_min_rad", "bogie_right_max_rad"),
}
Poses = npt.NDArray[np.float64]  # [n, 3]: north, east, yaw


def navlib_on(terrain: Terrain, params: dict[str, float] | None = None) -> Navlib:
    """Navlib with one exact point in every cell of its map around the SITE origin."""
    navlib = Navlib(param_values(params or {}))
    north, east = np.meshgrid(terrain.north_m, terrain.east_m, indexing="ij")
    near = (np.abs(north) < 15.0) & (np.abs(east) < 15.0) & np.isfinite(terrain.z_site_m)
    points = np.stack([north[near], east[near], terrain.z_site_m[near]], axis=1)
    origin = Pose6(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for chunk in cloud_requests(0.0, origin, 1, points.astype(np.float32)):
        assert navlib.process_disparity(chunk)["status"] == 0
        lib.nav_stub_clear()
    assert navlib.analyze_terrain(new_message(Kind.ANALYZE_TERRAIN_IN))["status"] == 0
    lib.nav_stub_clear()
    return navlib


def ace_bounds(navlib: Navlib, poses: Poses, uncertainty: npt.NDArray[np.float64]) -> Message:
    """ACE's bounds [n] at poses, each with its own (position, yaw) uncertainty [n, 2]."""
    ctx = navlib.context
    scene = ffi.new("nav_ace_scene_t *")
    scene.params = ffi.addressof(ctx, "params")
    scene.vehicle = ffi.addressof(ctx, "vehicle")
    scene.surface = ffi.addressof(ctx, "surface")
    scene.costmap = ffi.addressof(ctx, "costmap")
    scene.relief = ffi.addressof(ctx, "relief")
    scene.work = ffi.addressof(ctx, "ace_work")
    bounds: Message = np.zeros(len(poses), dtype_of("nav_ace_bounds_t"))
    out = ffi.from_buffer("nav_ace_bounds_t[]", bounds, require_writable=True)
    pose_c = ffi.new("nav_pose2_t *")
    doubt_c = ffi.new("nav_uncertainty_t *")
    for index in range(len(poses)):
        pose_c.x_m, pose_c.y_m, pose_c.yaw_rad = poses[index].tolist()
        doubt_c.position_m, doubt_c.yaw_rad = uncertainty[index].tolist()
        lib.nav_ace_evaluate(scene, pose_c, doubt_c, False, out + index)
    return bounds


def overshoot(states: Message, bounds: Message) -> dict[str, npt.NDArray[np.float64]]:
    """How far each quantity of settled states lies outside its bounds; negative is inside."""
    outside = {
        name: np.maximum(bounds[low] - states[name], states[name] - bounds[high])
        for name, (low, high) in INTERVALS.items()
    }
    outside["clearance_m"] = bounds["clearance_min_m"] - states["clearance_m"]
    outside["wheel_drop_m"] = states["wheel_drop_m"] - bounds["wheel_drop_max_m"]
    outside["tilt_rad"] = states["tilt_rad"] - bounds["tilt_max_rad"]
    return outside


def is_truly_safe(states: Message, params: dict[str, float]) -> npt.NDArray[np.bool_]:
    """Which settled states keep every limit that ACE checks."""
    bogie_rad = np.maximum(np.abs(states["bogie_left_rad"]), np.abs(states["bogie_right_rad"]))
    return np.asarray(
        (states["clearance_m"] >= params["clearance_min_m"])
        & (states["tilt_rad"] <= params["tilt_max_rad"])
        & (np.abs(states["rocker_rad"]) <= params["rocker_max_rad"])
        & (bogie_rad <= params["bogie_max_rad"])
        & (states["wheel_drop_m"] <= params["wheel_drop_max_m"])
    )


@dataclass(frozen=True, slots=True, eq=False)
class Trial:
    """Poses that ACE was asked about, and where the rover then really stood and how.

    Attributes:
        stated: What ACE was told, [n, 3].
        uncertainty: With this position and yaw uncertainty, [n, 2].
        actual: Where the rover stood, within the uncertainty, [n, 3].
        states: Settled there.
        bounds: What ACE promised.
    """

    stated: Poses
    uncertainty: npt.NDArray[np.float64]
    actual: Poses
    states: Message
    bounds: Message

    def excess(self) -> dict[str, npt.NDArray[np.float64]]:
        """Overshoot of every quantity at every pose; -inf where nothing was promised or settled.

        Wheel drop is measured across the plane under the rover. Where the rover stood in another
        cell of planes than ACE was told, the two are drops across different planes: left out.
        """
        outside = overshoot(self.states, self.bounds)
        outside["wheel_drop_m"] = np.where(self.on_stated_plane, outside["wheel_drop_m"], -np.inf)
        return {name: np.where(self.is_bound, by, -np.inf) for name, by in outside.items()}

    def worst(self) -> tuple[npt.NDArray[np.float64], list[str]]:
        """Largest overshoot at every pose, and of what."""
        excess = self.excess()
        names = list(excess)
        table = np.array(list(excess.values()))
        which = np.argmax(table, axis=0)
        return table[which, np.arange(table.shape[1])], [names[index] for index in which]

    @property
    def is_bound(self) -> npt.NDArray[np.bool_]:
        """Poses for which ACE promised something and the rover settled."""
        return np.asarray((self.bounds["is_certified"] == 1) & (self.states["converged"] == 1))

    @property
    def on_stated_plane(self) -> npt.NDArray[np.bool_]:
        """Poses at which the rover stood in the cell of planes that ACE was told."""
        cells = [np.floor(poses[:, :2] / CELL_M) for poses in (self.stated, self.actual)]
        return np.asarray(np.all(cells[0] == cells[1], axis=1))

    def drop_across_planes(self) -> npt.NDArray[np.float64]:
        """Overshoot of wheel drop where it is measured across a neighbouring cell's plane."""
        drop_m = self.states["wheel_drop_m"] - self.bounds["wheel_drop_max_m"]
        return np.asarray(drop_m[self.is_bound & ~self.on_stated_plane])


def try_poses(
    navlib: Navlib,
    settler: Settler,
    stated: Poses,
    uncertainty: npt.NDArray[np.float64],
    rng: np.random.Generator,
) -> Trial:
    """Ask ACE about poses; settle the rover within their uncertainty, often at its rim."""
    count = len(stated)
    reach = np.minimum(1.0, rng.uniform(0.0, 2.0, count))
    away = rng.uniform(-math.pi, math.pi, count)
    turn = np.clip(rng.uniform(-2.0, 2.0, count), -1.0, 1.0)
    shift = np.column_stack([np.cos(away), np.sin(away)]) * (reach * uncertainty[:, 0])[:, None]
    actual = stated + np.column_stack([shift, turn * uncertainty[:, 1]])
    return Trial(
        stated,
        uncertainty,
        actual,
        settler.settle_many(actual),
        ace_bounds(navlib, stated, uncertainty),
    )


def settler_on(terrain: Terrain) -> Settler:
    """Settles the default vehicle."""
    return Settler(terrain, load_vehicle())
