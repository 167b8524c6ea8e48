# SPDX-License-Identifier: Apache-2.0
"""OMPL's RRT# on a field of costs, in a process of its own: its library dies at exit.

`python -m pyharness.tests.ompl_rrt_sharp FIELD.npz SECONDS` prints the cost of the path found.
"""

import math
import os
import sys

import numpy as np
from ompl import base, geometric, util

from pyharness.planners.rrt_graph import Field

WALL = 1e9


class PathCost(base.OptimizationObjective):  # type: ignore[misc,unused-ignore]
    """The cost of straight lines over the field."""

    def __init__(self, space, costs):
        super().__init__(space)
        self.costs = costs

    def stateCost(self, _):  # noqa: N802
        return base.Cost(0.0)

    def motionCost(self, start, end):  # noqa: N802
        ends_m = np.array([[end[0], end[1]]])
        cost = float(self.costs.edge_costs(np.array([start[0], start[1]]), ends_m)[0])
        return base.Cost(min(cost, WALL))


def main(path, seconds):
    util.noOutputHandler()
    data = np.load(path)
    costs = Field(data["cost_per_m"], *(float(data[name]) for name in ("south_m", "west_m")), 0.5)
    bounds = base.RealVectorBounds(2)
    for axis, (low_m, side_m) in enumerate(
        zip((costs.south_m, costs.west_m), costs.sides_m, strict=True)
    ):
        bounds.setLow(axis, low_m)
        bounds.setHigh(axis, low_m + side_m - 1e-6)
    plane = base.RealVectorStateSpace(2)
    plane.setBounds(bounds)
    space = base.SpaceInformation(plane)

    def is_free(state):
        return math.isfinite(float(costs.at(np.array([state[0], state[1]]))))

    space.setStateValidityChecker(base.StateValidityCheckerFn(is_free))
    space.setStateValidityCheckingResolution(0.5 * costs.cell_m / plane.getMaximumExtent())
    space.setup()
    problem = base.ProblemDefinition(space)
    places = []
    for name in ("start_m", "goal_m"):
        place = base.State(plane)
        place()[0], place()[1] = (float(number) for number in data[name])
        places.append(place)
    problem.setStartAndGoalStates(*places, float(data["radius_m"]))
    objective = PathCost(space, costs)
    problem.setOptimizationObjective(objective)
    planner = geometric.RRTsharp(space)
    planner.setRange(float(data["step_m"]))
    planner.setProblemDefinition(problem)
    planner.setup()
    planner.solve(base.timedPlannerTerminationCondition(seconds))
    sys.stdout.write(f"{problem.getSolutionPath().cost(objective).value()}\n")
    sys.stdout.flush()
    os._exit(0)


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]))
