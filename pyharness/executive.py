# SPDX-License-Identifier: Apache-2.0
"""Directed driving and Go To, thinking while driving (TWD, SIM Fig. 9).

Three state machines on one clock, the world's ticks: the wheels (`wheels`), the computer
(`computer`), and here the phase, which says where the next arc comes from:

    DIRECTED  a list of arcs, each evaluated before and while it is driven
    CRAWL     straight on and Unguarded, where the terrain under the rover is not known
    GO_TO     arcs that the planner selects, waypoint after waypoint

A planner call is made when its activity starts, with the data of that time; its answer counts when
the activity ends. In planning cycle k arc k is driven:

    start     a stereo pair is taken; the pair from the start of arc k - 1 is merged
    middle    VO, then analyze_terrain, then select_arc for the pose predicted at the end of arc k
    now and then, and after VO: evaluate_arc on what remains of arc k
    end       arc k + 1, after a stop if the wheels must be steered or thinking is late
"""

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from enum import Enum, auto

from pyharness.activities import Activities
from pyharness.computer import Task
from pyharness.course import Course
from pyharness.dp import Message
from pyharness.executive_config import ExecutiveConfig
from pyharness.faults import FaultError, SafetyWatch
from pyharness.messages import Arc, DirectedArc, copy_pose, distance_m, pose_after
from pyharness.protocols import World
from pyharness.records import Outcome, Sink, Waypoint
from pyharness.status import HostEvr, Reason
from pyharness.stuck import StuckWatch
from pyharness.telemetry import NO_ARC, Telemetry
from pyharness.thinker import (
    PlannerFaultError,
    Selection,
    Thinker,
    Verdict,
    describe_rejections,
)
from pyharness.wheels import Motion, Wheels

LENGTH_TOLERANCE_M = 1e-6
CRAWL_PIECE_MIN_M = 0.1
# after no path was found it goes closer to zones for some arcs: out of the margin, or along it
MARGIN_WAIVED_ARCS = 5
GOAL_RADIUS_M = 1.0  # about the end of a directed arc, towards which terrain is analyzed

# the modes that go on to another path when one is refused
REROUTING = ("avoid_koz", "avoid_all")


class Phase(Enum):
    """Where the next arc comes from."""

    DIRECTED = auto()
    CRAWL = auto()
    GO_TO = auto()


