# SPDX-License-Identifier: Apache-2.0
"""Building the records that the executive sends: requests to the planner, truth, timeline."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Self

import numpy as np
import numpy.typing as npt

from pyharness.dp import Kind, Message, new_message
from pyharness.protocols import Estimate, Pose, Truth
from pyharness.records import Waypoint
from pyharness.status import Mode


@dataclass(frozen=True, slots=True)
class Arc:
    """A constant-curvature arc, or a turn in place when it has no length."""

    length_m: float
    heading_change_rad: float

    def part(self, fraction: float) -> Self:
        """Return the given part of the arc."""
        return type(self)(self.length_m * fraction, self.heading_change_rad * fraction)

    @property
    def curvature_per_m(self) -> float:
        """How the wheels are turned: infinite for a turn in place."""
        if self.heading_change_rad == 0.0:
            return 0.0
        return self.heading_change_rad / self.length_m if self.length_m else math.inf

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing to drive."""
        return self.length_m == 0.0 and self.heading_change_rad == 0.0


@dataclass(frozen=True, slots=True)
class DirectedArc:
    """An arc that is driven as given, and the mode in which it is checked."""

    arc: Arc
    mode: str


@dataclass(frozen=True, slots=True)
class Pose6:
    """A pose in SITE."""

    x_m: float
    y_m: float
    z_m: float
    roll_rad: float
    pitch_rad: float
    yaw_rad: float


@dataclass(frozen=True, slots=True)
class Uncertainty:
    """How far the true pose may be from a stated one."""

    position_m: float
    yaw_rad: float
    global_position_m: float


def copy_pose(pose: Pose) -> Pose6:
    """Return a pose's present values."""
    return Pose6(pose.x_m, pose.y_m, pose.z_m, pose.roll_rad, pose.pitch_rad, pose.yaw_rad)


def pose_after(pose: Pose6, arc: Arc) -> Pose6:
    """Return the pose at the end of an arc on ground like that under the rover now."""
    half_rad = 0.5 * arc.heading_change_rad
    chord_m = arc.length_m * (math.sin(half_rad) / half_rad if half_rad else 1.0)
    direction_rad = pose.yaw_rad + half_rad
    north_m, east_m = chord_m * math.cos(direction_rad), chord_m * math.sin(direction_rad)
    climb_m = -math.tan(pose.pitch_rad) * arc.length_m
    return Pose6(
        pose.x_m + north_m,
        pose.y_m + east_m,
        pose.z_m + climb_m,
        pose.roll_rad,
        pose.pitch_rad,
        pose.yaw_rad + arc.heading_change_rad,
    )


def distance_m(pose: Pose, waypoint: Waypoint) -> float:
    """Return the distance from a pose to the centre of a waydisc."""
    return math.hypot(waypoint.north_m - pose.x_m, waypoint.east_m - pose.y_m)


# ------------------------------------------------------------------ requests


def cloud_requests(
    time_s: float, pose: Pose6, image_id: int, points_m: npt.NDArray[np.float32]
) -> Iterator[Message]:
    """Yield a point cloud [n, 3] in chunks; an empty cloud is one empty chunk."""
    if points_m.dtype != np.float32 or points_m.ndim != 2 or points_m.shape[1] != 3:
        raise ValueError(f"expected a float32 cloud [n, 3], got {points_m.dtype} {points_m.shape}")
    capacity = len(new_message(Kind.PROCESS_DISPARITY_IN)["points"])
    chunk_count = max(1, math.ceil(len(points_m) / capacity))
    for index in range(chunk_count):
        chunk = points_m[index * capacity : (index + 1) * capacity]
        request = new_message(Kind.PROCESS_DISPARITY_IN)
        request["time_s"] = time_s
        _put_pose(request["pose"], pose)
        request["image_id"] = image_id
        request["chunk_index"] = index
        request["chunk_count"] = chunk_count
        request["point_count"] = len(chunk)
        points = request["points"][: len(chunk)]
        points["x_m"], points["y_m"], points["z_m"] = chunk.T
        yield request


