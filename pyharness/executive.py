# SPDX-License-Identifier: Apache-2.0
"""Go To while thinking (TWD, SIM Fig. 9): two state machines on one clock.

The rover stands, steers or drives; its one computer works through a queue of activities. Both are
looked at once per tick of the world, which is the only clock. A planner call is made when its
activity starts, with the data of that time; its answer counts when the activity ends.

Phases: a crawl straight ahead that is not checked, then planning cycles; in between the rover
stands where it has to look and think before it may move. In planning cycle k arc k is driven:

    start     a stereo pair is taken; the pair from the start of arc k - 1 is merged
    middle    VO, then analyze_terrain, then select_arc for the pose predicted at the end of arc k
    now and then, and after VO: evaluate_arc on what remains of arc k
    end       arc k + 1, after a stop if the wheels must be steered or thinking is late
"""

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum, auto

import numpy as np
import numpy.typing as npt

from pyharness import messages
from pyharness.dp import Kind, Message, used_bytes
from pyharness.executive_config import ExecutiveConfig
from pyharness.messages import Arc, Uncertainty, copy_pose, distance_m, pose_after
from pyharness.protocols import Truth, World
from pyharness.records import Outcome, Sink, Waypoint
from pyharness.status import Activity
from pyharness.stuck import StuckWatch
from pyharness.thinker import (
    Image,
    PlannerFaultError,
    Selection,
    Thinker,
    Verdict,
    planning_uncertainty,
)

LENGTH_MIN_M = 1e-6
TIME_TOLERANCE_S = 1e-9

PLAN = (Activity.PROCESS_DISPARITY, Activity.ANALYZE_TERRAIN, Activity.SELECT_ARC)
LOOK_AND_PLAN = (Activity.IMAGING, Activity.VISUAL_ODOMETRY, *PLAN)
CRAWL_CYCLE = (Activity.PROCESS_DISPARITY, Activity.VISUAL_ODOMETRY)
PLANNING_CYCLE = (*CRAWL_CYCLE, Activity.ANALYZE_TERRAIN, Activity.SELECT_ARC)

ARC_ACTIVITIES = (
    Activity.SELECT_ARC,
    Activity.EVALUATE_ARC,
    Activity.STEERING,
    Activity.DRIVING,
)


class Motion(Enum):
    """What the wheels do."""

    STANDING = auto()
    STEERING = auto()
    DRIVING = auto()


@dataclass(frozen=True, slots=True)
class SafetyWatch:
    """What operators would call a fault of the true rover.

    Attributes:
        limit_violation: Names the limit a truth violates, with value and limit; None if it is well.
        is_forbidden: Whether a true position, north and east, violates a zone.
    """

    limit_violation: Callable[[Truth], str | None]
    is_forbidden: Callable[[float, float], bool]


@dataclass(frozen=True, slots=True)
class Job:
    """What the computer is busy with; `finish` makes its result count."""

    end_s: float
    finish: Callable[[], None]


@dataclass(slots=True)
class Images:
    """Images not merged yet: those of the arc being driven wait for the next one."""

    taken_count: int = 0
    released: deque[Image] = field(default_factory=deque)
    newest: list[Image] = field(default_factory=list)

    def release(self) -> None:
        """Let everything taken so far be merged."""
        self.released.extend(self.newest)
        self.newest.clear()


class _FaultError(Exception):
    """Ends a drive; its arguments are the fault's name and the details."""


