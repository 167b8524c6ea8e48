# SPDX-License-Identifier: Apache-2.0
"""What a planner is: SIM's four interface functions and the zones, in Navlib's own records.

A planner of your own is a class in a file of your own (`--planner file.py:Class`) or an entry point
in the group `enav_sim.planners`:

    class MyPlanner(Planner):
        def _process_disparity(self, request): ...
        def _analyze_terrain(self, request): ...
        def _select_arc(self, request): ...
        def _evaluate_arc(self, request): ...

Each takes the `..._IN` record of `dp` and returns the `..._OUT` record. What goes in and out is
recorded by the base class, so recording, metrics and pictures are the same for all planners.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping
from typing import ClassVar

import numpy as np

from pyharness.dp import Kind, Message, init_request, new_message, used_bytes
from pyharness.params import ParamDefinition
from pyharness.records import Sink


class Planner(ABC):
    """Base class of planners.

    Attributes:
        OWN_PARAMS: What a scenario may set under `planner_params`.
        params: Navlib's parameters, which also describe the vehicle.
        own_params: Value of every one of OWN_PARAMS.
        rng: Where chance comes from; a drive gives a generator made from its seed.
    """

    OWN_PARAMS: ClassVar[tuple[ParamDefinition, ...]] = ()

    def __init__(
        self,
        params: Mapping[str, float],
        sink: Sink,
        own_params: Mapping[str, float] | None = None,
        rng: np.random.Generator | None = None,
        time_s: float = 0.0,
    ) -> None:
        """Keep all that, and record Navlib's; `own_params` left out have their defaults."""
        self.params = params
        self.own_params = own_param_values(type(self), own_params or {})
        self.rng = rng or np.random.default_rng(0)
        self._sink = sink
        request = init_request(params, time_s)
        self._recorded(Kind.INIT_IN, Kind.INIT_OUT, request, self._init)

    def set_kioz(self, request: Message) -> Message:
        """Replace the keep-in and keep-out zones."""
        return self._recorded(Kind.SET_KIOZ_IN, Kind.SET_KIOZ_OUT, request, self._set_kioz)

    def process_disparity(self, request: Message) -> Message:
        """Take in a chunk of the point cloud of one stereo pair."""
        return self._recorded(
            Kind.PROCESS_DISPARITY_IN,
            Kind.PROCESS_DISPARITY_OUT,
            request,
            self._process_disparity,
        )

    def analyze_terrain(self, request: Message) -> Message:
        """Assess the terrain taken in so far, for a pose and a goal."""
        return self._recorded(
            Kind.ANALYZE_TERRAIN_IN, Kind.ANALYZE_TERRAIN_OUT, request, self._analyze_terrain
        )

    def select_arc(self, request: Message) -> Message:
        """Choose the next arc from a predicted pose."""
        return self._recorded(Kind.SELECT_ARC_IN, Kind.SELECT_ARC_OUT, request, self._select_arc)

    def evaluate_arc(self, request: Message) -> Message:
        """Say whether an arc is safe."""
        return self._recorded(
            Kind.EVALUATE_ARC_IN, Kind.EVALUATE_ARC_OUT, request, self._evaluate_arc
        )

    def _init(self, request: Message) -> Message:  # noqa: ARG002
        """Answer that the parameters are taken."""
        answer = new_message(Kind.INIT_OUT)
        answer["refused_index"] = len(self.params)
        return answer

    def _set_kioz(self, request: Message) -> Message:
        """Take zones; the default ignores them, which is right only when there are none."""
        if int(request["zone_count"]):
            raise NotImplementedError(f"{type(self).__name__} knows no zones")
        return new_message(Kind.SET_KIOZ_OUT)

    @abstractmethod
    def _process_disparity(self, request: Message) -> Message: ...

    @abstractmethod
    def _analyze_terrain(self, request: Message) -> Message: ...

    @abstractmethod
    def _select_arc(self, request: Message) -> Message: ...

    @abstractmethod
    def _evaluate_arc(self, request: Message) -> Message: ...

    def _recorded(
        self,
        kind_in: int,
        kind_out: int,
        request: Message,
        function: Callable[[Message], Message],
    ) -> Message:
        answer = function(request)
        time_s = float(request["time_s"])
        pairs = ((kind_in, request), (kind_out, answer))
        self._send((kind, time_s, used_bytes(kind, item)) for kind, item in pairs)
        return answer

    def _send(self, records: Iterable[tuple[int, float, bytes]]) -> None:
        for kind, time_s, payload in records:
            self._sink(kind, time_s, payload)


def own_param_values(planner_class: type[Planner], given: Mapping[str, float]) -> dict[str, float]:
    """Return all parameters of a planner: the defaults, replaced where given."""
    return {row.name: given.get(row.name, row.default) for row in planner_class.OWN_PARAMS}


def own_param_faults(planner_class: type[Planner], given: Mapping[str, float]) -> Mapping[str, str]:
    """Return what is wrong with the values given, by name."""
    table = {row.name: row for row in planner_class.OWN_PARAMS}
    known = ", ".join(table) or "none"
    faults = {
        name: table[name].fault(value) if name in table else f"unknown parameter (known: {known})"
        for name, value in given.items()
    }
    return {name: fault for name, fault in faults.items() if fault is not None}
