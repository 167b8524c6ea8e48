# SPDX-License-Identifier: Apache-2.0
"""What the wheels do: they stand, steer or drive, and every change is a bar of the timeline."""

import math
from enum import Enum, auto

from pyharness.messages import Arc
from pyharness.protocols import World
from pyharness.status import Activity
from pyharness.telemetry import NO_ARC, Telemetry

TIME_TOLERANCE_S = 1e-9
CURVATURE_TOLERANCE = 1e-9


class Motion(Enum):
    """What the wheels do."""

    STANDING = auto()
    STEERING = auto()
    DRIVING = auto()


LANE = {
    Motion.STANDING: Activity.WAITING,
    Motion.STEERING: Activity.STEERING,
    Motion.DRIVING: Activity.DRIVING,
}


class Wheels:
    """STANDING, then STEERING where the wheels are turned otherwise, DRIVING, STANDING again."""

    def __init__(self, world: World, telemetry: Telemetry) -> None:
        """Stand, the wheels straight."""
        self._world = world
        self._telemetry = telemetry
        self._motion = Motion.STANDING
        self._start_s = world.time_s
        self._steering_end_s = 0.0
        self._arc = NO_ARC

    @property
    def motion(self) -> Motion:
        """What the wheels do now."""
        return self._motion

    @property
    def arc(self) -> Arc:
        """The arc of this motion, or the last one: how the wheels are turned."""
        return self._arc

    @property
    def is_arc_done(self) -> bool:
        """Whether the arc being driven is over."""
        return self._motion is Motion.DRIVING and self._world.arc_done

    @property
    def remaining(self) -> Arc:
        """What is still to be driven of the arc; nothing when the rover stands."""
        if self._motion is Motion.STANDING:
            return NO_ARC
        is_driving = self._motion is Motion.DRIVING
        return self._arc.part(1.0 - self._world.arc_fraction if is_driving else 1.0)

    def begin(self, arc: Arc) -> bool:
        """Steer where the wheels are turned otherwise, else drive; whether they drive already."""
        turned, wanted = self._arc.curvature_per_m, arc.curvature_per_m
        # parts of one arc differ in the last digit
        is_steered = math.isclose(turned, wanted, rel_tol=CURVATURE_TOLERANCE)
        steering_s = 0.0 if is_steered else self._world.steering_duration_s(turned, wanted)
        self._change(Motion.STEERING)
        self._arc = arc
        self._steering_end_s = self._world.time_s + steering_s
        return self.drive_if_steered()

    def drive_if_steered(self) -> bool:
        """Drive once the wheels are turned; whether that was now."""
        is_steered = self._world.time_s >= self._steering_end_s - TIME_TOLERANCE_S
        if self._motion is not Motion.STEERING or not is_steered:
            return False
        self._change(Motion.DRIVING)
        self._world.start_arc(self._arc.length_m, self._arc.heading_change_rad)
        return True

    def end(self) -> Arc:
        """Stand; return what was driven of the arc."""
        fraction = self._world.arc_fraction if self._motion is Motion.DRIVING else 0.0
        self._world.stop()
        self._change(Motion.STANDING)
        return self._arc.part(fraction)

    def _change(self, motion: Motion) -> None:
        now_s = self._world.time_s
        if now_s > self._start_s:
            arc = NO_ARC if self._motion is Motion.STANDING else self._arc
            self._telemetry.activity(LANE[self._motion], self._start_s, now_s, arc)
        self._motion = motion
        self._start_s = now_s
