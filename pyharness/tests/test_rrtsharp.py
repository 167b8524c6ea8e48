# SPDX-License-Identifier: Apache-2.0
import math

import numpy as np
import pytest

from pyharness.clib import ffi, lib
from pyharness.planners.arcs import Place, arc_points
from pyharness.planners.rrt_graph import Budget, Goal, find_path
from pyharness.planners.rrtsharp import RrtSharp, arc_to, point_along
from pyharness.status import Reason, Status
from pyharness.tests.planner_scene import HERE, Scene, rocks

FIELD_OF_ROCKS = rocks(*((5.0, east_m, 0.5, 0.6) for east_m in np.arange(-6.0, 3.1, 0.5)))


def test_the_path_costs_what_dijkstra_finds_on_the_same_costmap_or_less():
    """Navlib's Dijkstra knows eight directions: at most 8 % too dear, never too cheap."""
    own_params = {"horizon_m": 25.0, "vertices": 3000.0, "roughness_max_m": 10.0}
    planner = Scene(RrtSharp, FIELD_OF_ROCKS, own_params).analyze().planner
    ctx = planner._navlib.context
    goal = ffi.new("nav_waydisc_t *", (12.0, -3.0, 2.0))
    parts = (ffi.addressof(ctx, name) for name in ("global", "costmap", "params"))
    lib.nav_global_plan(*parts, goal, True, True)
    dijkstra_s = lib.nav_global_cost_to_go_s(
        ffi.addressof(ctx, "global"), ffi.addressof(ctx, "costmap"), ffi.addressof(ctx, "params"),
        goal, 0.0, 0.0,
    )  # fmt: skip
    costs, _ = planner._field(Place(0.0, 0.0, 0.0), True, True)
    path = find_path(
        costs, (0.0, 0.0), Goal(12.0, -3.0, 2.0, 36.0), Budget(3000, 6.0, 0.05),
        np.random.default_rng(0),
    )  # fmt: skip
    assert 0.92 * dijkstra_s <= path.cost <= 1.03 * dijkstra_s


def test_a_rough_place_is_gone_round():
    answer = Scene(RrtSharp, FIELD_OF_ROCKS).analyze().select()
    assert answer["status"] == Status.OK
    points = answer["global_points"][: int(answer["global_point_count"])]
    near = points["x_m"].searchsorted(5.0)
    crossing = np.interp(5.0, points["x_m"], points["y_m"]) if near else 0.0
    assert crossing > 4.0
    assert answer["paths_tested"] > 1000
    assert answer["path_cost_s"] > 0.0


def test_without_a_limit_of_roughness_rocks_only_cost():
    answer = Scene(RrtSharp, FIELD_OF_ROCKS, {"roughness_max_m": 10.0}).analyze().evaluate(6.0)
    assert answer["is_safe"]
    assert not Scene(RrtSharp, FIELD_OF_ROCKS).analyze().evaluate(6.0)["is_safe"]


def test_an_arc_is_unsafe_with_the_reason_of_the_cell_it_enters():
    answer = Scene(RrtSharp, FIELD_OF_ROCKS).analyze().evaluate(6.0)
    assert answer["reason"] == Reason.CLEARANCE
    assert 2.0 < answer["failing_at"] < 5.0


def test_a_rover_in_a_blocked_cell_may_leave_but_not_go_on():
    scene = Scene(RrtSharp, rocks((0.6, 0.0, 0.3, 0.6), (3.0, 0.0, 1.0, 0.8))).analyze()
    assert scene.evaluate(-1.0)["is_safe"]
    assert not scene.evaluate(3.0)["is_safe"]


def test_blocked_cells_block_those_beside_them_as_far_as_they_grow():
    at_m = [
        float(
            Scene(RrtSharp, FIELD_OF_ROCKS, {"grow_m": grow_m})
            .analyze()
            .evaluate(6.0)["failing_at"]
        )
        for grow_m in (0.0, 0.5, 1.0)
    ]
    assert np.diff(at_m) == pytest.approx([-0.5, -0.5])


def test_a_blocked_cell_near_a_rover_on_free_ground_is_blocked():
    scene = Scene(RrtSharp, rocks((2.4, 0.0, 0.3, 0.6))).analyze()
    answer = scene.evaluate(1.0)
    assert (answer["is_safe"], answer["reason"]) == (0, Reason.CLEARANCE)


def test_a_rover_walled_in_has_no_path():
    angles_rad = np.linspace(0.0, 2.0 * math.pi, 40, endpoint=False)
    ring = [(5.0 * math.cos(a), 5.0 * math.sin(a), 0.4, 0.8) for a in angles_rad]
    answer = Scene(RrtSharp, rocks(*ring)).analyze().select()
    assert answer["status"] == Status.NO_PATH
    assert answer["rejections"].sum() == 1


def test_arcs_end_at_the_point_they_lead_to():
    for bearing_rad in (-0.7, 0.0, 0.3):
        length_m, heading_rad = arc_to(2.0, bearing_rad)
        end_m = arc_points(Place(0.0, 0.0, 0.0), length_m, heading_rad, 0.25)[0, -1]
        assert end_m == pytest.approx([2.0 * math.cos(bearing_rad), 2.0 * math.sin(bearing_rad)])


def test_a_point_along_a_path_lies_on_it():
    path_m = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 4.0]])
    assert point_along(path_m, 2.0) == pytest.approx([1.0, 1.0])
    assert point_along(path_m, 99.0) == pytest.approx([1.0, 4.0])


def test_the_last_path_is_tried_first_next_time():
    scene = Scene(RrtSharp, FIELD_OF_ROCKS, {"vertices": 150.0}).analyze()
    costs = [float(scene.select(pose=HERE)["path_cost_s"]) for _ in range(4)]
    assert costs == sorted(costs, reverse=True)
