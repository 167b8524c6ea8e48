# SPDX-License-Identifier: Apache-2.0
"""The executive's calls to the planner: each answers, and says how long the rover thinks."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from pyharness import messages
from pyharness.dp import Message
from pyharness.executive_config import ComputeTimes
from pyharness.messages import Arc, Pose6, Uncertainty
from pyharness.planner import Planner
from pyharness.records import Waypoint
from pyharness.status import Reason, Status, status_text


class PlannerFaultError(Exception):
    """The planner failed, or refused a call it should have taken."""


@dataclass(frozen=True, slots=True)
class Image:
    """A point cloud in the rover frame of the pose believed when it was taken."""

    image_id: int
    time_s: float
    pose: Pose6
    points_m: npt.NDArray[np.float32]
    pair_count: int


@dataclass(frozen=True, slots=True)
class Selection:
    """What select_arc answered.

    Attributes:
        arc: What to drive next; None when no path was found.
        rejections: How many candidates were rejected, by reason.
        mode: In which it was selected.
        is_leaving: Whether only the leave limits let a path pass.
    """

    arc: Arc | None
    rejections: Mapping[Reason, int]
    mode: str
    is_leaving: bool = False

    @property
    def main_reason(self) -> Reason:
        """The most frequent reason, cost aside."""
        return max(
            (reason for reason in self.rejections if reason != Reason.COST),
            key=lambda reason: self.rejections[reason],
            default=Reason.NONE,
        )


@dataclass(frozen=True, slots=True)
class Verdict:
    """What evaluate_arc answered; when unsafe, why and how far along, m or rad."""

    is_safe: bool
    text: str
    reason: Reason = Reason.NONE
    failing_at: float = 0.0


@dataclass(frozen=True, slots=True)
class Thinker:
    """Asks the planner in its records, and turns refusals into faults."""

    planner: Planner
    times: ComputeTimes

    def set_zones(self, request: Message) -> None:
        """Have the keep-in and keep-out zones replaced."""
        self._ask(self.planner.set_kioz, "set_kioz", request)

    def process(self, image: Image) -> float:
        """Have one image merged; return the compute time."""
        requests = messages.cloud_requests(image.time_s, image.pose, image.image_id, image.points_m)
        for request in requests:
            self._ask(self.planner.process_disparity, "process_disparity", request)
        return image.pair_count * self.times.process_disparity_s

    def analyze(
        self, time_s: float, pose: Pose6, goal: Waypoint, global_position_m: float
    ) -> float:
        """Have the costmap recomputed; return the compute time."""
        request = messages.analyze_request(time_s, pose, goal, global_position_m)
        self._ask(self.planner.analyze_terrain, "analyze_terrain", request)
        return self.times.analyze_terrain_s

    def select(
        self, time_s: float, pose: Pose6, uncertainty: Uncertainty, goal: Waypoint, driven: Arc
    ) -> tuple[Selection, float]:
        """Have the next arc selected; return it and the compute time."""
        request = messages.select_request(time_s, pose, uncertainty, goal, driven)
        accepted = (Status.OK, Status.NO_PATH)
        answer = self._ask(self.planner.select_arc, "select_arc", request, accepted)
        duration_s = self.times.select_base_s
        duration_s += self.times.select_per_evaluation_s * int(answer["ace_evaluations"])
        rejections = rejections_of(answer)
        if answer["status"] == Status.NO_PATH:
            return Selection(None, rejections, goal.mode), duration_s
        arc = Arc(float(answer["arc"]["length_m"]), float(answer["arc"]["heading_change_rad"]))
        if arc.is_empty or not math.isfinite(arc.length_m + arc.heading_change_rad):
            raise PlannerFaultError(f"select_arc answered an arc that leads nowhere: {arc}")
        return Selection(arc, rejections, goal.mode, bool(answer["is_leaving"])), duration_s

    def evaluate(
        self,
        time_s: float,
        pose: Pose6,
        uncertainty: Uncertainty,
        arc: Arc,
        mode: str,
        is_leaving: bool = False,
    ) -> tuple[Verdict, float]:
        """Have an arc evaluated; return the verdict and the compute time."""
        request = messages.evaluate_request(time_s, pose, uncertainty, arc, mode, is_leaving)
        answer = self._ask(self.planner.evaluate_arc, "evaluate_arc", request)
        duration_s = self.times.evaluate_base_s
        duration_s += self.times.evaluate_per_pose_s * int(answer["pose_count"])
        if answer["is_safe"]:
            return Verdict(
                True, f"evaluate_arc at {time_s:.3f} s in mode {mode} said safe"
            ), duration_s
        reason, failing_at = Reason(int(answer["reason"])), float(answer["failing_at"])
        text = (
            f"evaluate_arc at {time_s:.3f} s in mode {mode} said unsafe: {reason.name.lower()}"
            f" at pose {int(answer['failing_index'])}, {failing_at:.2f} m or rad along"
        )
        return Verdict(False, text, reason, failing_at), duration_s

    @staticmethod
    def _ask(
        call: Callable[[Message], Message],
        name: str,
        request: Message,
        accepted: Sequence[int] = (Status.OK,),
    ) -> Message:
        try:
            answer = call(request)
            status = int(answer["status"])
        except Exception as error:
            raise PlannerFaultError(f"{name} failed: {error!r}") from error
        if status not in accepted:
            raise PlannerFaultError(f"{name} refused: {status_text(status)}")
        return answer


def rejections_of(answer: Message) -> dict[Reason, int]:
    """Return how many candidates an answer of select_arc rejected, by the reasons that occurred."""
    return {
        reason: int(answer["rejections"][reason])
        for reason in Reason
        if reason != Reason.NONE and answer["rejections"][reason]
    }


def describe_rejections(rejections: Mapping[Reason, int]) -> str:
    """Return `reason count, ...`, the most frequent first."""
    ranked = sorted((-count, reason.name.lower()) for reason, count in rejections.items())
    return ", ".join(f"{name} {-count}" for count, name in ranked) or "none"
