# SPDX-License-Identifier: Apache-2.0
import math

import numpy as np
import pytest

from pyharness.messages import Pose6
from pyharness.planner import own_param_values
from pyharness.planners.arcs import Place
from pyharness.planners.gestalt import (
    Gestalt,
    cut_out,
    falling_votes,
    first_reasons,
    make_candidates,
)
from pyharness.planners.goodness import Heights
from pyharness.status import Reason, Status
from pyharness.tests.planner_scene import Scene, rocks


def test_a_rock_ahead_is_driven_round():
    answer = Scene(Gestalt, rocks((3.5, 0.3, 0.3, 0.5))).analyze().select()
    assert answer["status"] == Status.OK
    assert answer["arc"]["heading_change_rad"] < -0.05
    assert answer["rejections"][Reason.WHEEL_DROP] > 0


def test_a_rock_that_no_wheel_would_mind_is_driven_over():
    answer = Scene(Gestalt, rocks((3.5, 0.0, 0.2, 0.05))).analyze().select()
    assert answer["arc"]["length_m"] == pytest.approx(1.0)
    assert abs(answer["arc"]["heading_change_rad"]) < 0.15


def test_a_ring_of_rocks_leaves_no_path():
    angles_rad = np.linspace(0.0, 2.0 * math.pi, 16, endpoint=False)
    ring = [(2.8 * math.cos(a), 2.8 * math.sin(a), 0.2, 0.5) for a in angles_rad]
    answer = Scene(Gestalt, rocks(*ring)).analyze().select()
    assert answer["status"] == Status.NO_PATH
    assert answer["rejections"][Reason.WHEEL_DROP] == answer["paths_tested"]
    assert (answer["arc"]["length_m"], answer["arc"]["heading_change_rad"]) == (0.0, 0.0)


def test_rocks_in_the_middle_of_the_goals_disc_do_not_matter():
    scene = Scene(Gestalt, rocks((5.0, 0.0, 0.3, 0.6)), goal_m=(5.0, 0.0))
    answer = scene.analyze().select()
    assert answer["arc"]["length_m"] == pytest.approx(1.0)
    assert abs(answer["arc"]["heading_change_rad"]) < 0.2


def test_unknown_ground_is_forbidden_only_where_it_is_driven_at_once():
    def seen_to(limit_m):
        return lambda north_m, _: np.where(north_m < limit_m, 0.0, np.nan)

    assert Scene(Gestalt, seen_to(3.0)).analyze().evaluate(1.0)["is_safe"]
    blind = Scene(Gestalt, seen_to(-1.0)).analyze().evaluate(1.0)
    assert (blind["is_safe"], blind["reason"]) == (0, Reason.UNKNOWN)


def test_rejections_count_every_candidate_once():
    answer = Scene(Gestalt, rocks((3.5, 0.3, 0.3, 0.5))).analyze().select()
    assert answer["rejections"].sum() == answer["paths_tested"]
    assert answer["rejections"][Reason.NONE] == 1


def test_more_weight_for_the_goal_makes_straighter_arcs():
    ground = rocks((3.0, 0.6, 0.2, 0.2))
    bends = [
        abs(
            Scene(Gestalt, ground, {"weight_goal": weight})
            .analyze()
            .select()["arc"]["heading_change_rad"]
        )
        for weight in (0.2, 50.0)
    ]
    assert bends[1] < bends[0]


def test_votes_cancel_in_a_dead_end_which_the_global_planner_leaves():
    """A pocket that opens away from the goal: only the cost to go knows the way round."""
    pocket = [(6.0, east, 0.3, 0.6) for east in np.arange(-5.0, 5.1, 0.5)]
    pocket += [
        (north, side, 0.3, 0.6) for north in np.arange(0.0, 6.0, 0.5) for side in (-5.0, 5.0)
    ]
    deep = Pose6(3.2, 0.0, 0.0, 0.0, 0.0, 0.0)

    def way_north_m(global_planner):
        own_params = {"global_planner": global_planner}
        scene = Scene(Gestalt, rocks(*pocket), own_params)
        answer = scene.analyze().select(pose=deep)
        assert answer["status"] == Status.OK
        points = answer["path_points"][: int(answer["path_point_count"])]
        return float(points["x_m"][-1]) - deep.x_m

    assert way_north_m(1.0) < way_north_m(0.0) - 1.0


def test_candidates_are_arcs_both_ways_and_turns_both_ways():
    own = own_param_values(Gestalt, {"arc_count": 5.0, "turn_step_deg": 60.0})
    candidates = make_candidates(own, 4.0)
    assert (candidates.length_m > 0).sum() == 5 + 6
    assert (candidates.length_m < 0).sum() == 5
    assert sorted(np.degrees(candidates.turn_rad[10:])) == pytest.approx(
        [-180, -120, -60, 60, 120, 180]
    )
    assert np.abs(candidates.heading_rad).max() == pytest.approx(4.0 * own["curvature_max_per_m"])


def test_the_cut_out_begins_and_ends_with_whole_cells(gestalt_limits):
    heights = Heights(np.zeros((300, 300)), -151, 17, 0.1)
    cut = cut_out(heights, Place(0.03, 20.0, 0.0), 8.0, gestalt_limits)
    assert cut.first_row % 2 == cut.first_col % 2 == 0
    assert cut.z_m.shape[0] % 2 == cut.z_m.shape[1] % 2 == 0
    assert cut.first_row * 0.1 == pytest.approx(-8.0, abs=0.21)
    assert cut.z_m.shape[0] * 0.1 == pytest.approx(16.0, abs=0.41)


@pytest.fixture
def gestalt_limits():
    return Scene(Gestalt, rocks()).planner._limits


def test_the_first_reason_along_an_arc_counts():
    reasons = np.array([[0, 0, 4, 1], [0, 0, 0, 0]], dtype=np.uint8)
    assert first_reasons(reasons).tolist() == [4, 0]


def test_votes_fall_from_the_least_cost_on():
    assert falling_votes(np.array([3.0, 1.0, 2.0, 99.0]), 4.0) == pytest.approx([0.5, 1.0, 0.75, 0])
