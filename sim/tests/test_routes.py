# SPDX-License-Identifier: Apache-2.0
"""Optimal routes against a plain search, and what their costs do."""

import heapq
import math

import numpy as np
import pytest
from pydantic import ValidationError

from sim.random_streams import rng_for
from sim.routes import STEPS, RouteCost, find_highways

MOVES = [*STEPS, *((-down, -right) for down, right in STEPS)]


def passed(down, right):
    """Cells that a knight's move passes between, by geometry: those nearest its middle."""
    if abs(down) + abs(right) != 3:
        return []
    cells = [(a, b) for a in range(-2, 3) for b in range(-2, 3) if (a, b) not in {(0, 0)}]
    cells = [c for c in cells if c != (down, right)]
    distance = [math.hypot(a - down / 2, b - right / 2) for a, b in cells]
    return [c for c, d in zip(cells, distance, strict=True) if d < 0.6]


def plain_distance(cost, cell_m, goal):
    """Dijkstra with a heap, cell by cell."""
    best = np.full(cost.shape, np.inf)
    best[goal] = 0.0
    queue = [(0.0, goal)]
    while queue:
        far, (row, col) = heapq.heappop(queue)
        if far > best[row, col]:
            continue
        for down, right in MOVES:
            i, j = row + down, col + right
            if not (0 <= i < cost.shape[0] and 0 <= j < cost.shape[1]):
                continue
            cells = [(row, col), (i, j), *((row + a, col + b) for a, b in passed(down, right))]
            length = math.hypot(down * cell_m[0], right * cell_m[1])
            step = far + length * np.mean([cost[c] for c in cells])
            if step < best[i, j]:
                best[i, j] = step
                heapq.heappush(queue, (step, (i, j)))
    return best


def route_cost(cost, cell_m, route):
    rows, cols = route // cost.shape[1], route % cost.shape[1]
    total = 0.0
    for k in range(len(route) - 1):
        down, right = int(rows[k + 1] - rows[k]), int(cols[k + 1] - cols[k])
        cells = [(rows[k], cols[k]), (rows[k + 1], cols[k + 1])]
        cells += [(rows[k] + a, cols[k] + b) for a, b in passed(down, right)]
        total += math.hypot(down * cell_m[0], right * cell_m[1]) * np.mean([cost[c] for c in cells])
    return total


@pytest.mark.parametrize("seed", range(6))
def test_routes_are_the_cheapest_there_are(seed: int) -> None:
    rng = rng_for(seed, "routes")
    cost = rng.uniform(1, 6, (17, 23))
    cost[rng.random(cost.shape) < 0.25] = np.inf
    cost[2, 3] = cost[15, 20] = 1.0
    cell_m = (1.0, 0.949)
    goal = 15 * 23 + 20
    highways = find_highways(cost, cell_m, [(2, 3)], [np.array([goal])])
    expected = plain_distance(cost, cell_m, (15, 20))[2, 3]
    if not np.isfinite(expected):
        assert highways.routes == ()
        return
    (route,) = highways.routes
    assert (route[0], route[-1]) == (2 * 23 + 3, goal)
    assert route_cost(cost, cell_m, route) == pytest.approx(expected)


def test_straight_ways_in_all_directions_are_at_most_3_percent_too_long() -> None:
    level = np.ones((101, 101))
    for bearing in np.radians(np.arange(0, 360, 7)):
        goal = (round(50 + 45 * math.cos(bearing)), round(50 + 45 * math.sin(bearing)))
        ways = find_highways(level, (1, 1), [(50, 50)], [np.array([goal[0] * 101 + goal[1]])])
        length = ways.driven_m.sum()
        assert 1.0 <= length / math.dist(goal, (50, 50)) <= 1.028 + 1e-9


def test_routes_end_at_the_nearest_cell_of_a_region_and_are_counted() -> None:
    level = np.ones((20, 30))
    region = np.array([10 * 30 + 25, 10 * 30 + 20, 3 * 30 + 28])
    highways = find_highways(level, (2.0, 2.0), [(10, 2), (10, 5)], [region])
    assert [int(route[-1]) for route in highways.routes] == [10 * 30 + 20] * 2
    assert highways.likelihood[10, 10] == 1.0
    assert highways.likelihood[10, 3] == 0.5
    assert highways.driven_m.sum() == pytest.approx(2 * (18 + 15))


def test_nobody_passes_a_wall_or_steep_or_rocky_or_unknown_ground() -> None:
    cost = np.ones((20, 20))
    cost[:, 9] = np.inf
    assert find_highways(cost, (1, 1), [(5, 2)], [np.array([5 * 20 + 15])]).routes == ()
    slope = np.radians([[0.0, 5.0, 26.0, np.nan, 0.0, 0.0]])
    cfa = np.array([[0.0, 0.1, 0.0, 0.0, 0.31, np.nan]])
    per_m = RouteCost(cfa_max=0.3).per_m(slope, cfa)
    np.testing.assert_allclose(per_m, [[1.0, 3.0, np.inf, np.inf, np.inf, np.inf]])


def test_contradicting_costs_are_refused() -> None:
    with pytest.raises(ValidationError, match="must not exceed"):
        RouteCost(slope_double_deg=30)
