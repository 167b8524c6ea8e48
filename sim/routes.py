# SPDX-License-Identifier: Apache-2.0
"""Optimal routes over a map: which ground would a rover drive on (SIM, M2020 Orbital Terrains)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from sim.config import ConfigModel
from sim.rocks import CFA_MAX

Grid = npt.NDArray[np.float64]
Cell = tuple[int, int]
# half of the steps to the neighbours of a cell; the other half goes back
STEPS = ((0, 1), (1, 0), (1, 1), (1, -1), (1, 2), (2, 1), (1, -2), (2, -1))


class RouteCost(ConfigModel):
    """Cost of a metre: 1 + (slope / slope_double_deg)^2 + (CFA / cfa_double)^2.

    The published tool does not state its cost. This one is the length of the way, doubled by 5
    degrees, about where slip begins to be felt, and tenfold by 15; and doubled by the 10 % of rocks
    at which earlier autonomous navigation began to fail.

    Attributes:
        slope_double_deg: Slope at which a metre costs twice as much.
        cfa_double: CFA at which it does.
        slope_max_deg: Steeper ground is not driven on.
        cfa_max: Nor is ground with more rocks.
    """

    slope_double_deg: Annotated[float, Field(gt=0, le=90)] = 5.0
    cfa_double: Annotated[float, Field(gt=0, le=1)] = 0.10
    slope_max_deg: Annotated[float, Field(gt=0, le=60)] = 25.0
    cfa_max: Annotated[float, Field(gt=0, le=CFA_MAX)] = CFA_MAX

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.slope_double_deg > self.slope_max_deg:
            raise ValueError("slope_double_deg must not exceed slope_max_deg")
        return self

    def per_m(self, slope_rad: Grid, cfa: Grid) -> Grid:
        """Cost of a metre in every cell; infinite where the ground is not driven on."""
        slope_deg = np.degrees(slope_rad)
        cost: Grid = 1.0 + (slope_deg / self.slope_double_deg) ** 2 + (cfa / self.cfa_double) ** 2
        # NaN compares false: no data is no ground
        passable = (slope_deg <= self.slope_max_deg) & (cfa <= self.cfa_max)
        return np.where(passable, cost, np.inf)


@dataclass(frozen=True, slots=True, eq=False)
class Highways:
    """Where the routes run.

    Attributes:
        routes: Cells of every route, from its start to its region.
        likelihood: Share of the routes that cross each cell.
        driven_m: Metres of all routes in each cell.
    """

    routes: tuple[npt.NDArray[np.int64], ...]
    likelihood: Grid
    driven_m: Grid


def find_highways(
    cost_per_m: Grid,
    cell_m: tuple[float, float],
    starts: Sequence[Cell],
    regions: Sequence[npt.NDArray[np.int64]],
) -> Highways:
    """Cheapest route from every start to the nearest cell of every region.

    Args:
        cost_per_m: Cost in every cell, infinite where nobody drives.
        cell_m: North and east size of a cell.
        starts: Row and column of each.
        regions: Flat indices of the cells of each.
    """
    graph = _graph(cost_per_m, cell_m)
    shape = cost_per_m.shape
    crossed, driven_m = np.zeros(cost_per_m.size), np.zeros(cost_per_m.size)
    routes: list[npt.NDArray[np.int64]] = []
    for region in regions:
        # costs are the same both ways: one search outward from a region serves every start
        distance, before, _ = dijkstra(
            graph, indices=region, return_predecessors=True, min_only=True
        )
        for row, col in starts:
            cell = row * shape[1] + col
            if not math.isfinite(distance[cell]):
                continue
            route = _trace(before, cell)
            routes.append(route)
            crossed[route] += 1.0
            steps_m = np.hypot(
                np.diff(route // shape[1]) * cell_m[0], np.diff(route % shape[1]) * cell_m[1]
            )
            np.add.at(driven_m, route[:-1], 0.5 * steps_m)
            np.add.at(driven_m, route[1:], 0.5 * steps_m)
    likelihood = (crossed / max(1, len(routes))).reshape(shape)
    return Highways(tuple(routes), likelihood, driven_m.reshape(shape))


def _trace(before: npt.NDArray[np.int32], cell: int) -> npt.NDArray[np.int64]:
    route = [cell]
    while (cell := int(before[cell])) >= 0:
        route.append(cell)
    return np.array(route, dtype=np.int64)


def _between(right: int) -> tuple[Cell, Cell]:
    """The two cells that a knight's move passes between."""
    side = 1 if right > 0 else -1
    return ((0, side), (1, side)) if abs(right) == 2 else ((1, 0), (1, side))


def _shifted(values: Grid, by: Cell, step: Cell) -> Grid:
    """Values of the cells a shift away from each cell from which the whole step is on the map."""
    (rows, cols), (down, right) = values.shape, step
    first = max(0, -right)
    result: Grid = values[by[0] : rows - down + by[0], first + by[1] : cols - max(0, right) + by[1]]
    return result


def _graph(cost_per_m: Grid, cell_m: tuple[float, float]) -> csr_array:
    """Edges to sixteen neighbours, also a knight's move away: length times mean cost of both cells.

    Eight directions alone would force routes onto a lattice of 45 degree lines; sixteen keep them
    within 3 % of the straight distance.
    """
    rows, cols = cost_per_m.shape
    index = np.arange(rows * cols).reshape(rows, cols)
    tails, heads, weights = [], [], []
    for down, right in STEPS:
        here = (slice(0, rows - down), slice(max(0, -right), cols - max(0, right)))
        there = (slice(down, rows), slice(max(0, right), cols - max(0, -right)))
        length_m = math.hypot(down * cell_m[0], right * cell_m[1])
        weight = length_m * 0.5 * (cost_per_m[here] + cost_per_m[there])
        if abs(down) + abs(right) == 3:  # passes between two cells: none may be closed
            between = [_shifted(cost_per_m, cell, (down, right)) for cell in _between(right)]
            weight = length_m * 0.25 * (cost_per_m[here] + cost_per_m[there] + sum(between))
        usable = np.isfinite(weight)
        tail, head, weight = index[here][usable], index[there][usable], weight[usable]
        tails += [tail, head]
        heads += [head, tail]
        weights += [weight, weight]
    return csr_array(
        (np.concatenate(weights), (np.concatenate(tails), np.concatenate(heads))),
        shape=(rows * cols, rows * cols),
    )
