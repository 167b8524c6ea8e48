# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

from pyharness.executive_config import StuckRules
from pyharness.messages import Arc, Pose6
from pyharness.records import Waypoint
from pyharness.stuck import StuckWatch

START = Pose6(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
GOAL = Waypoint(1000.0, 0.0, 1.0, "avoid_all")


def drive(watch, moves, arc=None):
    """Drive arcs of 1 m that move the rover as told; return the first reason."""
    pose = START
    for north_m, east_m in moves:
        watch.start(pose)
        pose = replace(pose, x_m=pose.x_m + north_m, y_m=pose.y_m + east_m)
        if reason := watch.arc_finished(arc or Arc(1.0, 0.0), pose, GOAL):
            return reason
    return None


def test_a_rover_that_moves_is_not_stuck():
    assert drive(StuckWatch(StuckRules()), [(0.9, 0.0)] * 200) is None


def test_one_bad_arc_is_forgiven():
    assert drive(StuckWatch(StuckRules()), [(1.0, 0.0), (0.0, 0.0)] * 50) is None


def test_wheels_that_dig_in_are_noticed():
    reason = drive(StuckWatch(StuckRules()), [(1.0, 0.0)] * 9 + [(0.1, 0.0)] * 9)
    assert "of commanded path" in reason


def test_circling_is_noticed():
    square = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]
    assert "without coming nearer" in drive(StuckWatch(StuckRules()), square * 60)


def test_turning_in_place_for_ever_is_noticed():
    reason = drive(StuckWatch(StuckRules()), [(0.0, 0.0)] * 600, Arc(0.0, 0.5))
    assert "without coming nearer" in reason


def test_a_new_goal_gives_new_patience():
    watch = StuckWatch(StuckRules(progress_window_m=10.0))
    for _ in range(5):
        assert drive(watch, [(1.0, 0.0), (-1.0, 0.0)] * 4) is None
        watch.new_goal()
