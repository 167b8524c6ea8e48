# SPDX-License-Identifier: Apache-2.0
"""Arcs, steering angles and how long driving and steering take.

Arcs are measured in the horizontal plane. A heading change is positive clockwise (to the right).
The turn centre lies on the middle axle, so the unsteered middle wheels roll without scrubbing.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sim.vehicle import Vehicle

# hubs of the steered wheels among LF, LM, LR, RF, RM, RR
CORNERS = (0, 2, 3, 5)


@dataclass(frozen=True, slots=True)
class Arc:
    """One commanded motion; length 0 is a turn in place, a negative length drives backwards."""

    length_m: float
    heading_change_rad: float

    @property
    def is_turn_in_place(self) -> bool:
        """Whether the rover only turns."""
        return self.length_m == 0.0

    @property
    def curvature_1_m(self) -> float:
        """Heading change per metre; infinite for a turn in place."""
        return math.inf if self.is_turn_in_place else self.heading_change_rad / self.length_m


def pose_along(
    start: tuple[float, float, float], arc: Arc, fraction: float
) -> tuple[float, float, float]:
    """Pose (x, y, yaw) after a fraction of an arc from a start pose, in closed form."""
    x_m, y_m, yaw_rad = start
    turned = fraction * arc.heading_change_rad
    length_m = fraction * arc.length_m
    # chord of the arc, along the mean heading
    half = 0.5 * turned
    chord_m = length_m * (math.sin(half) / half if half != 0.0 else 1.0)
    heading = yaw_rad + half
    return x_m + chord_m * math.cos(heading), y_m + chord_m * math.sin(heading), yaw_rad + turned


def steering_angles_rad(curvature_1_m: float, vehicle: Vehicle) -> npt.NDArray[np.float64]:
    """Angles [4] of the corner wheels LF, LR, RF, RR, positive to the right, within +-90 deg."""
    hubs = vehicle.hubs_m[list(CORNERS)]
    forward, sideways = _hub_velocity(curvature_1_m, hubs)
    sign = np.where(forward < 0, -1.0, 1.0)
    angles: npt.NDArray[np.float64] = np.arctan2(sign * sideways, sign * forward)
    return angles


def steering_duration_s(curvature_from: float, curvature_to: float, vehicle: Vehicle) -> float:
    """Time to turn the corner wheels from one curvature to another, standing."""
    change = steering_angles_rad(curvature_to, vehicle) - steering_angles_rad(
        curvature_from, vehicle
    )
    return float(np.abs(change).max()) / vehicle.steering_rate_rad_s


def wheel_path_m(arc: Arc, vehicle: Vehicle) -> float:
    """Path of the wheel that travels furthest."""
    forward, sideways = _hub_velocity(arc.curvature_1_m, vehicle.hubs_m)
    rate = abs(arc.heading_change_rad if arc.is_turn_in_place else arc.length_m)
    return rate * float(np.hypot(forward, sideways).max())


def duration_s(arc: Arc, vehicle: Vehicle) -> float:
    """Time to drive an arc, the fastest wheel at its greatest speed."""
    return wheel_path_m(arc, vehicle) / vehicle.drive.wheel_speed_max_m_s


def _hub_velocity(
    curvature_1_m: float, hubs_m: npt.NDArray[np.float64]
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Hub velocities forward and right, per metre of rover path; per radian when in place.

    With the rover at speed 1 and yaw rate k: v = (1 - k y, k x).
    """
    if math.isinf(curvature_1_m):
        return -hubs_m[:, 1], hubs_m[:, 0]
    return 1.0 - curvature_1_m * hubs_m[:, 1], curvature_1_m * hubs_m[:, 0]
