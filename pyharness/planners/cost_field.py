# SPDX-License-Identifier: Apache-2.0
"""What GESTALT remembers of the ground, and the cost from anywhere on it to the goal.

The place that Field D* has in Carsten et al. 2007. Field D* interpolates between cells; here it is
Dijkstra over eight neighbours, whose costs are up to 8 % too high in some directions, for all arcs
alike.
"""

import numpy as np
import numpy.typing as npt
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from pyharness.planners.arcs import Floats, Place
from pyharness.planners.goodness import GoodnessMap

SIDE = 128
MARGIN = 32  # cells from the edge at which the field moves along with the rover
CELL_MAP_CELLS = 2  # goodness cells along a side of a cell
# costs per metre, from 1 on the best ground to COST_POOR on the worst that is passable; unknown
# ground lies between; impassable ground is finite: from wherever the rover stands there is a way
COST_POOR, COST_UNKNOWN, COST_IMPASSABLE = 3.0, 2.0, 50.0

STEPS = ((0, 1), (1, 0), (1, 1), (1, -1))


class CostField:
    """Costs per metre of a square around the rover."""

    def __init__(self) -> None:
        """Start with nothing known."""
        self._cost = np.full((SIDE, SIDE), COST_UNKNOWN)
        self._origin = np.zeros(2, dtype=np.int64)  # first row, first column
        self._is_placed = False
        self._cell_m = 1.0

    def take(self, ground: GoodnessMap, place: Place) -> None:
        """Take in what is known of the ground, and follow the rover."""
        self._cell_m = CELL_MAP_CELLS * ground.cell_m
        self._follow(np.array([place.x_m, place.y_m]))
        known = np.argwhere(np.isfinite(ground.goodness))
        first = np.array([ground.first_row, ground.first_col])
        cells = (known + first) // CELL_MAP_CELLS - self._origin
        inside = ((cells >= 0) & (cells < SIDE)).all(axis=1)
        rows, cols = cells[inside].T
        goodness = ground.goodness[tuple(known[inside].T)]
        least = np.full((SIDE, SIDE), np.inf)
        np.minimum.at(least, (rows, cols), goodness)
        seen = np.isfinite(least)
        passable = COST_POOR - (COST_POOR - 1.0) * least[seen]
        self._cost[seen] = np.where(least[seen] > 0.0, passable, COST_IMPASSABLE)

    def cost_to_go(self, goal_m: Floats, radius_m: float, points_m: Floats) -> Floats:
        """Return the cost from points [n, north and east] to a disc, in metres of good ground."""
        centers_m = (self._origin + np.indices((SIDE, SIDE)).reshape(2, -1).T + 0.5) * self._cell_m
        away_m = np.maximum(np.hypot(*(centers_m - goal_m).T) - radius_m, 0.0)
        inside = self._cells(goal_m[None])[1][0]
        seeds = np.zeros((SIDE, SIDE), dtype=np.bool_)
        seeds[[0, -1], :] = seeds[:, [0, -1]] = not inside
        seeds = seeds.ravel() | (away_m == away_m.min())
        distances = self._distances(np.flatnonzero(seeds), COST_UNKNOWN * away_m[seeds])
        cells, is_inside = self._cells(points_m)
        beyond_m = np.maximum(np.hypot(*(points_m - goal_m).T) - radius_m, 0.0)
        return np.where(is_inside, distances[cells], COST_UNKNOWN * beyond_m)

    def _cells(self, points_m: Floats) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.bool_]]:
        rows, cols = (np.floor(points_m / self._cell_m).astype(np.int64) - self._origin).T
        inside = (rows >= 0) & (rows < SIDE) & (cols >= 0) & (cols < SIDE)
        return np.where(inside, rows * SIDE + cols, 0), inside

    def _distances(self, seeds: npt.NDArray[np.int64], seed_costs: Floats) -> Floats:
        """Return the least cost from every cell to a seed, which has a cost of its own."""
        number = np.arange(SIDE * SIDE).reshape(SIDE, SIDE)
        goal = SIDE * SIDE
        starts, ends, costs = [np.full(len(seeds), goal)], [seeds], [seed_costs + 1e-9]
        for down, right in STEPS:
            a = (slice(0, SIDE - down), slice(max(0, -right), SIDE - max(0, right)))
            b = (slice(down, SIDE), slice(max(0, right), SIDE - max(0, -right)))
            length_m = self._cell_m * np.hypot(down, right)
            starts.append(number[a].ravel())
            ends.append(number[b].ravel())
            costs.append(0.5 * length_m * (self._cost[a] + self._cost[b]).ravel())
        edges = (np.concatenate(costs), (np.concatenate(starts), np.concatenate(ends)))
        graph = coo_array(edges, shape=(goal + 1, goal + 1)).tocsr()
        return np.asarray(dijkstra(graph, directed=False, indices=goal)[:goal])

    def _follow(self, here_m: Floats) -> None:
        """Move the field when the rover nears its edge; what leaves it is forgotten."""
        cell = np.floor(here_m / self._cell_m).astype(np.int64)
        if not self._is_placed:
            self._origin, self._is_placed = cell - SIDE // 2, True
        place = cell - self._origin
        if ((place >= MARGIN) & (place < SIDE - MARGIN)).all():
            return
        old, self._origin = self._origin, cell - SIDE // 2
        rows, cols = (np.arange(SIDE) + moved for moved in self._origin - old)
        row_kept, col_kept = ((span >= 0) & (span < SIDE) for span in (rows, cols))
        moved = np.full((SIDE, SIDE), COST_UNKNOWN)
        moved[np.ix_(row_kept, col_kept)] = self._cost[np.ix_(rows[row_kept], cols[col_kept])]
        self._cost = moved