class Executive:
    """Drives a world with a planner through waypoints."""

    def __init__(
        self,
        world: World,
        look_around: Callable[[], npt.NDArray[np.float32]],
        thinker: Thinker,
        waypoints: Sequence[Waypoint],
        config: ExecutiveConfig,
        safety: SafetyWatch,
        sink: Sink,
    ) -> None:
        """Stand at the start, wheels straight, with nothing seen and nothing planned."""
        self._world = world
        self._look_around = look_around
        self._thinker = thinker
        self._waypoints = waypoints
        self._config = config
        self._safety = safety
        self._sink = sink

        self._waypoint_index = 0
        self._cycle = 0
        self._motion = Motion.STANDING
        self._motion_start_s = world.time_s
        self._steering_end_s = 0.0
        self._arc = Arc(0.0, 0.0)
        self._crawl_left_m = config.crawl_length_m
        self._driven_m = 0.0  # commanded path of the arcs before this one
        self._fixed_m = 0.0  # commanded path at the last VO fix

        self._images = Images()
        self._queue: deque[int] = deque()
        self._job: Job | None = None
        self._is_look_around_due = False
        self._selection: Selection | None = None
        self._is_leaving = False
        self._evaluate_at_s = math.inf
        self._verdict = "nothing had been checked yet"
        self._unsafe_count = 0
        self._no_path_count = 0
        self._stuck = StuckWatch(config.stuck)

    def run(self, zones: Message) -> Outcome:
        """Set the zones and drive until the last waypoint is reached or a fault ends the drive."""
        try:
            self._thinker.set_zones(zones)
            self._publish_estimate()
            if self._is_crawling:
                self._begin_crawl_arc()
            else:
                self._stand(LOOK_AND_PLAN)
            while not self._is_arrived():
                self._finish_job()
                self._move()
                self._start_job()
                self._tick()
            outcome = Outcome("goal_reached")
        except _FaultError as fault:
            outcome = Outcome(*fault.args)
        except PlannerFaultError as error:
            outcome = Outcome("planner_error", str(error))
        self._close_motion()
        self._publish_estimate()
        return outcome

    def _tick(self) -> None:
        """Advance the world and look at the true rover as operators would."""
        truth = self._world.step()
        time_s = self._world.time_s
        self._publish(Kind.TRUTH, messages.truth_record(time_s, truth))
        place = f"true position north {truth.x_m:.2f} m, east {truth.y_m:.2f} m"
        if not truth.on_map:
            raise _FaultError("left_map", place)
        violation = self._safety.limit_violation(truth)
        if violation is not None:
            raise _FaultError("limit_violation", f"{violation}; {place}; {self._verdict}")
        if self._safety.is_forbidden(truth.x_m, truth.y_m):
            raise _FaultError("kioz_violation", f"{place}; {self._verdict}")
        if time_s >= self._config.time_limit_s:
            left_m = distance_m(self._world.estimate, self._goal)
            raise _FaultError("time_limit", f"{time_s:.0f} s, {left_m:.1f} m from the waypoint")

    def _is_arrived(self) -> bool:
        """Tick off the waypoints reached; was that the last?"""
        while distance_m(self._world.estimate, self._goal) <= self._goal.radius_m:
            if self._waypoint_index == len(self._waypoints) - 1:
                return True
            self._waypoint_index += 1
            self._stuck.new_goal()
        return False

    @property
    def _goal(self) -> Waypoint:
        return self._waypoints[self._waypoint_index]

    # -------------------------------------------------------------- moving

    def _move(self) -> None:
        if self._motion is Motion.DRIVING and self._world.arc_done:
            self._end_arc(1.0)
            if self._is_crawling:
                self._crawl_on()
        if self._motion is Motion.STEERING and self._is_past(self._steering_end_s):
            self._drive()
        if self._motion is Motion.STANDING:
            self._leave_standing()

    def _begin_crawl_arc(self) -> None:
        self._begin_arc(Arc(min(self._config.crawl_arc_length_m, self._crawl_left_m), 0.0))

    def _crawl_on(self) -> None:
        self._crawl_left_m -= self._arc.length_m
        if self._is_crawling:
            self._begin_crawl_arc()
        else:
            self._stand(PLAN)

    @property
    def _is_crawling(self) -> bool:
        return self._crawl_left_m > LENGTH_MIN_M

    def _leave_standing(self) -> None:
        """Drive the selected arc, or think again where there is none."""
        selection, self._selection = self._selection, None
        if selection is None:
            if self._job is None and not self._queue:
                self._stand(PLAN)
        elif selection.arc is None:
            self._no_path_found(selection)
        else:
            self._no_path_count = 0
            self._cycle += 1
            self._is_leaving = selection.is_leaving
            self._verdict = f"select_arc had passed the arc in mode {self._goal.mode}"
            self._begin_arc(selection.arc)

    def _no_path_found(self, selection: Selection) -> None:
        self._no_path_count += 1
        if self._no_path_count > self._config.replans_max:
            raise _FaultError(
                "no_path",
                f"{self._no_path_count} times in a row; paths rejected: {selection.rejections}",
            )
        self._is_look_around_due = True
        self._stand(LOOK_AND_PLAN)

    def _begin_arc(self, arc: Arc) -> None:
        """Steer where the wheels stand differently, else drive at once."""
        steering_s = self._world.steering_duration_s(self._arc.curvature_per_m, arc.curvature_per_m)
        self._close_motion()
        self._arc = arc
        if steering_s > 0.0:
            self._motion = Motion.STEERING
            self._steering_end_s = self._world.time_s + steering_s
        else:
            self._drive()

    def _drive(self) -> None:
        now_s = self._world.time_s
        self._close_motion()
        self._motion = Motion.DRIVING
        self._world.start_arc(self._arc.length_m, self._arc.heading_change_rad)
        self._stuck.start(self._world.estimate)
        self._images.release()
        self._take_image(self._world.image(), 1)
        self._publish_activity(Activity.IMAGING, now_s, now_s + self._config.compute.imaging_s)
        self._publish_estimate()
        if self._is_crawling:
            self._verdict = "the first crawl is driven unchecked"
            self._queue = deque(CRAWL_CYCLE)
        else:
            self._queue = deque(PLANNING_CYCLE)
            self._evaluate_at_s = now_s

    def _end_arc(self, fraction: float) -> None:
        """Close an arc that was driven to the given fraction."""
        driven = self._arc.part(fraction)
        self._close_motion()
        self._evaluate_at_s = math.inf
        self._driven_m += abs(driven.length_m)
        reason = self._stuck.arc_finished(driven, self._world.estimate, self._goal)
        if reason is not None:
            raise _FaultError("stuck", reason)
        if fraction == 1.0:
            self._unsafe_count = 0

    def _stand(self, activities: Sequence[int]) -> None:
        """Stand until the activities are done, everything seen so far merged."""
        self._images.release()
        self._selection = None
        self._queue = deque(activities)

    def _close_motion(self) -> None:
        """Report what the wheels did until now; from now on the rover stands."""
        now_s = self._world.time_s
        activity = {
            Motion.STANDING: Activity.WAITING,
            Motion.STEERING: Activity.STEERING,
            Motion.DRIVING: Activity.DRIVING,
        }[self._motion]
        if now_s > self._motion_start_s:
            self._publish_activity(activity, self._motion_start_s, now_s)
        self._motion = Motion.STANDING
        self._motion_start_s = now_s

    def _is_past(self, time_s: float) -> bool:
        return self._world.time_s >= time_s - TIME_TOLERANCE_S

    # -------------------------------------------------------------- thinking

    def _finish_job(self) -> None:
        job = self._job
        if job is not None and self._is_past(job.end_s):
            self._job = None
            job.finish()

    def _start_job(self) -> None:
        """Give an idle computer its next activity, if there is one that can start."""
        if self._job is not None:
            return
        if self._is_evaluation_due():
            self._evaluate_arc()
            return
        if (
            self._queue
            and self._queue[0] == Activity.PROCESS_DISPARITY
            and not self._images.released
        ):
            self._queue.popleft()
        if self._queue and self._is_ready(self._queue[0]):
            self._start(self._queue[0])

    def _is_ready(self, activity: int) -> bool:
        """VO waits for the middle of the arc; everything else can start."""
        return (
            activity != Activity.VISUAL_ODOMETRY
            or self._motion is not Motion.DRIVING
            or self._world.arc_fraction >= self._config.vo_fraction
        )

    def _start(self, activity: int) -> None:
        starts = {
            Activity.IMAGING: self._look,
            Activity.VISUAL_ODOMETRY: self._fix_pose,
            Activity.PROCESS_DISPARITY: self._process_disparity,
            Activity.ANALYZE_TERRAIN: self._analyze_terrain,
            Activity.SELECT_ARC: self._select_arc,
        }
        starts[activity]()

    def _occupy(self, activity: int, duration_s: float, finish: Callable[[], None]) -> None:
        """Keep the computer busy; the activity leaves the queue when it is done."""
        now_s = self._world.time_s
        self._job = Job(now_s + duration_s, finish)
        self._publish_activity(activity, now_s, now_s + duration_s)

    def _look(self) -> None:
        """Take images standing: ahead, or all around after no path was found."""
        self._queue.popleft()
        if self._is_look_around_due:
            pair_count, points_m = len(self._config.look_around_deg), self._look_around()
        else:
            pair_count, points_m = 1, self._world.image()
        self._is_look_around_due = False
        self._take_image(points_m, pair_count)
        duration_s = pair_count * self._config.compute.imaging_s
        self._occupy(Activity.IMAGING, duration_s, self._images.release)

    def _take_image(self, points_m: npt.NDArray[np.float32], pair_count: int) -> None:
        self._images.taken_count += 1
        pose = copy_pose(self._world.estimate)
        self._images.newest.append(
            Image(self._images.taken_count, self._world.time_s, pose, points_m, pair_count)
        )

    def _process_disparity(self) -> None:
        image = self._images.released.popleft()
        if not self._images.released:
            self._queue.popleft()
        duration_s = self._thinker.process(image)
        self._occupy(Activity.PROCESS_DISPARITY, duration_s, _nothing)

    def _fix_pose(self) -> None:
        self._queue.popleft()
        self._occupy(Activity.VISUAL_ODOMETRY, self._config.compute.vo_s, self._pose_fixed)

    def _pose_fixed(self) -> None:
        if self._world.visual_odometry():
            self._fixed_m = self._driven_m + abs(self._driven_part.length_m)
        self._publish_estimate()
        if self._motion is Motion.DRIVING and not self._is_crawling:
            self._evaluate_at_s = self._world.time_s

    def _analyze_terrain(self) -> None:
        self._queue.popleft()
        estimate = self._world.estimate
        duration_s = self._thinker.analyze(
            self._world.time_s,
            copy_pose(estimate),
            self._goal,
            self._config.uncertainty.global_sigmas * estimate.sigma_position_m,
        )
        self._occupy(Activity.ANALYZE_TERRAIN, duration_s, _nothing)

    def _select_arc(self) -> None:
        """Select from the pose predicted at the end of this arc, unless that is the last goal."""
        self._queue.popleft()
        remaining = self._remaining_part
        pose = pose_after(copy_pose(self._world.estimate), remaining)
        goal = self._goal
        if distance_m(pose, goal) <= goal.radius_m:
            following = self._waypoints[self._waypoint_index + 1 :]
            if not following:
                return
            goal = following[0]
        selection, duration_s = self._thinker.select(
            self._world.time_s,
            pose,
            self._selection_uncertainty(abs(remaining.length_m)),
            goal,
            self._arc,
        )

        def finish() -> None:
            self._selection = selection

        self._occupy(Activity.SELECT_ARC, duration_s, finish)

    def _is_evaluation_due(self) -> bool:
        return (
            self._motion is Motion.DRIVING
            and self._is_past(self._evaluate_at_s)
            and 1.0 - self._world.arc_fraction >= self._config.evaluate_remaining_min
        )

    def _evaluate_arc(self) -> None:
        now_s = self._world.time_s
        self._evaluate_at_s = now_s + self._config.evaluate_period_s
        verdict, duration_s = self._thinker.evaluate(
            now_s,
            copy_pose(self._world.estimate),
            self._uncertainty(0.0),
            self._remaining_part,
            self._goal.mode,
            self._is_leaving,
        )
        cycle = self._cycle

        def finish() -> None:
            if self._motion is Motion.DRIVING and self._cycle == cycle:
                self._arc_evaluated(verdict)

        self._occupy(Activity.EVALUATE_ARC, duration_s, finish)

    def _arc_evaluated(self, verdict: Verdict) -> None:
        self._verdict = verdict.text
        if verdict.is_safe:
            return
        self._unsafe_count += 1
        if self._unsafe_count > self._config.replans_max:
            raise _FaultError("unsafe_arc", f"{self._unsafe_count} times in a row; {verdict.text}")
        fraction = self._world.arc_fraction
        self._world.stop()
        self._end_arc(fraction)
        self._stand(LOOK_AND_PLAN)

    # -------------------------------------------------------------- where the rover is

    @property
    def _driven_part(self) -> Arc:
        """What has been driven of the arc under the wheels."""
        fraction = self._world.arc_fraction if self._motion is Motion.DRIVING else 0.0
        return self._arc.part(fraction)

    @property
    def _remaining_part(self) -> Arc:
        """What is still to be driven of it; nothing when the rover stands."""
        fraction = self._world.arc_fraction if self._motion is Motion.DRIVING else 1.0
        return self._arc.part(1.0 - fraction)

    def _selection_uncertainty(self, remaining_m: float) -> Uncertainty:
        uncertainty = self._uncertainty(remaining_m)
        margin_m = self._unsafe_count * self._config.uncertainty.unsafe_margin_m
        return replace(uncertainty, position_m=uncertainty.position_m + margin_m)

    def _uncertainty(self, remaining_m: float) -> Uncertainty:
        since_fix_m = self._driven_m + abs(self._driven_part.length_m) - self._fixed_m
        return planning_uncertainty(
            self._config.uncertainty, self._world.estimate, since_fix_m, remaining_m
        )

    # -------------------------------------------------------------- records

    def _publish(self, kind: int, record: Message) -> None:
        self._sink(kind, self._world.time_s, used_bytes(kind, record))

    def _publish_estimate(self) -> None:
        record = messages.estimate_record(
            self._world.time_s, self._world.estimate, self._uncertainty(0.0)
        )
        self._publish(Kind.ESTIMATE, record)

    def _publish_activity(self, activity: int, start_s: float, end_s: float) -> None:
        has_arc = activity in ARC_ACTIVITIES
        arc = self._arc if has_arc else Arc(0.0, 0.0)
        record = messages.timeline_record(activity, start_s, end_s, self._cycle, arc)
        self._publish(Kind.TIMELINE, record)


def _nothing() -> None:
    """Finish an activity whose result is already in the planner."""
