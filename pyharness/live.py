# SPDX-License-Identifier: Apache-2.0
"""A live simulation, as the command socket sees it."""

import math
from collections.abc import Callable, Mapping
from typing import Any

from pyharness.commands import CommandError, EvaluateArc, PlaceRover
from pyharness.executive import Executive
from pyharness.messages import Arc
from pyharness.protocols import World
from pyharness.thinker import PlannerFaultError


class LiveDrive:
    """An executive that has been started; a step is a tick of its world."""

    def __init__(
        self, executive: Executive, world: World, is_on_terrain: Callable[[float, float], bool]
    ) -> None:
        """Take the executive, its world, and where a rover can stand."""
        self._executive = executive
        self._world = world
        self._is_on_terrain = is_on_terrain

    @property
    def time_s(self) -> float:
        """Simulated time."""
        return self._world.time_s

    @property
    def is_over(self) -> bool:
        """Whether the drive has ended."""
        return self._executive.outcome is not None

    def advance(self) -> bool:
        """Live through one tick; whether the drive goes on."""
        self._executive.advance()
        return not self.is_over

    def seek(self, time_s: float) -> None:
        """Refuse: a simulation cannot go to another time."""
        raise CommandError(f"seek: to {time_s:g} s: only a replay can, this is a simulation")

    def image_now(self) -> Mapping[str, Any]:
        """Take an image and merge it at once."""
        try:
            return {"point_count": self._executive.image_now()}
        except PlannerFaultError as error:
            raise CommandError(f"image_now: {error}") from error

    def place_rover(self, command: PlaceRover) -> Mapping[str, Any]:
        """Set the rover down somewhere else."""
        if not self._is_on_terrain(command.north_m, command.east_m):
            raise CommandError(
                f"place_rover: {command.north_m:g}, {command.east_m:g} is not on the terrain"
            )
        self._executive.place(command.north_m, command.east_m, math.radians(command.yaw_deg))
        return {}

    def evaluate_arc(self, command: EvaluateArc) -> Mapping[str, Any]:
        """Ask the planner."""
        arc = Arc(command.length_m, math.radians(command.heading_change_deg))
        place = None
        if command.from_north_east_yaw is not None:
            north_m, east_m, yaw_deg = command.from_north_east_yaw
            place = (north_m, east_m, math.radians(yaw_deg))
        try:
            verdict = self._executive.evaluate(arc, command.mode, place)
        except PlannerFaultError as error:
            raise CommandError(f"evaluate_arc: {error}; has terrain been analyzed yet?") from error
        return {
            "is_safe": verdict.is_safe,
            "reason": verdict.reason.name.lower(),
            "failing_at": verdict.failing_at,
            "text": verdict.text,
        }

    def stop(self) -> None:
        """End the drive."""
        self._executive.stop()
