# SPDX-License-Identifier: Apache-2.0
"""RRT# (Arslan and Tsiotras 2013) over a field of costs per metre.

A random graph grows towards samples; after each new vertex the tree of least costs is repaired as
LPA* does, but only for vertices that may lie on a path better than the best known. Every vertex has
the cost of its path (g) and what that cost would be through its best neighbour now (lmc); it is
consistent when the two are equal.
"""

import heapq
import math
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from pyharness.planners.arcs import Floats

# of the radius that keeps the graph's optimum converging: 1 is its lower bound
RADIUS_FACTOR = 1.1


@dataclass(frozen=True, slots=True)
class Field:
    """Costs per metre [row, column] from the south-west corner on; infinite where blocked."""

    cost_per_m: Floats
    south_m: float
    west_m: float
    cell_m: float

    def at(self, points_m: Floats) -> Floats:
        """Return the cost per metre at points [..., north and east]; infinite outside."""
        rows = np.floor((points_m[..., 0] - self.south_m) / self.cell_m).astype(np.int64)
        cols = np.floor((points_m[..., 1] - self.west_m) / self.cell_m).astype(np.int64)
        count_rows, count_cols = self.cost_per_m.shape
        inside = (rows >= 0) & (rows < count_rows) & (cols >= 0) & (cols < count_cols)
        cost = self.cost_per_m[np.where(inside, rows, 0), np.where(inside, cols, 0)]
        return np.where(inside, cost, np.inf)

    def edge_costs(self, here_m: Floats, ends_m: Floats) -> Floats:
        """Return the cost of the straight lines from here [2] to ends [n, 2]."""
        ways_m = ends_m - here_m
        lengths_m = np.hypot(ways_m[:, 0], ways_m[:, 1])
        count = max(1, math.ceil(2.0 * lengths_m.max(initial=0.0) / self.cell_m))
        share = (np.arange(count) + 0.5) / count
        samples_m = here_m + share[:, None, None] * ways_m
        return np.asarray(lengths_m * self.at(samples_m).mean(axis=0))

    @property
    def sides_m(self) -> tuple[float, float]:
        """Return the extent to the north and to the east."""
        rows, cols = self.cost_per_m.shape
        return rows * self.cell_m, cols * self.cell_m


@dataclass(frozen=True, slots=True)
class Goal:
    """A disc. Where it lies outside the field, its edge that faces it counts, with the line from
    there to the disc at `beyond_per_m`."""

    north_m: float
    east_m: float
    radius_m: float
    beyond_per_m: float

    def distances_m(self, points_m: Floats) -> Floats:
        """Return the distances of points [..., 2] from the centre."""
        return np.hypot(points_m[..., 0] - self.north_m, points_m[..., 1] - self.east_m)


@dataclass(frozen=True, slots=True)
class Budget:
    """How much is searched.

    Attributes:
        vertices: Of the graph, at most.
        step_m: Longest edge.
        goal_bias: Share of samples at the goal.
    """

    vertices: int
    step_m: float
    goal_bias: float


@dataclass(frozen=True, slots=True)
class Path:
    """The best path found: points [n, north and east] from the start; none: cost infinite."""

    points_m: Floats
    cost: float
    edge_count: int


def find_path(
    costs: Field,
    start_m: tuple[float, float],
    goal: Goal,
    budget: Budget,
    rng: np.random.Generator,
    first_samples_m: Iterable[Floats] = (),
) -> Path:
    """Grow a graph from the start until the budget is used up."""
    graph = _Graph(costs, start_m, goal, budget)
    wanted = list(first_samples_m)
    # a sample that leads nowhere costs a try, so that a walled-in start comes to an end
    for _ in range(4 * budget.vertices):
        if graph.count >= budget.vertices:
            break
        sample_m = wanted.pop(0) if wanted else graph.sample(rng)
        if graph.extend(sample_m):
            graph.replan()
    return graph.best_path()


