# SPDX-License-Identifier: Apache-2.0
"""Settling of the rocker-bogie rover on a terrain (kernel: `kernels/settle.c`)."""

import struct
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from sim.clib import dtype_of, ffi, lib, pointer
from sim.errors import TerrainError
from sim.ground import CELL_M, GroundSlope, ground_slope
from sim.terrain import Terrain
from sim.vehicle import Vehicle

SETTLED_DTYPE = dtype_of("sim_settled_t")
RESOLUTION_MAX_M = 1.0

# a settled state begins with these doubles, x_m to residual_m, and ends with these integers
_HEAD = struct.Struct("=13d")
_FLAGS = struct.Struct("=3i")
_CONTACTS_OFFSET = ffi.offsetof("sim_settled_t", "contact_site_m")
_FLAGS_OFFSET = ffi.offsetof("sim_settled_t", "iterations")

_WHEEL_KIND = {
    "point": lib.SIM_WHEEL_POINT,
    "disc": lib.SIM_WHEEL_DISC,
    "cylinder": lib.SIM_WHEEL_CYLINDER,
}


@dataclass(frozen=True, slots=True, eq=False)
class SettledState:
    """A rover at rest on the ground.

    Off the map (`on_map` False) every field but x, y and yaw is NaN. `converged` is False when a
    wheel is further than the tolerance from the ground; the state is then the best one found.

    Attributes:
        rocker_rad: Left rocker against the body, positive nose-down; the right one is opposite.
        bogie_left_rad: Left bogie against its rocker, positive nose-down; likewise the right.
        clearance_m: Least distance along body z from belly pan to a terrain node under it; NaN over
            a hole in the terrain.
        wheel_drop_m: Largest height span in one wheel's footprint, across the slope of the ground;
            likewise.
        contact_site_m: Contact points [6, 3] in SITE: LF, LM, LR, RF, RM, RR.
        residual_m: Largest vertical gap between a wheel and the ground.
    """

    x_m: float
    y_m: float
    z_m: float
    roll_rad: float
    pitch_rad: float
    yaw_rad: float
    rocker_rad: float
    bogie_left_rad: float
    bogie_right_rad: float
    tilt_rad: float
    clearance_m: float
    wheel_drop_m: float
    contact_site_m: npt.NDArray[np.float64]
    residual_m: float
    iterations: int
    converged: bool
    on_map: bool


def terrain_struct(terrain: Terrain, slope: GroundSlope | None = None) -> Any:
    """C view of a terrain and the slope of its ground; both must outlive it."""
    rows, cols = terrain.z_site_m.shape
    view = ffi.new(
        "sim_terrain_t *",
        {
            "z_site_m": pointer(terrain.z_site_m, "const float *"),
            "rows": rows,
            "cols": cols,
            "resolution_m": terrain.resolution_m,
            "north_min_m": terrain.north_min_m,
            "east_min_m": terrain.east_min_m,
        },
    )
    if slope is not None:
        view.slope = pointer(slope.gradient, "const float *")
        view.slope_rows, view.slope_cols, _ = slope.gradient.shape
        view.slope_cell_m = CELL_M
        view.slope_north_min_m = slope.north_min_m
        view.slope_east_min_m = slope.east_min_m
    return view


def vehicle_struct(vehicle: Vehicle) -> Any:
    """C copy of what settling needs of a vehicle."""
    return ffi.new(
        "sim_vehicle_t *",
        {
            "hub_m": vehicle.hubs_m.tolist(),
            "rocker_pivot_m": vehicle.rocker_pivots_m.tolist(),
            "bogie_pivot_m": vehicle.bogie_pivots_m.tolist(),
            "wheel_radius_m": vehicle.geometry.wheel_radius_m,
            "wheel_width_m": vehicle.geometry.wheel_width_m,
            "belly_front_m": vehicle.belly.front_m,
            "belly_rear_m": vehicle.belly.rear_m,
            "belly_half_width_m": vehicle.belly.half_width_m,
            "belly_z_m": -vehicle.belly.height_m,
            "tolerance_m": vehicle.settling.tolerance_m,
            "iterations_max": vehicle.settling.iterations_max,
            "wheel_kind": _WHEEL_KIND[vehicle.settling.wheel],
        },
    )


