# SPDX-License-Identifier: Apache-2.0
"""RRT# on Navlib's costmap; the next arc leads onto its path.

docs/planners.md says what follows the publication and what is an assumption.
"""

import math
from collections.abc import Iterator, Mapping
from itertools import islice
from typing import ClassVar

import numpy as np
import numpy.typing as npt
from scipy.ndimage import grey_dilation

from pyharness.dp import Kind, Message, new_message
from pyharness.params import ParamDefinition
from pyharness.planners.arcs import Floats, Place, arc_points, wrapped
from pyharness.planners.mapped import (
    MappedPlanner,
    checks_terrain,
    plans_round_terrain,
    plans_round_zones,
    put_points,
    refusal,
    verdict,
)
from pyharness.planners.rrt_graph import Budget, Field, Goal, Path, find_path
from pyharness.records import Sink
from pyharness.status import Reason, Status

PARAMS = (
    ParamDefinition(
        "vertices", 400.0, 10.0, 20000.0, "1",
        "vertices of the graph, anew in every call [A]: paths 6 to 11 % dearer than the best on "
        "the fields of the tests, at a few seconds of computing a drive",
    ),
    ParamDefinition(
        "step_m", 6.0, 0.5, 50.0, "m",
        "longest edge, and farthest neighbour [A]: longer ones reach better paths sooner",
    ),
    ParamDefinition("goal_bias", 0.05, 0.0, 1.0, "1", "share of samples at the goal [O]"),
    ParamDefinition(
        "horizon_m", 12.5, 3.0, 25.0, "m",
        "half side of the part of the costmap that is searched [A]: stereo sees not much farther",
    ),
    ParamDefinition(
        "roughness_max_m", 0.06, 0.005, 10.0, "m",
        "rms distance from a costmap cell's plane that blocks it [A]: the costmap leaves rocks to "
        "ACE, which RRT# has not",
    ),
    ParamDefinition(
        "grow_m", 0.5, 0.0, 3.0, "m",
        "cells this near to a blocked one are blocked too [A]: half the rover's width over the "
        "wheels is more than half a patch",
    ),
    ParamDefinition(
        "start_free_m", 1.5, 0.0, 5.0, "m",
        "when the rover stands in a blocked cell, cells that terrain blocks this near to it count "
        "as unknown ground [A]: it must be able to leave",
    ),
    ParamDefinition(
        "lookahead_m", 2.0, 0.2, 10.0, "m",
        "point of the path that the arc leads to; halved while that arc is blocked [A]",
    ),
    ParamDefinition(
        "turn_min_deg", 45.0, 5.0, 180.0, "deg",
        "bearing of that point from which the rover turns in place [A]",
    ),
)  # fmt: skip

SPACING_M = 0.25
LOOKAHEAD_LEAST_M = 0.4
TURN_LEAST_RAD = 0.05
POSES_MAX = len(new_message(Kind.EVALUATE_ARC_OUT)["bounds"])


