# SPDX-License-Identifier: Apache-2.0
"""GESTALT: arcs vote on a map of goodness (Goldberg, Maimone and Matthies 2002).

docs/planners.md says what follows the publications and what is an assumption.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from pyharness.dp import Kind, Message, new_message
from pyharness.params import ParamDefinition
from pyharness.planners.arcs import Floats, Place, arc_points
from pyharness.planners.cost_field import COST_UNKNOWN, CostField
from pyharness.planners.goodness import GoodnessMap, Heights, Limits, goodness_map
from pyharness.planners.mapped import (
    MappedPlanner,
    checks_terrain,
    plans_round_terrain,
    plans_round_zones,
    put_points,
    refusal,
    verdict,
)
from pyharness.records import Sink
from pyharness.status import Reason, Status

PARAMS = (
    ParamDefinition(
        "cell_heights", 2.0, 1.0, 5.0, "1",
        "heightmap cells along a side of a goodness cell [A]: 0.2 m",
    ),
    ParamDefinition(
        "map_half_m", 8.0, 3.0, 15.0, "m",
        "how far from the rover ground is judged [A]: an arc, a disc, and some metres for the "
        "second map",
    ),
    ParamDefinition(
        "disc_radius_m", 1.4, 0.3, 3.0, "m",
        "disc the size of the rover [P]; [A] its value: half the length and half the width over "
        "the wheels are 1.45 and 1.35 m",
    ),
    ParamDefinition(
        "disc_known_min", 0.4, 0.05, 1.0, "1",
        "share of a disc that must be known [A]: the shadow of a rock leaves as much",
    ),
    ParamDefinition(
        "tilt_max_deg", 20.0, 1.0, 45.0, "deg",
        "tilt of the plane at which goodness ends [P]; [A] its value: Navlib's limit less what "
        "rocks under wheels add",
    ),
    ParamDefinition(
        "roughness_max_m", 0.10, 0.005, 1.0, "m",
        "rms distance from the plane at which goodness ends [P]; [A] its value",
    ),
    ParamDefinition(
        "step_max_m", 0.35, 0.02, 1.0, "m",
        "step at which goodness ends [P]; [A] its value: the wheel drop that Navlib allows; tuned",
    ),
    ParamDefinition(
        "step_window_m", 0.6, 0.2, 2.0, "m",
        "distance over which a height difference is a step [A]: a wheel's diameter",
    ),
    ParamDefinition("arc_count", 23.0, 3.0, 101.0, "1", "forward arcs, and as many backward [A]"),
    ParamDefinition(
        "arc_length_m", 4.0, 0.5, 10.0, "m", "how far arcs are judged [A]: one and a half rovers"
    ),
    ParamDefinition(
        "curvature_max_per_m", 0.5, 0.05, 2.0, "1/m", "sharpest arc [A]: a radius of 2 m"
    ),
    ParamDefinition(
        "turn_step_deg", 20.0, 5.0, 90.0, "deg",
        "turns in place come in these steps, each followed by a straight arc [A]",
    ),
    ParamDefinition(
        "near_weight", 2.0, 1.0, 20.0, "1",
        "weight of an arc's first cell against its last [A]: what is near comes first",
    ),
    ParamDefinition(
        "unknown_goodness", 0.2, 0.0, 1.0, "1",
        "goodness of unknown ground [A]: poor, but no wall; ground to be driven at once must be "
        "known",
    ),
    ParamDefinition(
        "weight_hazard", 1.0, 0.0, 100.0, "1", "weight of the vote for goodness [P]; [A] its value"
    ),
    ParamDefinition(
        "weight_goal", 1.0, 0.0, 100.0, "1", "weight of the vote for the goal [P]; [A] its value"
    ),
    ParamDefinition(
        "weight_steering", 0.1, 0.0, 100.0, "1",
        "weight of the vote for little steering [P]; [A] its value",
    ),
    ParamDefinition(
        "global_planner", 0.0, 0.0, 1.0, "1",
        "1: the cost from the arc's end to the goal takes the goal vote's place, as with Field D* "
        "[P]",
    ),
)  # fmt: skip

SPACING_M = 0.1
REACH_LEAST_M = 1.0
POSES_MAX = len(new_message(Kind.EVALUATE_ARC_OUT)["bounds"])


class Gestalt(MappedPlanner):
    """Chooses the arc with the largest sum of votes among those that cross no impassable cell."""

    OWN_PARAMS: ClassVar[tuple[ParamDefinition, ...]] = PARAMS

    def __init__(
        self,
        params: Mapping[str, float],
        sink: Sink,
        own_params: Mapping[str, float] | None = None,
        rng: np.random.Generator | None = None,
        time_s: float = 0.0,
    ) -> None:
        """Start with nothing judged."""
        super().__init__(params, sink, own_params, rng, time_s)
        own = self.own_params
        self._limits = Limits(
            cell_heights=round(own["cell_heights"]),
            disc_radius_m=own["disc_radius_m"],
            disc_known_min=own["disc_known_min"],
            step_window_m=own["step_window_m"],
            tilt_max_rad=math.radians(own["tilt_max_deg"]),
            roughness_max_m=own["roughness_max_m"],
            step_max_m=own["step_max_m"],
        )
        self._map: GoodnessMap | None = None
        self._field = CostField() if own["global_planner"] else None

    def _analyze_terrain(self, request: Message) -> Message:
        answer = super()._analyze_terrain(request)
        if answer["status"] == Status.OK:
            place = Place.of(request["pose"])
            self._map = goodness_map(
                cut_out(self._heights(), place, self.own_params["map_half_m"], self._limits),
                self._limits,
            )
            if self._field is not None:
                self._field.take(self._map, place)
        return answer

    def _select_arc(self, request: Message) -> Message:
        if self._map is None:
            return refusal(Kind.SELECT_ARC_OUT)
        place, mode = Place.of(request["pose"]), int(request["mode"])
        candidates = make_candidates(self.own_params, _reach_m(self.own_params, place, request))
        points = arc_points(
            place, candidates.length_m, candidates.heading_rad, SPACING_M, candidates.turn_rad
        )
        goodness, worst = self._map.at(points)
        votes = self._goal_votes(place, points, request)
        votes *= self.own_params["weight_goal"]
        votes += self.own_params["weight_steering"] * _steering_votes(
            candidates, request, self.own_params["curvature_max_per_m"]
        )
        if plans_round_terrain(mode):
            votes += self.own_params["weight_hazard"] * self._hazard_votes(goodness)
        reasons = self._reasons(points, goodness, worst, mode, _zone_margin_m(request))
        found = first_reasons(reasons)
        allowed = found == Reason.NONE if plans_round_zones(mode) else np.ones_like(found, np.bool_)
        best = int(np.where(allowed, votes, -np.inf).argmax())
        return self._selection(candidates, points, found, best)

    def _evaluate_arc(self, request: Message) -> Message:
        if self._map is None:
            return refusal(Kind.EVALUATE_ARC_OUT)
        arc, mode = request["arc"], int(request["mode"])
        length_m, heading_rad = float(arc["length_m"]), float(arc["heading_change_rad"])
        spacing_m = max(SPACING_M, abs(length_m) / POSES_MAX)
        points = arc_points(Place.of(request["pose"]), length_m, heading_rad, spacing_m)
        goodness, worst = self._map.at(points)
        if length_m == 0.0 and heading_rad != 0.0:
            goodness[:] = 1.0  # turns in place stay on the ground the rover stands on
        reasons = self._reasons(points, goodness, worst, mode, _zone_margin_m(request))[0]
        share = np.arange(1, len(reasons) + 1) / len(reasons)
        return verdict(reasons, share * (abs(length_m) or abs(heading_rad)))

    def _reasons(
        self,
        points: Floats,
        goodness: Floats,
        worst: npt.NDArray[np.uint8],
        mode: int,
        zone_margin_m: float,
    ) -> npt.NDArray[np.uint8]:
        """Return why a point [arc, point] may not be driven over in this mode.

        Unknown ground is only forbidden in the part that is driven before the next selection.
        """
        reasons = np.full(goodness.shape, Reason.NONE, dtype=np.uint8)
        if checks_terrain(mode):
            near = round(self.params["execute_length_m"] / SPACING_M)
            unknown = np.isnan(goodness)
            unknown[:, near:] = False
            impassable = (goodness == 0.0) | unknown
            reasons[impassable] = worst[impassable]
        reasons[self._forbidden(points, zone_margin_m)] = Reason.KIOZ
        return reasons

    def _hazard_votes(self, goodness: Floats) -> Floats:
        """Return the mean goodness of each arc, near cells with more weight."""
        known = np.where(np.isnan(goodness), self.own_params["unknown_goodness"], goodness)
        weights = np.linspace(self.own_params["near_weight"], 1.0, goodness.shape[1])
        return np.asarray(np.average(known, axis=1, weights=weights))

    def _goal_votes(self, place: Place, points: Floats, request: Message) -> Floats:
        """Return 1 for the arc that leads best to the goal down to 0 for the worst."""
        goal_m = np.array([float(request["goal"]["x_site_m"]), float(request["goal"]["y_site_m"])])
        here_m, ends_m = np.array([place.x_m, place.y_m]), points[:, -1]
        if self._field is not None:
            back_and_forth = 2.0 * self.own_params["arc_length_m"] * COST_UNKNOWN
            radius_m = float(request["goal"]["radius_m"])
            cost = self._field.cost_to_go(goal_m, radius_m, ends_m)
            return falling_votes(cost, back_and_forth)
        along, ahead = ends_m - here_m, goal_m - here_m
        cosine = along @ ahead / (np.hypot(*along.T) * np.hypot(*ahead) + 1e-9)
        return np.asarray(0.5 + 0.5 * cosine)

    def _selection(
        self,
        candidates: "Candidates",
        points: Floats,
        found: npt.NDArray[np.uint8],
        best: int,
    ) -> Message:
        answer = new_message(Kind.SELECT_ARC_OUT)
        answer["paths_tested"] = len(found)
        answer["rejections"] = np.bincount(found, minlength=len(answer["rejections"]))
        if found[best] != Reason.NONE:
            answer["status"] = Status.NO_PATH
            return answer
        answer["rejections"][Reason.COST] += answer["rejections"][Reason.NONE] - 1
        answer["rejections"][Reason.NONE] = 1
        answer["path_index"] = best
        turn_rad, length_m = candidates.turn_rad[best], candidates.length_m[best]
        if turn_rad:
            answer["arc"]["heading_change_rad"] = turn_rad
        else:
            part = min(1.0, self.params["execute_length_m"] / abs(length_m))
            answer["arc"]["length_m"] = part * length_m
            answer["arc"]["heading_change_rad"] = part * candidates.heading_rad[best]
        put_points(answer, "path_points", points[best])
        return answer


@dataclass(frozen=True, slots=True)
class Candidates:
    """A turn in place, or none, and an arc after it."""

    turn_rad: Floats
    length_m: Floats
    heading_rad: Floats


def make_candidates(own: Mapping[str, float], reach_m: float) -> Candidates:
    """Return arcs forward and backward, and turns in place with a straight arc after each."""
    half = own["curvature_max_per_m"]
    curvature_per_m = np.linspace(-half, half, round(own["arc_count"]))
    turn_count = max(1, math.floor(180.0 / own["turn_step_deg"]))
    right_rad = np.radians(own["turn_step_deg"]) * np.arange(1, turn_count + 1)
    turn_rad = np.concatenate([right_rad, -right_rad])
    length_m = np.repeat(
        [reach_m, -reach_m, reach_m], [len(curvature_per_m), len(curvature_per_m), len(turn_rad)]
    )
    none = np.zeros(2 * len(curvature_per_m))
    heading_rad = np.concatenate([curvature_per_m, curvature_per_m, np.zeros_like(turn_rad)])
    return Candidates(np.concatenate([none, turn_rad]), length_m, heading_rad * reach_m)


def cut_out(heights: Heights, place: Place, half_m: float, limits: Limits) -> Heights:
    """Return the heights around a place, their edges on those of goodness cells."""
    side, cell_m = limits.cell_heights, heights.cell_m
    spans = []
    for first, count, middle_m in (
        (heights.first_row, heights.z_m.shape[0], place.x_m),
        (heights.first_col, heights.z_m.shape[1], place.y_m),
    ):
        low = max(first, math.floor((middle_m - half_m) / cell_m))
        high = min(first + count, math.floor((middle_m + half_m) / cell_m))
        low, high = -(-low // side) * side, high // side * side
        spans.append(slice(low - first, max(low, high) - first))
    rows, cols = spans
    return Heights(
        heights.z_m[rows, cols], heights.first_row + rows.start, heights.first_col + cols.start,
        cell_m,
    )  # fmt: skip


def first_reasons(reasons: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """Return the first reason along each arc [arc, point], NONE where there is none."""
    first = (reasons != Reason.NONE).argmax(axis=1)
    return np.asarray(reasons[np.arange(len(reasons)), first])


def falling_votes(cost: Floats, span: float) -> Floats:
    """Return 1 for the least cost down to 0 for what costs more by the span."""
    return np.asarray(np.clip(1.0 - (cost - cost.min()) / span, 0.0, 1.0))


def _steering_votes(candidates: Candidates, request: Message, curvature_max_per_m: float) -> Floats:
    """Return 1 for no steering and no turning, 0 for the most of it."""
    now_per_m = float(request["steering"]["curvature_per_m"])
    curvature_per_m = candidates.heading_rad / candidates.length_m
    arcs = 1.0 - np.abs(curvature_per_m - now_per_m) / (2.0 * curvature_max_per_m)
    turns = 0.5 - 0.5 * np.abs(candidates.turn_rad) / np.pi
    return np.where(candidates.turn_rad == 0.0, np.clip(arcs, 0.0, 1.0), turns)


def _reach_m(own: Mapping[str, float], place: Place, request: Message) -> float:
    """Return how far arcs are judged: not beyond where the straight one enters the goal's disc."""
    goal = request["goal"]
    away_m = math.hypot(goal["x_site_m"] - place.x_m, goal["y_site_m"] - place.y_m)
    return max(REACH_LEAST_M, min(own["arc_length_m"], away_m - float(goal["radius_m"])))


def _zone_margin_m(request: Message) -> float:
    return float(request["uncertainty"]["global_position_m"])
