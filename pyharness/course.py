# SPDX-License-Identifier: Apache-2.0
"""What the rover was told to do: arcs driven as given, then waypoints, one after the other."""

from collections.abc import Sequence
from dataclasses import dataclass

from pyharness.messages import DirectedArc, distance_m
from pyharness.protocols import Pose
from pyharness.records import Waypoint
from pyharness.status import HostEvr, Mode
from pyharness.telemetry import Telemetry


@dataclass(slots=True)
class Course:
    """The list, and how far it is done; reports what begins and what is reached."""

    arcs: Sequence[DirectedArc]
    waypoints: Sequence[Waypoint]
    telemetry: Telemetry
    _arc_index: int = 0
    _waypoint_index: int = 0

    @property
    def arc(self) -> DirectedArc | None:
        """The directed arc that is to be driven now."""
        return self.arcs[self._arc_index] if self._arc_index < len(self.arcs) else None

    @property
    def waypoint(self) -> Waypoint | None:
        """Where the rover goes now, or after the arcs."""
        is_left = self._waypoint_index < len(self.waypoints)
        return self.waypoints[self._waypoint_index] if is_left else None

    def waypoint_from(self, pose: Pose) -> Waypoint | None:
        """Return where it would go from a pose: this waypoint, or the next where it is reached."""
        waypoint = self.waypoint
        if waypoint is None or distance_m(pose, waypoint) > waypoint.radius_m:
            return waypoint
        following = self.waypoints[self._waypoint_index + 1 :]
        return following[0] if following else None

    def arc_driven(self) -> None:
        """Turn to the next arc."""
        self._arc_index += 1

    def report_arc(self) -> None:
        """Report the arc that begins."""
        if self.arc is not None:
            number, arc, mode = self._arc_index + 1, self.arc.arc, Mode[self.arc.mode.upper()]
            self.telemetry.event(
                HostEvr.DIRECTED_ARC, number, arc.length_m, arc.heading_change_rad, mode
            )

    def report_waypoint(self) -> None:
        """Report the Go To that begins."""
        if self.waypoint is not None:
            goal, mode = self.waypoint, Mode[self.waypoint.mode.upper()]
            number = self._waypoint_index + 1
            self.telemetry.event(HostEvr.GO_TO, number, goal.north_m, goal.east_m, mode)

    def tick_off(self, pose: Pose) -> bool:
        """Turn to the next waypoint where this one is reached; whether it was."""
        goal = self.waypoint
        if goal is None or distance_m(pose, goal) > goal.radius_m:
            return False
        self._waypoint_index += 1
        left_m = distance_m(pose, goal)
        self.telemetry.event(HostEvr.WAYPOINT_REACHED, self._waypoint_index, left_m)
        self.report_waypoint()
        return True