@dataclass(slots=True)
class _Graph:
    costs: Field
    start_m: tuple[float, float]
    goal: Goal
    budget: Budget
    count: int = 1
    edge_count: int = 0
    best: int = -1
    best_cost: float = math.inf
    places_m: Floats = field(init=False)
    g: list[float] = field(init=False)
    lmc: list[float] = field(init=False)
    h: list[float] = field(init=False)
    beyond: list[float] = field(init=False)  # cost from a vertex of the goal to the goal itself
    parent: list[int] = field(init=False)
    neighbors: list[list[tuple[int, float]]] = field(init=False)
    queue: list[tuple[float, float, int]] = field(default_factory=list)
    goal_cells_m: Floats = field(init=False)
    cost_least: float = field(init=False)
    radius_scale_m: float = field(init=False)

    def __post_init__(self) -> None:
        free = np.isfinite(self.costs.cost_per_m)
        self.cost_least = float(self.costs.cost_per_m[free].min()) if free.any() else 0.0
        area_m2 = float(free.sum()) * self.costs.cell_m**2
        # 2 (1 + 1/d)^(1/d) (free area / area of the unit disc)^(1/d), d = 2
        self.radius_scale_m = RADIUS_FACTOR * 2.0 * math.sqrt(1.5 * area_m2 / math.pi)
        self.goal_cells_m = self._goal_cells(free)
        self.places_m = np.zeros((self.budget.vertices, 2))
        self.g, self.lmc, self.h, self.beyond = [], [], [], []
        self.parent, self.neighbors = [], []
        self.places_m[0] = self.start_m
        self._append(self.places_m[0])
        self.g[0] = self.lmc[0] = 0.0
        self._note_goal(0)

    def sample(self, rng: np.random.Generator) -> Floats:
        """Return a place anywhere on the field, or at the goal."""
        if len(self.goal_cells_m) and rng.random() < self.budget.goal_bias:
            center_m = self.goal_cells_m[rng.integers(len(self.goal_cells_m))]
            return np.asarray(center_m + self.costs.cell_m * (rng.random(2) - 0.5))
        corner_m = np.array([self.costs.south_m, self.costs.west_m])
        return np.asarray(corner_m + rng.random(2) * self.costs.sides_m)

    def extend(self, sample_m: Floats) -> bool:
        """Add a vertex towards the sample, with edges to all free neighbours; False if blocked."""
        known_m = self.places_m[: self.count]
        away_m = np.hypot(known_m[:, 0] - sample_m[0], known_m[:, 1] - sample_m[1])
        nearest = int(away_m.argmin())
        if away_m[nearest] == 0.0:
            return False
        share = min(1.0, self.budget.step_m / float(away_m[nearest]))
        new_m = known_m[nearest] + share * (sample_m - known_m[nearest])
        apart_m = np.hypot(known_m[:, 0] - new_m[0], known_m[:, 1] - new_m[1])
        near = np.flatnonzero(apart_m <= self._radius_m())
        if nearest not in near:
            near = np.append(near, nearest)
        edge_costs = self.costs.edge_costs(new_m, known_m[near])
        self.edge_count += len(near)
        if not math.isfinite(edge_costs[near == nearest][0]):
            return False
        new = self.count
        self.count += 1
        self.places_m[new] = new_m
        self._append(new_m)
        for other, cost in zip(near.tolist(), edge_costs.tolist(), strict=True):
            if math.isfinite(cost):
                self.neighbors[new].append((other, cost))
                self.neighbors[other].append((new, cost))
                if self.g[other] + cost < self.lmc[new]:
                    self.lmc[new], self.parent[new] = self.g[other] + cost, other
        self._update(new)
        return True

    def replan(self) -> None:
        """Make every vertex consistent that a better path could lead through."""
        while self.queue and self.queue[0][:2] < (self.best_cost, self.best_cost):
            _, cost, vertex = heapq.heappop(self.queue)
            if cost != self.lmc[vertex] or self.g[vertex] <= cost:
                continue  # an entry that a later one has replaced
            self.g[vertex] = cost
            self._note_goal(vertex)
            for other, edge_cost in self.neighbors[vertex]:
                if cost + edge_cost < self.lmc[other]:
                    self.lmc[other], self.parent[other] = cost + edge_cost, vertex
                    self._update(other)

    def best_path(self) -> Path:
        """Return the path to the best vertex of the goal."""
        chain = []
        vertex = self.best
        while vertex >= 0:
            chain.append(vertex)
            vertex = self.parent[vertex]
        points_m = self.places_m[chain[::-1]]
        return Path(points_m, self.best_cost, self.edge_count)

    def _radius_m(self) -> float:
        """Return how far neighbours lie, which shrinks as the graph grows."""
        vertices = self.count + 1
        radius_m = self.radius_scale_m * math.sqrt(math.log(vertices) / vertices)
        return min(self.budget.step_m, radius_m)

    def _update(self, vertex: int) -> None:
        """Queue a vertex that is not consistent: costs only ever fall, so g is above lmc."""
        cost = self.lmc[vertex]
        if cost < self.g[vertex]:
            heapq.heappush(self.queue, (cost + self.h[vertex], cost, vertex))

    def _note_goal(self, vertex: int) -> None:
        cost = self.g[vertex] + self.beyond[vertex]
        if cost < self.best_cost:
            self.best, self.best_cost = vertex, cost

    def _append(self, place_m: Floats) -> None:
        away_m = float(self.goal.distances_m(place_m))
        self.g.append(math.inf)
        self.lmc.append(math.inf)
        self.h.append(max(0.0, away_m - self.goal.radius_m) * self._heuristic_per_m())
        self.beyond.append(self._beyond(place_m, away_m))
        self.parent.append(-1)
        self.neighbors.append([])

    def _heuristic_per_m(self) -> float:
        return min(self.cost_least, self.goal.beyond_per_m)

    def _beyond(self, place_m: Floats, away_m: float) -> float:
        """Return the cost from a place to the goal without the field; infinite off the goal."""
        if self._is_goal_inside():
            return 0.0 if away_m <= self.goal.radius_m else math.inf
        if not len(self.goal_cells_m):
            return math.inf
        apart_m = np.abs(self.goal_cells_m - place_m).max(axis=1).min()
        is_edge = apart_m <= 0.5 * self.costs.cell_m
        return max(0.0, away_m - self.goal.radius_m) * self.goal.beyond_per_m if is_edge else (
            math.inf
        )  # fmt: skip

    def _is_goal_inside(self) -> bool:
        north_m, east_m = self.costs.sides_m
        return (
            0.0 <= self.goal.north_m - self.costs.south_m < north_m
            and 0.0 <= self.goal.east_m - self.costs.west_m < east_m
        )

    def _goal_cells(self, free: npt.NDArray[np.bool_]) -> Floats:
        """Return the centres of free cells in the disc, or on the edges that face it."""
        corner_m = np.array([self.costs.south_m, self.costs.west_m])
        centers_m = corner_m + (np.indices(free.shape).transpose(1, 2, 0) + 0.5) * self.costs.cell_m
        if self._is_goal_inside():
            chosen = self.goal.distances_m(centers_m) <= self.goal.radius_m
        else:
            chosen = np.zeros_like(free)
            north_m, east_m = self.costs.sides_m
            chosen[-1, :] |= self.goal.north_m >= self.costs.south_m + north_m
            chosen[0, :] |= self.goal.north_m < self.costs.south_m
            chosen[:, -1] |= self.goal.east_m >= self.costs.west_m + east_m
            chosen[:, 0] |= self.goal.east_m < self.costs.west_m
        return np.asarray(centers_m[chosen & free])
