# SPDX-License-Identifier: Apache-2.0
"""What was driven on arcs that select_arc had passed, and whether a true limit was violated there.

Only modes that test the terrain count. Crawls and directed arcs are nobody's choice, and the limits
that select_arc takes to leave a place where nothing else passes are not those it calls safe.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from pyharness.history import History
from pyharness.status import Activity, HostEvr, Mode, Status

TIME_TOLERANCE_S = 1e-6
TERRAIN_MODES = (Mode.GUARDED, Mode.AVOID_ALL)


@dataclass(frozen=True, slots=True)
class CalledSafe:
    """Metres by what select_arc had said.

    Attributes:
        distance_m: On arcs it called safe.
        distance_leaving_m: On arcs that only the leave limits let pass.
        violations: True limits violated on arcs it called safe.
        violations_leaving: True limits violated on those that only the leave limits let pass.
    """

    distance_m: float
    distance_leaving_m: float
    violations: int
    violations_leaving: int


@dataclass(frozen=True, slots=True)
class _Passed:
    """An arc that select_arc passed."""

    time_s: float
    is_leaving: bool


def called_safe(history: History) -> CalledSafe:
    """Return what was driven on arcs that were called safe."""
    truth = history.truth
    metres = {False: 0.0, True: 0.0}
    violations = {False: 0, True: 0}
    for start_s, end_s, passed in _passed_arcs(history):
        driven_m = _distance_m(truth, end_s) - _distance_m(truth, start_s)
        metres[passed.is_leaving] += driven_m
        is_last = end_s >= float(truth["time_s"][-1]) - TIME_TOLERANCE_S
        if is_last and history.outcome.outcome == "limit_violation":
            violations[passed.is_leaving] += 1
    return CalledSafe(metres[False], metres[True], violations[False], violations[True])


def _passed_arcs(history: History) -> Iterator[tuple[float, float, _Passed]]:
    """Yield start, end and what select_arc had said of every arc that it had passed."""
    if not len(history.truth):
        return
    answers = {
        float(request["time_s"]): (request, answer) for request, answer in history.selections
    }
    unselected_s = [
        float(evr["time_s"])
        for evr in history.evrs
        if int(evr["id"]) in (HostEvr.CRAWL, HostEvr.DIRECTED_ARC)
    ]
    by_cycle: dict[int, _Passed | None] = {}
    for bar in history.timeline:
        start_s, cycle = float(bar["start_s"]), int(bar["cycle"])
        if int(bar["activity"]) == Activity.SELECT_ARC and start_s in answers:
            request, answer = answers[start_s]
            if int(answer["status"]) == Status.OK:
                # the arc of the next cycle, unless another is selected before it begins
                by_cycle[cycle + 1] = (
                    _Passed(start_s, bool(answer["is_leaving"]))
                    if int(request["mode"]) in TERRAIN_MODES
                    else None
                )
        elif int(bar["activity"]) == Activity.DRIVING:
            passed = by_cycle.get(cycle)
            if passed is not None and not any(
                passed.time_s < event_s <= start_s for event_s in unselected_s
            ):
                yield start_s, float(bar["end_s"]), passed


def _distance_m(truth: npt.NDArray[Any], time_s: float) -> float:
    """Return how far the rover had driven at a time."""
    count = int(np.searchsorted(truth["time_s"], time_s + TIME_TOLERANCE_S, side="right"))
    return float(truth["distance_driven_m"][count - 1]) if count else 0.0