class Settler:
    """Settles one vehicle on one terrain."""

    def __init__(self, terrain: Terrain, vehicle: Vehicle) -> None:
        """Prepare the kernel's views of both."""
        if terrain.resolution_m > RESOLUTION_MAX_M:
            raise TerrainError(
                f"terrain: nodes {terrain.resolution_m} m apart are too coarse to settle on,"
                f" expected at most {RESOLUTION_MAX_M} m (resample it)"
            )
        self.terrain = terrain
        self.vehicle = vehicle
        self._slope = ground_slope(terrain)
        self.terrain_c = terrain_struct(terrain, self._slope)
        self.vehicle_c = vehicle_struct(vehicle)

    def settle(
        self,
        north_m: float,
        east_m: float,
        yaw_rad: float,
        guess: SettledState | None = None,
    ) -> SettledState:
        """Settle at one pose; `guess`, a state near by, makes it faster and continuous."""
        pose = ffi.new("double[3]", (north_m, east_m, yaw_rad))
        out = ffi.new("sim_settled_t *")
        lib.sim_settle(self.terrain_c, self.vehicle_c, pose, _guess_struct(guess), out)
        return _state_of(out)

    def settle_many(self, poses: npt.ArrayLike, chained: bool = False) -> npt.NDArray[np.void]:
        """Settle poses [n, 3] of (north, east, yaw); SETTLED_DTYPE [n].

        With `chained` each pose starts from its predecessor, as along a drive.
        """
        pose_array = np.ascontiguousarray(poses, dtype=np.float64).reshape(-1, 3)
        out = np.zeros(len(pose_array), dtype=SETTLED_DTYPE)
        lib.sim_settle_path(
            self.terrain_c,
            self.vehicle_c,
            pointer(pose_array, "const double *"),
            len(pose_array),
            int(chained),
            ffi.cast("sim_settled_t *", out.ctypes.data),
        )
        return out

    def chain(self) -> "SettleChain":
        """For poses one after the other, each settled from the one before it."""
        return SettleChain(self)


class SettleChain:
    """Settles along a drive, with as little as possible between Python and the kernel."""

    def __init__(self, settler: Settler) -> None:
        """Begin without a state to start from; the settler owns what its C views point to."""
        self._settler = settler
        self._pose = ffi.new("double[3]")
        self._last, self._next = ffi.new("sim_settled_t *"), ffi.new("sim_settled_t *")

    def settle(self, north_m: float, east_m: float, yaw_rad: float) -> tuple[Any, ...]:
        """Settle at a pose; the fields of SettledState in their order."""
        pose = self._pose
        pose[0], pose[1], pose[2] = north_m, east_m, yaw_rad
        guess = self._last if self._last.on_map else ffi.NULL
        settler = self._settler
        lib.sim_settle(settler.terrain_c, settler.vehicle_c, pose, guess, self._next)
        self._last, self._next = self._next, self._last
        return _fields_of(self._last)


def settle_on_hub_heights(
    vehicle: Vehicle, yaw_rad: float, hub_z_site_m: npt.ArrayLike
) -> SettledState:
    """Settle the linkage alone on six given hub heights (SITE z), at the SITE origin."""
    pose = ffi.new("double[3]", (0.0, 0.0, yaw_rad))
    hubs = ffi.new("double[6]", np.asarray(hub_z_site_m, dtype=np.float64).tolist())
    out = ffi.new("sim_settled_t *")
    lib.sim_settle_hubs(vehicle_struct(vehicle), pose, hubs, out)
    return _state_of(out)


def _guess_struct(guess: SettledState | None) -> Any:
    if guess is None or not guess.on_map:
        return ffi.NULL
    return ffi.new(
        "sim_settled_t *",
        {
            "x_m": guess.x_m,
            "y_m": guess.y_m,
            "yaw_rad": guess.yaw_rad,
            "z_m": guess.z_m,
            "roll_rad": guess.roll_rad,
            "pitch_rad": guess.pitch_rad,
            "rocker_rad": guess.rocker_rad,
            "bogie_left_rad": guess.bogie_left_rad,
            "bogie_right_rad": guess.bogie_right_rad,
            "contact_site_m": guess.contact_site_m.tolist(),
        },
    )


def _state_of(out: Any) -> SettledState:
    return SettledState(*_fields_of(out))


def _fields_of(out: Any) -> tuple[Any, ...]:
    """Values of a C struct in the order of SettledState."""
    content = bytes(ffi.buffer(out))
    iterations, converged, on_map = _FLAGS.unpack_from(content, _FLAGS_OFFSET)
    contacts = np.frombuffer(content, np.float64, 18, _CONTACTS_OFFSET).reshape(6, 3)
    *head, residual_m = _HEAD.unpack_from(content)
    return (*head, contacts, residual_m, iterations, bool(converged), bool(on_map))
