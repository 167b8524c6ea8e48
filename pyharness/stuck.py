# SPDX-License-Identifier: Apache-2.0
"""Notices a drive that gets nowhere: wheels that slip, or a path that leads to no goal."""

import math
from collections import deque
from dataclasses import dataclass, field

from pyharness.executive_config import StuckRules
from pyharness.messages import Arc, distance_m
from pyharness.protocols import Pose
from pyharness.records import Waypoint

WHEEL_TRACK_M = 1.0  # path of a wheel in a turn in place, per radian: about that of a rover


@dataclass(slots=True)
class StuckWatch:
    """Compares what was commanded with where the rover believes to be."""

    rules: StuckRules
    _place: tuple[float, float] | None = None
    _legs: deque[tuple[float, float]] = field(default_factory=deque)  # commanded, moved
    _nearest_m: float = math.inf
    _without_progress_m: float = 0.0

    def start(self, pose: Pose) -> None:
        """Take the place from which the next arc's motion is measured."""
        self._place = (pose.x_m, pose.y_m)

    def new_goal(self) -> None:
        """Forget how near the old goal was."""
        self._nearest_m = math.inf
        self._without_progress_m = 0.0

    def arc_finished(self, commanded: Arc, pose: Pose, goal: Waypoint | None) -> str | None:
        """Take in one arc; return why the drive counts as stuck, or None.

        Without a goal only slip counts.
        """
        moved_m = 0.0
        if self._place is not None:
            moved_m = math.hypot(pose.x_m - self._place[0], pose.y_m - self._place[1])
        reason = self._slipping(abs(commanded.length_m), moved_m)
        if reason is not None or goal is None:
            return reason
        return self._wandering(
            abs(commanded.length_m) + self._turned_m(commanded), distance_m(pose, goal)
        )

    @staticmethod
    def _turned_m(arc: Arc) -> float:
        return 0.0 if arc.length_m else WHEEL_TRACK_M * abs(arc.heading_change_rad)

    def _slipping(self, commanded_m: float, moved_m: float) -> str | None:
        self._legs.append((commanded_m, moved_m))
        while sum(leg[0] for leg in self._legs) - self._legs[0][0] >= self.rules.slip_window_m:
            self._legs.popleft()
        all_commanded_m = sum(leg[0] for leg in self._legs)
        all_moved_m = sum(leg[1] for leg in self._legs)
        if all_commanded_m < self.rules.slip_window_m:
            return None
        if all_moved_m >= self.rules.slip_progress_min * all_commanded_m:
            return None
        return f"moved {all_moved_m:.2f} m on {all_commanded_m:.2f} m of commanded path"

    def _wandering(self, commanded_m: float, goal_m: float) -> str | None:
        if goal_m < self._nearest_m:
            self._nearest_m = goal_m
            self._without_progress_m = 0.0
            return None
        self._without_progress_m += commanded_m
        if self._without_progress_m < self.rules.progress_window_m:
            return None
        return (
            f"{self._without_progress_m:.0f} m of path without coming nearer to the waypoint than"
            f" {self._nearest_m:.1f} m"
        )