class RrtSharp(MappedPlanner):
    """Plans with RRT#, follows its path by constant-curvature arcs and turns in place."""

    OWN_PARAMS: ClassVar[tuple[ParamDefinition, ...]] = PARAMS

    def __init__(
        self,
        params: Mapping[str, float],
        sink: Sink,
        own_params: Mapping[str, float] | None = None,
        rng: np.random.Generator | None = None,
        time_s: float = 0.0,
    ) -> None:
        """Start without a path."""
        super().__init__(params, sink, own_params, rng, time_s)
        self._budget = Budget(
            vertices=round(self.own_params["vertices"]),
            step_m=self.own_params["step_m"],
            goal_bias=self.own_params["goal_bias"],
        )
        self._last_points_m: Floats = np.zeros((0, 2))

    def _select_arc(self, request: Message) -> Message:
        if not self._is_analyzed:
            return refusal(Kind.SELECT_ARC_OUT)
        place, mode = Place.of(request["pose"]), int(request["mode"])
        terrain, zones = plans_round_terrain(mode), plans_round_zones(mode)
        costs, _ = self._field(place, terrain, zones)
        path = find_path(
            costs, (place.x_m, place.y_m), self._goal(request), self._budget, self.rng,
            self._last_points_m,
        )  # fmt: skip
        answer = new_message(Kind.SELECT_ARC_OUT)
        answer["paths_tested"] = path.edge_count
        self._last_points_m = path.points_m[1:]
        reasons = self._follow(answer, place, mode, path)
        for reason in reasons:
            answer["rejections"][reason] += 1
        if Reason.NONE not in reasons:
            answer["status"] = Status.NO_PATH
            return answer
        answer["path_cost_s"] = answer["cost_to_go_s"] = path.cost
        put_points(answer, "global_points", path.points_m)
        return answer

    def _follow(self, answer: Message, place: Place, mode: int, path: Path) -> list[int]:
        """Write the first arc towards the path that may be driven; return the verdict on each."""
        reasons: list[int] = []
        # where nothing is avoided the first arc is driven or refused
        count_max = None if plans_round_zones(mode) else 1
        for length_m, heading_rad in islice(self._arcs(place, path.points_m), count_max):
            found, _ = self._check(place, length_m, heading_rad, mode)
            failing = found[found != Reason.NONE]
            reasons.append(int(failing[0]) if len(failing) else int(Reason.NONE))
            if not len(failing):
                answer["arc"]["length_m"] = length_m
                answer["arc"]["heading_change_rad"] = heading_rad
                line_m = arc_points(place, length_m, heading_rad, SPACING_M)[0]
                put_points(answer, "path_points", line_m)
                break
        return reasons or [int(Reason.UNEXPECTED)]

    def _evaluate_arc(self, request: Message) -> Message:
        if not self._is_analyzed:
            return refusal(Kind.EVALUATE_ARC_OUT)
        arc = request["arc"]
        return verdict(
            *self._check(
                Place.of(request["pose"]),
                float(arc["length_m"]),
                float(arc["heading_change_rad"]),
                int(request["mode"]),
            )
        )

    def _check(
        self, place: Place, length_m: float, heading_rad: float, mode: int
    ) -> tuple[npt.NDArray[np.uint8], Floats]:
        """Return why each pose of an arc is blocked, and where it lies along the arc.

        An arc is safe when no pose lies in a blocked cell of the costmap: the publication knows no
        other check, and the footprint of the rover is that of the costmap's patches.
        """
        spacing_m = max(SPACING_M, abs(length_m) / POSES_MAX)
        points_m = arc_points(place, length_m, heading_rad, spacing_m)[0]
        costs, cell_reasons = self._field(place, checks_terrain(mode), True)
        blocked = ~np.isfinite(costs.at(points_m))
        own = Field(cell_reasons, costs.south_m, costs.west_m, costs.cell_m).at(points_m)
        reasons = np.where(np.isfinite(own), own, Reason.UNKNOWN)
        share = np.arange(1, len(points_m) + 1) / len(points_m)
        return (
            np.where(blocked, reasons, Reason.NONE).astype(np.uint8),
            share * (abs(length_m) or abs(heading_rad)),
        )

    def _arcs(self, place: Place, points_m: Floats) -> Iterator[tuple[float, float]]:
        """Yield arcs onto the path: to points ahead on it, nearer and nearer; at last a turn."""
        if len(points_m) < 2:
            return
        lookahead_m = self.own_params["lookahead_m"]
        while lookahead_m >= LOOKAHEAD_LEAST_M:
            ahead_m = point_along(points_m, lookahead_m) - (place.x_m, place.y_m)
            bearing_rad = wrapped(math.atan2(ahead_m[1], ahead_m[0]) - place.yaw_rad)
            if abs(bearing_rad) > math.radians(self.own_params["turn_min_deg"]):
                yield 0.0, bearing_rad
            else:
                yield self._part(*arc_to(float(np.hypot(*ahead_m)), bearing_rad))
            lookahead_m *= 0.5
        if abs(bearing_rad) > TURN_LEAST_RAD:
            yield 0.0, bearing_rad

    def _part(self, length_m: float, heading_rad: float) -> tuple[float, float]:
        """Return the part of an arc that is driven before the next selection."""
        share = min(1.0, self.params["execute_length_m"] / length_m)
        return share * length_m, share * heading_rad

    def _goal(self, request: Message) -> Goal:
        goal = request["goal"]
        return Goal(
            float(goal["x_site_m"]),
            float(goal["y_site_m"]),
            float(goal["radius_m"]),
            self._unknown_cost_s_per_m,
        )

    @property
    def _unknown_cost_s_per_m(self) -> float:
        return self.params["cost_unknown_factor"] / self.params["speed_max_m_per_s"]

    def _field(self, place: Place, use_terrain: bool, use_zones: bool) -> tuple[Field, Floats]:
        """Return the costs around a place, and the reasons of blocked cells."""
        costmap = self._costmap()
        cell_m = float(costmap["cell_m"])
        side = math.isqrt(len(costmap["cells"]))
        cells = costmap["cells"].reshape(side, side)
        origin = np.array([int(costmap["origin_row"]), int(costmap["origin_col"])])
        here = np.floor(np.array([place.x_m, place.y_m]) / cell_m).astype(np.int64) - origin
        reach = round(self.own_params["horizon_m"] / cell_m)
        low, high = np.clip(here - reach, 0, side), np.clip(here + reach, 0, side)
        cells = cells[low[0] : high[0], low[1] : high[1]]
        south_m, west_m = (origin + low) * cell_m
        rows, cols = np.indices(cells.shape)
        away_m = np.hypot(
            south_m + (rows + 0.5) * cell_m - place.x_m, west_m + (cols + 0.5) * cell_m - place.y_m
        )
        reasons = np.full(cells.shape, float(Reason.NONE))
        cost = cells["cost_s_per_m"].astype(np.float64)
        if use_terrain:
            rough_m2 = self.own_params["roughness_max_m"] ** 2
            reasons[cells["roughness_m2"] > rough_m2] = Reason.CLEARANCE
            steep = cells["terrain_reason"] != Reason.NONE
            reasons[steep] = cells["terrain_reason"][steep]
            _grow(reasons, self.own_params["grow_m"] / cell_m)
            if (reasons[away_m == away_m.min()] != Reason.NONE).any():
                beside = (reasons != Reason.NONE) & (away_m <= self.own_params["start_free_m"])
                reasons[beside] = Reason.NONE
                cost[beside] = np.maximum(cost[beside], self._unknown_cost_s_per_m)
        if use_zones:
            reasons[cells["is_forbidden"] != 0] = Reason.KIOZ
        cost[reasons != Reason.NONE] = np.inf
        return Field(cost, float(south_m), float(west_m), cell_m), reasons


def _grow(reasons: Floats, radius_cells: float) -> None:
    """Let blocked cells block those around them."""
    reach = math.floor(radius_cells)
    offsets = np.arange(-reach, reach + 1)
    disc = np.hypot(offsets[:, None], offsets) <= radius_cells
    grown = grey_dilation(reasons, footprint=disc, mode="nearest")
    free = reasons == Reason.NONE
    reasons[free] = grown[free]


def point_along(points_m: Floats, distance_m: float) -> Floats:
    """Return the point of a polyline at a distance from its start, or its end."""
    steps_m = np.hypot(*np.diff(points_m, axis=0).T)
    along_m = np.concatenate([[0.0], np.cumsum(steps_m)])
    return np.array([np.interp(distance_m, along_m, points_m[:, axis]) for axis in (0, 1)])


def arc_to(distance_m: float, bearing_rad: float) -> tuple[float, float]:
    """Return length and heading change of the arc to a point, tangent to the heading now."""
    return distance_m / float(np.sinc(bearing_rad / np.pi)), 2.0 * bearing_rad
