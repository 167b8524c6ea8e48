# SPDX-License-Identifier: Apache-2.0
"""What the rover's computer can do: each activity asks the planner or the world and takes its time.

A method starts its activity and says whether the task is done with (`computer.Task`).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

from pyharness.computer import TIME_TOLERANCE_S, Computer
from pyharness.executive_config import ExecutiveConfig
from pyharness.imaging import Images
from pyharness.messages import Arc, copy_pose
from pyharness.prediction import Predictor
from pyharness.protocols import World
from pyharness.records import Waypoint
from pyharness.status import Activity
from pyharness.telemetry import Telemetry
from pyharness.thinker import Selection, Thinker, Verdict
from pyharness.wheels import Motion, Wheels


class Activities:
    """The computer, the images it has not merged yet, and the planner it asks."""

    def __init__(
        self,
        world: World,
        thinker: Thinker,
        wheels: Wheels,
        config: ExecutiveConfig,
        telemetry: Telemetry,
    ) -> None:
        """Start idle, with nothing seen."""
        self.computer = Computer(telemetry)
        self.predictor = Predictor(world, config.uncertainty)
        self.images = Images(world)
        self._world = world
        self._thinker = thinker
        self._wheels = wheels
        self._config = config
        self._telemetry = telemetry
        self._evaluate_at_s = math.inf

    # -------------------------------------------------------------- seeing

    def image_driving(self) -> None:
        """Take the image at the start of an arc; the rover need not stop for it."""
        now_s = self._world.time_s
        self.images.take(self._world.image)
        self._telemetry.activity(
            Activity.IMAGING, now_s, now_s + self._config.compute.imaging_s, self._wheels.arc
        )

    def look(self) -> bool:
        """Take an image ahead, standing."""
        return self._look(None)

    def look_around(self) -> bool:
        """Take images all around, standing."""
        return self._look(self._config.look_around_deg)

    def _look(self, azimuths_deg: Sequence[float] | None) -> bool:
        pair_count = 1 if azimuths_deg is None else len(azimuths_deg)
        self.images.take(lambda: self._world.image(azimuths_deg), pair_count)
        duration_s = pair_count * self._config.compute.imaging_s
        self.computer.occupy(Activity.IMAGING, duration_s, self.images.release)
        return True

    def process_disparity(self) -> bool:
        """Merge one image; there may be more."""
        released = self.images.released
        if released:
            duration_s = self._thinker.process(released.popleft())
            self.computer.occupy(Activity.PROCESS_DISPARITY, duration_s)
        return not released

    def merge_all(self) -> None:
        """Merge everything taken so far, at no cost in time."""
        self.images.release()
        while self.images.released:
            self._thinker.process(self.images.released.popleft())

    def fix_pose(self) -> bool:
        """Start VO; on an arc it waits for the middle."""
        is_driving = self._wheels.motion is Motion.DRIVING
        if is_driving and self._world.arc_fraction < self._config.vo_fraction:
            return False
        vo_s = self._config.compute.vo_s
        self.computer.occupy(Activity.VISUAL_ODOMETRY, vo_s, self._pose_fixed)
        return True

    def _pose_fixed(self) -> None:
        self._world.visual_odometry()
        self._telemetry.estimate(self.predictor.now())
        if self._wheels.motion is Motion.DRIVING:
            self.evaluate_soon()

    # -------------------------------------------------------------- planning

    def analyze_terrain(self, goal: Waypoint, zone_margin_m: float) -> bool:
        """Have the costmap recomputed for a goal, zones grown by a margin more than they must."""
        duration_s = self._thinker.analyze(
            self._world.time_s,
            copy_pose(self._world.estimate),
            goal,
            self.predictor.global_position_m(self._wheels.remaining) + zone_margin_m,
        )
        self.computer.occupy(Activity.ANALYZE_TERRAIN, duration_s)
        return True

    def select_arc(
        self,
        goal: Waypoint,
        margin_m: float,
        zone_margin_m: float,
        finish: Callable[[Selection], None],
    ) -> bool:
        """Select an arc from the pose predicted at the end of this one, with margins to spare."""
        pose, uncertainty = self.predictor.at_end(self._wheels.remaining)
        wider = replace(
            uncertainty,
            position_m=uncertainty.position_m + margin_m,
            global_position_m=uncertainty.global_position_m + zone_margin_m,
        )
        arc = self._wheels.arc
        selection, duration_s = self._thinker.select(self._world.time_s, pose, wider, goal, arc)
        self.computer.occupy(Activity.SELECT_ARC, duration_s, lambda: finish(selection), arc)
        return True

    # -------------------------------------------------------------- checking

    def evaluate_soon(self) -> None:
        """Let the arc being driven be evaluated now."""
        self._evaluate_at_s = self._world.time_s

    @property
    def is_evaluation_due(self) -> bool:
        """Whether the arc being driven is to be evaluated again."""
        return (
            not self.computer.is_busy
            and self._wheels.motion is Motion.DRIVING
            and self._world.time_s >= self._evaluate_at_s - TIME_TOLERANCE_S
            and 1.0 - self._world.arc_fraction >= self._config.evaluate_remaining_min
        )

    def evaluate_arc(
        self, arc: Arc, mode: str, finish: Callable[[Verdict], None], is_leaving: bool = False
    ) -> bool:
        """Have an arc from here evaluated; the next time is a period later."""
        now_s = self._world.time_s
        self._evaluate_at_s = now_s + self._config.evaluate_period_s
        verdict, duration_s = self._thinker.evaluate(
            now_s, copy_pose(self._world.estimate), self.predictor.now(), arc, mode, is_leaving
        )
        self.computer.occupy(Activity.EVALUATE_ARC, duration_s, lambda: finish(verdict), arc)
        return True