def analyze_request(
    time_s: float, pose: Pose6, goal: Waypoint, global_position_m: float
) -> Message:
    """Return the request to analyze the terrain."""
    request = new_message(Kind.ANALYZE_TERRAIN_IN)
    request["time_s"] = time_s
    _put_pose(request["pose"], pose)
    _put_goal(request["goal"], goal)
    request["global_position_m"] = global_position_m
    return request


def select_request(
    time_s: float, pose: Pose6, uncertainty: Uncertainty, goal: Waypoint, driven: Arc
) -> Message:
    """Return the request to select the arc after the one being driven."""
    request = new_message(Kind.SELECT_ARC_IN)
    request["time_s"] = time_s
    _put_pose(request["pose"], pose)
    _put_uncertainty(request["uncertainty"], uncertainty)
    _put_goal(request["goal"], goal)
    in_place = math.isinf(driven.curvature_per_m)
    request["steering"]["in_place"] = in_place
    request["steering"]["curvature_per_m"] = 0.0 if in_place else driven.curvature_per_m
    request["mode"] = Mode[goal.mode.upper()]
    return request


def evaluate_request(
    time_s: float,
    pose: Pose6,
    uncertainty: Uncertainty,
    arc: Arc,
    mode: str,
    is_leaving: bool = False,
) -> Message:
    """Return the request to evaluate one arc, by the leave limits if it was selected by them."""
    request = new_message(Kind.EVALUATE_ARC_IN)
    request["time_s"] = time_s
    _put_pose(request["pose"], pose)
    _put_uncertainty(request["uncertainty"], uncertainty)
    _put_arc(request["arc"], arc)
    request["mode"] = Mode[mode.upper()]
    request["is_leaving"] = is_leaving
    return request


# ------------------------------------------------------------------ records of the host


def truth_record(time_s: float, truth: Truth) -> Message:
    """Return the ground truth of one tick."""
    record = new_message(Kind.TRUTH)
    record["time_s"] = time_s
    _put_pose(record["pose"], truth)
    for name in (
        "rocker_rad",
        "bogie_left_rad",
        "bogie_right_rad",
        "tilt_rad",
        "clearance_m",
        "wheel_drop_m",
        "slip",
        "distance_driven_m",
        "residual_m",
    ):
        record[name] = getattr(truth, name)
    record["is_converged"] = truth.converged
    contacts = record["contacts"]
    contacts["x_m"], contacts["y_m"], contacts["z_m"] = truth.contact_site_m.T
    return record


def estimate_record(time_s: float, estimate: Estimate, uncertainty: Uncertainty) -> Message:
    """Return what the rover believes."""
    record = new_message(Kind.ESTIMATE)
    record["time_s"] = time_s
    _put_pose(record["pose"], estimate)
    _put_uncertainty(record["uncertainty"], uncertainty)
    return record


def timeline_record(activity: int, start_s: float, end_s: float, cycle: int, arc: Arc) -> Message:
    """Return one activity."""
    record = new_message(Kind.TIMELINE)
    record["start_s"] = start_s
    record["end_s"] = end_s
    record["activity"] = activity
    record["cycle"] = cycle
    _put_arc(record["arc"], arc)
    return record


def _put_pose(place: Message, pose: Pose) -> None:
    place["x_site_m"] = pose.x_m
    place["y_site_m"] = pose.y_m
    place["z_site_m"] = pose.z_m
    place["roll_rad"] = pose.roll_rad
    place["pitch_rad"] = pose.pitch_rad
    place["yaw_rad"] = pose.yaw_rad


def _put_uncertainty(place: Message, uncertainty: Uncertainty) -> None:
    place["position_m"] = uncertainty.position_m
    place["yaw_rad"] = uncertainty.yaw_rad
    place["global_position_m"] = uncertainty.global_position_m


def _put_goal(place: Message, goal: Waypoint) -> None:
    place["x_site_m"] = goal.north_m
    place["y_site_m"] = goal.east_m
    place["radius_m"] = goal.radius_m


def _put_arc(place: Message, arc: Arc) -> None:
    place["length_m"] = arc.length_m
    place["heading_change_rad"] = arc.heading_change_rad