class Executive:
    """Drives a world with a planner along arcs and through waypoints."""

    def __init__(
        self,
        world: World,
        thinker: Thinker,
        arcs: Sequence[DirectedArc],
        waypoints: Sequence[Waypoint],
        config: ExecutiveConfig,
        safety: SafetyWatch,
        sink: Sink,
    ) -> None:
        """Stand at the start, wheels straight, with nothing seen and nothing planned."""
        self._world = world
        self._thinker = thinker
        self._config = config
        self._safety = safety
        self._telemetry = Telemetry(world, sink)
        self._course = Course(arcs, waypoints, self._telemetry)
        self._wheels = Wheels(world, self._telemetry)
        self._activities = Activities(world, thinker, self._wheels, config, self._telemetry)
        self._stuck = StuckWatch(config.stuck)

        self.outcome: Outcome | None = None
        self._phase = Phase.DIRECTED
        self._mode = ""  # in which the present arc is checked
        self._ahead = NO_ARC  # what of the directed arc comes after the piece under the wheels
        self._crawl_start = copy_pose(world.estimate)
        self._is_cleared = False  # whether the directed arc ahead has been evaluated
        self._selection: Selection | None = None
        self._is_leaving = False
        self._verdict = "nothing had been checked yet"
        self._unsafe_count = 0
        self._no_path_count = 0
        self._margin_waived_arcs = 0

    # -------------------------------------------------------------- from outside

    def start(self, zones: Message, prior_map_radius_m: float = 0.0) -> None:
        """Set the zones, take in what is known of the terrain around, begin."""
        with self._ending():
            self._thinker.set_zones(zones)
            self._telemetry.estimate(self._activities.predictor.now())
            if prior_map_radius_m > 0.0:
                self._activities.images.take(lambda: self._world.ground_around(prior_map_radius_m))
                self._activities.merge_all()
            self._next()

    def finish(self) -> Outcome:
        """Drive until everything is done or a fault ends the drive."""
        while self.outcome is None:
            self.advance()
        return self.outcome

    def advance(self) -> None:
        """Live through one tick of the world."""
        with self._ending():
            if self._is_arrived():
                self._end(Outcome("goal_reached"))
                return
            self._activities.computer.finish_job()
            self._move()
            if self.outcome is None:
                self._think()
                self._tick()

    def stop(self) -> None:
        """End the drive by command."""
        self._telemetry.event(HostEvr.STOPPED)
        self._end(Outcome("stopped", "by command"))

    def place(self, north_m: float, east_m: float, yaw_rad: float) -> None:
        """Set the rover down somewhere else and begin again with the arc or Go To it was at."""
        with self._ending():
            self._wheels.end()
            self._activities.computer.clear()
            self._activities.images.clear()
            self._world.place(north_m, east_m, yaw_rad)
            self._telemetry.event(HostEvr.PLACED, north_m, east_m, yaw_rad)
            self._stuck.new_goal()
            self._unsafe_count = self._no_path_count = 0
            self._next()

    def image_now(self) -> int:
        """Take an image and merge all that were taken; return the number of its points."""
        points_m = self._world.image()
        self._activities.images.take(lambda: points_m)
        self._activities.merge_all()
        return len(points_m)

    def evaluate(self, arc: Arc, mode: str, place: tuple[float, float, float] | None) -> Verdict:
        """Ask the planner about an arc from north, east and yaw, or from where the rover is.

        Raises:
            PlannerFaultError: The planner refuses, as it does before it has seen terrain.
        """
        pose = copy_pose(self._world.estimate)
        if place is not None:
            pose = replace(pose, x_m=place[0], y_m=place[1], yaw_rad=place[2])
        return self._thinker.evaluate(
            self._world.time_s, pose, self._activities.predictor.now(), arc, mode
        )[0]

    # -------------------------------------------------------------- ends

    @contextmanager
    def _ending(self) -> Iterator[None]:
        """Let a fault end the drive."""
        try:
            yield
        except FaultError as fault:
            self._fail(fault)
        except PlannerFaultError as error:
            self._fail(FaultError("planner_error", str(error)))

    def _fail(self, fault: FaultError) -> None:
        self._telemetry.event(fault.event, *fault.values)
        self._end(Outcome(fault.name, fault.detail))

    def _end(self, outcome: Outcome) -> None:
        """Stop the rover and whatever it was thinking about."""
        self._wheels.end()
        self._activities.computer.clear()
        self._telemetry.estimate(self._activities.predictor.now())
        self.outcome = outcome

    def _tick(self) -> None:
        """Advance the world and look at the true rover as operators would."""
        truth = self._world.step()
        self._telemetry.truth(truth)
        self._safety.check(truth, self._verdict)
        time_s = self._world.time_s
        if time_s >= self._config.time_limit_s:
            left_m = distance_m(self._world.estimate, self._goal)
            detail = f"{time_s:.0f} s, {left_m:.1f} m from the waypoint"
            raise FaultError("time_limit", detail, time_s, left_m)

    # -------------------------------------------------------------- where to

    @property
    def _goal(self) -> Waypoint:
        """The present waypoint; without any, the end of the directed arc."""
        waypoint = self._course.waypoint
        if waypoint is not None:
            return waypoint
        end = pose_after(copy_pose(self._world.estimate), self._arc_ahead)
        return Waypoint(end.x_m, end.y_m, GOAL_RADIUS_M, self._mode)

    def _is_arrived(self) -> bool:
        """Tick off the waypoints reached; was that the last?"""
        if self._phase is Phase.DIRECTED:
            return False
        while self._course.tick_off(self._world.estimate):
            self._stuck.new_goal()
        return self._course.waypoint is None

    def _next(self) -> None:
        """Turn to the next arc of the list, or to the waypoints after it."""
        directed = self._course.arc
        if directed is not None:
            self._phase, self._mode, self._ahead = Phase.DIRECTED, directed.mode, directed.arc
            self._is_cleared = False
            self._course.report_arc()
            self._stand(*self._look_and_analyze, self._evaluate_ahead)
        elif self._course.waypoint is not None:
            self._begin_go_to()
        else:
            self._end(Outcome("arcs_driven"))

    def _begin_go_to(self) -> None:
        """Look; then crawl where the terrain under the rover is not known, else plan."""
        self._phase, self._ahead = Phase.GO_TO, NO_ARC
        self._course.report_waypoint()
        next_task = self._check_map if self._config.crawl_length_m > 0.0 else self._select_arc
        self._stand(*self._look_and_analyze, next_task)

    def _map_checked(self, verdict: Verdict) -> None:
        if verdict.reason != Reason.UNKNOWN:
            self._telemetry.event(HostEvr.CRAWL_SKIPPED)
            self._activities.computer.plan([self._select_arc])
            return
        self._phase, self._mode = Phase.CRAWL, "unguarded"
        self._crawl_start = copy_pose(self._world.estimate)
        self._ahead, self._is_cleared = Arc(self._config.crawl_length_m, 0.0), False
        self._telemetry.event(HostEvr.CRAWL, self._config.crawl_length_m)
        self._activities.computer.plan([self._evaluate_ahead])

    def _crawl_on(self) -> None:
        """Go on until the rover believes that the crawl is long enough."""
        here, start = self._world.estimate, self._crawl_start
        moved_m = math.hypot(here.x_m - start.x_m, here.y_m - start.y_m)
        left_m = self._config.crawl_length_m - moved_m
        if left_m > LENGTH_TOLERANCE_M:
            self._ahead = Arc(max(left_m, CRAWL_PIECE_MIN_M), 0.0)
            self._begin_piece()
        else:
            self._phase, self._ahead = Phase.GO_TO, NO_ARC
            self._stand(*self._plan)

    # -------------------------------------------------------------- moving

    def _move(self) -> None:
        if self._wheels.is_arc_done:
            self._end_arc()
            self._unsafe_count = 0
            self._go_on()
        if self._wheels.drive_if_steered():
            self._driving_started()
        if self._wheels.motion is Motion.STANDING:
            self._leave_standing()

    def _go_on(self) -> None:
        """Turn to what comes after an arc that was driven to its end."""
        if self._phase is Phase.CRAWL:
            self._crawl_on()
        elif self._phase is Phase.DIRECTED:
            if self._ahead.is_empty:
                self._course.arc_driven()
                self._next()
            else:
                self._begin_piece()
        elif self._config.thinking == "standing":
            self._stand(*self._look_and_analyze, self._select_arc)

    def _leave_standing(self) -> None:
        """Drive the arc that was evaluated or selected, or think again where there is none."""
        if self._phase is not Phase.GO_TO:
            if self._is_cleared:
                self._is_cleared = False
                self._begin_piece()
            return
        selection, self._selection = self._selection, None
        if selection is None:
            if self._activities.computer.is_done:
                self._stand(*self._plan)
        elif selection.arc is None:
            self._no_path_found(selection)
        else:
            self._no_path_count = 0
            self._margin_waived_arcs = max(0, self._margin_waived_arcs - 1)
            self._telemetry.cycle += 1
            self._is_leaving, self._mode = selection.is_leaving, selection.mode
            self._verdict = f"select_arc had passed the arc in mode {selection.mode}"
            self._begin(selection.arc)

    def _no_path_found(self, selection: Selection) -> None:
        """Look around and try again, where the mode or unknown terrain gives hope."""
        self._no_path_count += 1
        if Reason.KIOZ in selection.rejections:
            self._margin_waived_arcs = MARGIN_WAIVED_ARCS
        is_unknown = Reason.UNKNOWN in selection.rejections
        if self._is_final(selection.mode, is_unknown, self._no_path_count):
            reason = selection.main_reason
            raise FaultError(
                "no_path",
                f"{_times(self._no_path_count)} in mode {selection.mode}; paths rejected:"
                f" {describe_rejections(selection.rejections)}",
                self._no_path_count,
                reason,
                selection.rejections.get(reason, 0),
            )
        self._telemetry.event(HostEvr.LOOKING_AROUND, self._no_path_count)
        do = self._activities
        self._stand(do.look_around, do.fix_pose, *self._plan)

    def _is_final(self, mode: str, is_unknown: bool, count: int) -> bool:
        """Whether a refusal ends the drive.

        Unguarded and Guarded know one path only; Guarded may look again at what was not seen.
        """
        may_retry = mode in REROUTING or (mode == "guarded" and is_unknown)
        return self._phase is not Phase.GO_TO or not may_retry or count > self._config.replans_max

    def _begin_piece(self) -> None:
        """Drive on along a directed arc, as far as to the next image."""
        whole = self._ahead
        length_m, spacing_m = abs(whole.length_m), self._config.image_spacing_m
        fraction = spacing_m / length_m if length_m > spacing_m + LENGTH_TOLERANCE_M else 1.0
        self._ahead = whole.part(1.0 - fraction)
        self._begin(whole.part(fraction))

    def _begin(self, arc: Arc) -> None:
        if self._wheels.begin(arc):
            self._driving_started()

    def _driving_started(self) -> None:
        do = self._activities
        self._stuck.start(self._world.estimate)
        do.images.release()
        do.evaluate_soon()
        tasks: list[Task] = []
        if self._phase is not Phase.GO_TO or self._config.thinking == "while_driving":
            do.image_driving()
            tasks = [do.process_disparity, do.fix_pose, self._analyze_terrain]
            if self._phase is Phase.GO_TO:
                tasks.append(self._select_arc)
        do.computer.plan(tasks)
        self._telemetry.estimate(do.predictor.now())

    def _end_arc(self) -> None:
        driven = self._wheels.end()
        here = self._world.estimate
        goal = None if self._phase is Phase.DIRECTED else self._goal
        reason = self._stuck.arc_finished(driven, here, goal)
        if reason is not None:
            raise FaultError("stuck", reason, here.x_m, here.y_m)

    def _stand(self, *tasks: Task) -> None:
        """Stand until the tasks are done, everything seen so far merged."""
        self._activities.images.release()
        self._selection = None
        self._activities.computer.plan(tasks)

    @property
    def _arc_ahead(self) -> Arc:
        """What is still to be driven, a directed arc to its end."""
        rest, ahead = self._wheels.remaining, self._ahead
        return Arc(
            rest.length_m + ahead.length_m, rest.heading_change_rad + ahead.heading_change_rad
        )

    # -------------------------------------------------------------- thinking

    def _think(self) -> None:
        """Give an idle computer its next task; the safety of the arc comes first."""
        if self._activities.is_evaluation_due:
            self._evaluate_driven()
        self._activities.computer.start_next()

    @property
    def _plan(self) -> tuple[Task, ...]:
        return self._activities.process_disparity, self._analyze_terrain, self._select_arc

    @property
    def _look_and_analyze(self) -> tuple[Task, ...]:
        do = self._activities
        return do.look, do.fix_pose, do.process_disparity, self._analyze_terrain

    def _analyze_terrain(self) -> bool:
        goal = self._goal
        return self._activities.analyze_terrain(goal, self._zone_margin_m(goal))

    def _zone_margin_m(self, goal: Waypoint) -> float:
        """Return what is kept from zones on top, where a mode plans round them."""
        is_kept = goal.mode in REROUTING and self._margin_waived_arcs == 0
        return self._config.uncertainty.zone_margin_m if is_kept else 0.0

    def _select_arc(self) -> bool:
        """Select for this waypoint, or for the next where this arc ends in the waydisc."""
        pose, _ = self._activities.predictor.at_end(self._wheels.remaining)
        goal = self._course.waypoint_from(pose)
        if goal is None:
            return True

        def finish(selection: Selection) -> None:
            self._selection = selection

        # after arcs that turned out unsafe it keeps more distance
        margin_m = self._unsafe_count * self._config.uncertainty.unsafe_margin_m
        return self._activities.select_arc(goal, margin_m, self._zone_margin_m(goal), finish)

    def _check_map(self) -> bool:
        """Is the terrain under the rover known? Guarded refuses a pose where it is not."""
        return self._activities.evaluate_arc(NO_ARC, "guarded", self._map_checked)

    def _evaluate_ahead(self) -> bool:
        """Check a directed arc before it is driven."""

        def finish(verdict: Verdict) -> None:
            self._arc_evaluated(verdict)
            self._is_cleared = True

        return self._activities.evaluate_arc(self._arc_ahead, self._mode, finish)

    def _evaluate_driven(self) -> None:
        """Check what is left of the arc being driven."""
        cycle = self._telemetry.cycle

        def finish(verdict: Verdict) -> None:
            if self._wheels.motion is Motion.DRIVING and self._telemetry.cycle == cycle:
                self._arc_evaluated(verdict)

        is_leaving = self._phase is Phase.GO_TO and self._is_leaving
        self._activities.evaluate_arc(self._arc_ahead, self._mode, finish, is_leaving)

    def _arc_evaluated(self, verdict: Verdict) -> None:
        """Stop on an unsafe arc and plan another, where the phase and the mode allow one."""
        self._verdict = verdict.text
        if verdict.is_safe:
            return
        self._unsafe_count += 1
        count, reason = self._unsafe_count, verdict.reason
        if self._is_final(self._mode, reason == Reason.UNKNOWN, count):
            detail = f"{_times(count)} in mode {self._mode}; {verdict.text}"
            raise FaultError("unsafe_arc", detail, count, reason, verdict.failing_at)
        self._telemetry.event(HostEvr.ARC_STOPPED, self._world.arc_fraction, reason, count)
        self._end_arc()
        self._stand(*self._look_and_analyze, self._select_arc)


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times in a row"
