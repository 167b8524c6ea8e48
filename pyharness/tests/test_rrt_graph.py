# SPDX-License-Identifier: Apache-2.0
"""RRT# against the optimum of the same field, and against OMPL's RRT# where that is installed."""

import importlib.util
import math
import subprocess
import sys

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from pyharness.planners.rrt_graph import Budget, Field, Goal, find_path

SIDE, CELL_M, HALF_M = 50, 0.5, 12.5
START_M, GOAL = (0.2, -9.0), Goal(0.2, 9.0, 2.0, 36.0)
MANY = Budget(vertices=3000, step_m=6.0, goal_bias=0.05)
# what MANY vertices come to within, on the fields of these tests
CONVERGED = 1.03
# start and end lie within cells: a path may be half a cell shorter or longer at either end
SLACK = CELL_M * 24.0


def make_field(seed):
    """Smooth costs from 24 s/m on, with walls."""
    rng = np.random.default_rng(seed)
    cost = 24.0 + 200.0 * np.abs(gaussian_filter(rng.normal(size=(SIDE, SIDE)), 2.0))
    cost[gaussian_filter(rng.normal(size=(SIDE, SIDE)), 1.5) > 0.3] = np.inf
    for middle in (7, 43):
        cost[21:30, middle - 4 : middle + 5] = 24.0
    return Field(cost, -HALF_M, -HALF_M, CELL_M)


def optimum(field, start_m, goal, reach):
    """Least cost by Dijkstra with straight lines to all cells within reach cells.

    Each further ring of neighbours lowers what the directions of the lines cost too much: 8 % with
    one ring, 1 % with four.
    """
    number = np.arange(SIDE * SIDE).reshape(SIDE, SIDE)
    corner_m = np.array([field.south_m, field.west_m])
    centers_m = corner_m + (np.indices((SIDE, SIDE)).reshape(2, -1).T + 0.5) * CELL_M
    starts, ends, costs = [], [], []
    for down in range(reach + 1):
        for right in range(-reach, reach + 1):
            if math.gcd(down, abs(right)) != 1 or (down == 0 and right < 0):
                continue
            a = number[: SIDE - down, max(0, -right) : SIDE - max(0, right)].ravel()
            b = number[down:, max(0, right) : SIDE - max(0, -right)].ravel()
            way_m = centers_m[b] - centers_m[a]
            length_m = math.hypot(down, right) * CELL_M
            count = 8 * reach
            share = (np.arange(count) + 0.5) / count
            cost = length_m * field.at(centers_m[a] + share[:, None, None] * way_m).mean(axis=0)
            free = np.isfinite(cost)
            starts.append(a[free])
            ends.append(b[free])
            costs.append(cost[free])
    edges = (np.concatenate(costs), (np.concatenate(starts), np.concatenate(ends)))
    graph = coo_array(edges, shape=(SIDE * SIDE, SIDE * SIDE)).tocsr()
    here = int((start_m[0] + HALF_M) / CELL_M) * SIDE + int((start_m[1] + HALF_M) / CELL_M)
    distances = dijkstra(graph, directed=False, indices=here)
    return distances[goal.distances_m(centers_m) <= goal.radius_m].min()


@pytest.mark.parametrize("seed", range(4))
def test_the_cost_comes_within_three_percent_of_the_optimum(seed):
    field = make_field(seed)
    path = find_path(field, START_M, GOAL, MANY, np.random.default_rng(seed))
    best = optimum(field, START_M, GOAL, 4)
    assert best - SLACK <= path.cost <= CONVERGED * best + SLACK


def test_more_vertices_never_make_the_path_dearer():
    field = make_field(1)
    costs = [
        find_path(field, START_M, GOAL, Budget(count, 6.0, 0.05), np.random.default_rng(3)).cost
        for count in (100, 300, 1000, 3000)
    ]
    assert costs == sorted(costs, reverse=True)
    assert costs[-1] < costs[0]


