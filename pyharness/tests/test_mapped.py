# SPDX-License-Identifier: Apache-2.0
"""What every planner does that reads Navlib's maps."""

import numpy as np
import pytest

from pyharness.dp import Kind, new_message
from pyharness.planners.gestalt import Gestalt
from pyharness.planners.rrtsharp import RrtSharp
from pyharness.status import Reason, Status
from pyharness.tests.planner_scene import Scene, rocks

PLANNERS = pytest.mark.parametrize("planner_class", [Gestalt, RrtSharp])

WALL = rocks((3.0, 0.0, 0.4, 0.6))


@PLANNERS
def test_on_level_ground_the_rover_drives_a_metre_towards_the_goal(planner_class):
    answer = Scene(planner_class, rocks()).analyze().select()
    assert answer["status"] == Status.OK
    assert answer["arc"]["length_m"] == pytest.approx(1.0, abs=0.01)
    assert abs(answer["arc"]["heading_change_rad"]) < 0.2


@PLANNERS
def test_a_goal_behind_makes_the_rover_turn_or_back_up(planner_class):
    answer = Scene(planner_class, rocks(), goal_m=(-30.0, 0.0)).analyze().select()
    assert answer["status"] == Status.OK
    assert answer["arc"]["length_m"] <= 0.0


@PLANNERS
def test_no_selected_arc_is_called_unsafe_a_moment_later(planner_class):
    for seed in range(5):
        scene = Scene(planner_class, WALL, seed=seed).analyze()
        arc = scene.select()["arc"]
        length_m, heading_rad = float(arc["length_m"]), float(arc["heading_change_rad"])
        assert scene.evaluate(length_m, heading_rad)["is_safe"]


@PLANNERS
@pytest.mark.parametrize(("mode", "is_safe"), [("unguarded", 1), ("guarded", 0), ("avoid_koz", 1),
                                               ("avoid_all", 0)])  # fmt: skip
def test_the_mode_decides_whether_a_rock_makes_an_arc_unsafe(planner_class, mode, is_safe):
    answer = Scene(planner_class, WALL).analyze().evaluate(3.0, mode=mode)
    assert answer["is_safe"] == is_safe
    if not is_safe:
        assert answer["reason"] in (Reason.WHEEL_DROP, Reason.CLEARANCE)
        assert 0.0 < answer["failing_at"] <= 3.0


@PLANNERS
def test_a_zone_forbids_an_arc_in_every_mode(planner_class):
    scene = Scene(planner_class, rocks())
    scene.forbid(2.0, 0.0, 0.8)
    scene.analyze()
    for mode in ("unguarded", "guarded", "avoid_koz", "avoid_all"):
        answer = scene.evaluate(2.0, mode=mode)
        assert (answer["is_safe"], answer["reason"]) == (0, Reason.KIOZ), mode


@PLANNERS
def test_modes_without_avoidance_refuse_where_the_others_go_round(planner_class):
    scene = Scene(planner_class, rocks())
    scene.forbid(1.3, 0.0, 0.9)
    scene.analyze()
    assert scene.select("unguarded")["status"] == Status.NO_PATH
    assert scene.select("guarded")["status"] == Status.NO_PATH
    assert scene.select("avoid_koz")["status"] == Status.OK
    assert scene.select("avoid_all")["status"] == Status.OK


@PLANNERS
def test_a_call_before_the_first_analysis_is_refused(planner_class):
    scene = Scene(planner_class, rocks())
    assert scene.select()["status"] == Status.ORDER
    assert scene.evaluate(1.0)["status"] == Status.ORDER


@PLANNERS
def test_every_call_is_recorded_once_and_navlibs_start_with_it(planner_class):
    scene = Scene(planner_class, rocks())
    assert scene.records[0].kind == Kind.INIT_IN
    scene.records.clear()
    scene.analyze()
    scene.select()
    scene.evaluate(1.0)
    kinds = [record.kind for record in scene.records if record.kind != Kind.EVR]
    assert kinds == [
        Kind.ANALYZE_TERRAIN_IN, Kind.ANALYZE_TERRAIN_OUT, Kind.SELECT_ARC_IN,
        Kind.SELECT_ARC_OUT, Kind.EVALUATE_ARC_IN, Kind.EVALUATE_ARC_OUT,
    ]  # fmt: skip


@PLANNERS
def test_the_same_seed_selects_the_same_arc(planner_class):
    first, second = (Scene(planner_class, WALL, seed=4).analyze().select() for _ in range(2))
    assert first.tobytes() == second.tobytes()


@PLANNERS
def test_an_arc_of_the_greatest_length_fits_the_answer(planner_class):
    answer = Scene(planner_class, rocks()).analyze().evaluate(10.0)
    assert answer["status"] == Status.OK
    assert answer["pose_count"] <= len(new_message(Kind.EVALUATE_ARC_OUT)["bounds"])


@PLANNERS
def test_a_turn_in_place_is_safe_where_the_rover_stands(planner_class):
    assert Scene(planner_class, rocks((1.0, 0.0, 0.2, 0.5))).analyze().evaluate(0.0, 1.0)["is_safe"]


def test_heights_are_those_of_the_cloud_and_unknown_elsewhere():
    def ground(north_m, east_m):
        return np.where(east_m > -5.0, -0.1 * north_m, np.nan)

    heights = Scene(Gestalt, ground).analyze().planner._heights()
    row, col = int(4.0 / 0.1) - heights.first_row, int(2.0 / 0.1) - heights.first_col
    assert heights.z_m[row, col] == pytest.approx(-0.405, abs=0.006)
    assert np.isnan(heights.z_m[row, int(-8.0 / 0.1) - heights.first_col])
