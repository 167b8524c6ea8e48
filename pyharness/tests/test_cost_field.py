# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from pyharness.planners.arcs import Place
from pyharness.planners.cost_field import COST_UNKNOWN, CostField
from pyharness.planners.goodness import GoodnessMap

HERE = Place(0.0, 0.0, 0.0)


def ground(goodness, half_m=10.0, north_m=0.0):
    count = round(2.0 * half_m / 0.2)
    values = np.full((count, count), goodness)
    first = round((north_m - half_m) / 0.2)
    return GoodnessMap(values, np.zeros(values.shape, np.uint8), first, -count // 2, 0.2)


def costs(field, goal_m, *points_m, radius_m=0.4):
    return field.cost_to_go(np.array(goal_m), radius_m, np.array(points_m))


def test_good_ground_costs_its_length():
    field = CostField()
    field.take(ground(1.0), HERE)
    assert costs(field, (8.0, 0.0), (0.0, 0.0))[0] == pytest.approx(8.0, abs=0.5)


def test_unknown_and_poor_ground_costs_more():
    field = CostField()
    field.take(ground(0.25), HERE)
    poor = costs(field, (8.0, 0.0), (0.0, 0.0))[0]
    assert poor == pytest.approx(2.5 * 8.0, rel=0.08)
    beyond = costs(CostField(), (80.0, 0.0), (0.0, 0.0))[0]
    assert beyond == pytest.approx(COST_UNKNOWN * 80.0, rel=0.01)


def test_a_wall_is_gone_round():
    field = CostField()
    walled = ground(1.0)
    walled.goodness[70, 10:90] = 0.0  # 4 m north, 8 m to either side
    field.take(walled, HERE)
    straight_m, round_m = 8.0, 2.0 * np.hypot(4.0, 8.0)
    cost = costs(field, (8.0, 0.0), (0.0, 0.0))[0]
    assert straight_m + 4.0 < cost <= 1.15 * round_m


def test_what_was_seen_is_remembered_when_the_rover_has_gone_on():
    field = CostField()
    field.take(ground(0.0001), HERE)
    field.take(ground(1.0, half_m=2.0, north_m=14.0), Place(14.0, 0.0, 0.0))
    assert costs(field, (8.0, 0.0), (0.0, 0.0))[0] == pytest.approx(3.0 * 8.0, rel=0.08)


def test_a_goal_outside_is_reached_through_the_edge():
    field = CostField()
    field.take(ground(1.0), HERE)
    near, far = costs(field, (60.0, 0.0), (5.0, 0.0), (-5.0, 0.0))
    assert near == pytest.approx(5.0 + COST_UNKNOWN * 50.0, rel=0.08)
    assert far - near == pytest.approx(10.0, rel=0.1)


def test_a_goal_is_reached_at_the_free_side_of_its_disc():
    field = CostField()
    rocky = ground(1.0)
    rocky.goodness[88:92, 48:52] = 0.0  # the middle of the disc
    field.take(rocky, HERE)
    assert costs(field, (8.0, 0.0), (0.0, 0.0), radius_m=2.0)[0] == pytest.approx(6.0, abs=0.5)