def test_the_cost_is_that_of_the_lines_of_the_path():
    field = make_field(2)
    path = find_path(field, START_M, GOAL, Budget(600, 6.0, 0.05), np.random.default_rng(0))
    pieces = [
        float(field.edge_costs(end, start[None])[0])
        for start, end in zip(path.points_m[:-1], path.points_m[1:], strict=True)
    ]
    # the samples of a line lie closer when it is compared with longer ones
    assert path.cost == pytest.approx(sum(pieces), rel=0.02)
    assert path.points_m[0] == pytest.approx(START_M)
    assert GOAL.distances_m(path.points_m[-1]) <= GOAL.radius_m


def test_on_even_ground_the_path_is_nearly_straight():
    field = Field(np.full((SIDE, SIDE), 24.0), -HALF_M, -HALF_M, CELL_M)
    path = find_path(field, START_M, GOAL, MANY, np.random.default_rng(0))
    assert path.cost + 1e-9 >= 24.0 * 16.0
    assert path.cost <= 24.0 * 16.0 * 1.02


def test_a_goal_outside_is_approached_through_the_edge_that_faces_it():
    field = Field(np.full((SIDE, SIDE), 24.0), -HALF_M, -HALF_M, CELL_M)
    goal = Goal(0.0, 40.0, 2.0, 36.0)
    path = find_path(field, (0.0, 0.0), goal, MANY, np.random.default_rng(0))
    assert path.points_m[-1][1] > HALF_M - CELL_M - 1e-9
    straight = 24.0 * 12.25 + 36.0 * (40.0 - 12.25 - 2.0)
    assert straight <= path.cost + 24.0 * CELL_M
    assert path.cost <= 1.03 * straight


def test_a_walled_in_start_has_no_path():
    cost = np.full((SIDE, SIDE), 24.0)
    cost[20:31, [2, 12]] = cost[[20, 30], 2:13] = np.inf
    field = Field(cost, -HALF_M, -HALF_M, CELL_M)
    path = find_path(field, START_M, GOAL, Budget(300, 6.0, 0.05), np.random.default_rng(0))
    assert path.cost == math.inf
    assert len(path.points_m) == 0


def test_the_same_generator_gives_the_same_path():
    field = make_field(0)
    budget = Budget(300, 6.0, 0.05)
    first, second = (
        find_path(field, START_M, GOAL, budget, np.random.default_rng(5)) for _ in range(2)
    )
    assert first.cost == second.cost
    assert (first.points_m == second.points_m).all()


def test_samples_given_are_used_first():
    field = Field(np.full((SIDE, SIDE), 24.0), -HALF_M, -HALF_M, CELL_M)
    wanted_m = np.array([[0.2, -4.0], [0.2, 1.0], [0.2, 7.0]])
    path = find_path(field, START_M, GOAL, Budget(4, 6.0, 0.0), np.random.default_rng(0), wanted_m)
    assert path.points_m == pytest.approx(np.vstack([START_M, wanted_m]))


@pytest.mark.slow
@pytest.mark.skipif(
    importlib.util.find_spec("ompl") is None,
    reason="OMPL is not installed (pip install ompl==1.7.0)",
)
@pytest.mark.parametrize("seed", range(2))
def test_the_cost_is_at_most_five_percent_above_that_of_ompls_rrt_sharp(tmp_path, seed):
    field = make_field(seed)
    np.savez(
        tmp_path / "field.npz",
        cost_per_m=field.cost_per_m,
        south_m=field.south_m,
        west_m=field.west_m,
        start_m=START_M,
        goal_m=(GOAL.north_m, GOAL.east_m),
        radius_m=GOAL.radius_m,
        step_m=MANY.step_m,
    )
    command = [sys.executable, "-m", "pyharness.tests.ompl_rrt_sharp", tmp_path / "field.npz", "10"]
    answer = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60)
    ompl_cost = float(answer.stdout)
    path = find_path(field, START_M, GOAL, MANY, np.random.default_rng(seed))
    assert path.cost <= 1.05 * ompl_cost
    # it is the same problem that was solved: nothing beats the optimum
    assert ompl_cost >= optimum(field, START_M, GOAL, 4) - SLACK
