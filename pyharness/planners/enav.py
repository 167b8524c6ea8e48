# SPDX-License-Identifier: Apache-2.0
"""ENav: the planner that is Navlib. It sends its own records, events and products among them."""

from collections.abc import Callable, Mapping

import numpy as np

from pyharness.dp import Message
from pyharness.navlib import Navlib
from pyharness.planner import Planner
from pyharness.records import Sink


class Enav(Planner):
    """Hands every call to Navlib and passes on what Navlib sends."""

    def __init__(
        self,
        params: Mapping[str, float],
        sink: Sink,
        own_params: Mapping[str, float] | None = None,
        rng: np.random.Generator | None = None,
        time_s: float = 0.0,
    ) -> None:
        """Start Navlib with the parameters."""
        self._navlib = Navlib(params, time_s)
        super().__init__(params, sink, own_params, rng, time_s)  # sends what nav_init has sent

    def _set_kioz(self, request: Message) -> Message:
        return self._navlib.set_kioz(request)

    def _process_disparity(self, request: Message) -> Message:
        return self._navlib.process_disparity(request)

    def _analyze_terrain(self, request: Message) -> Message:
        return self._navlib.analyze_terrain(request)

    def _select_arc(self, request: Message) -> Message:
        return self._navlib.select_arc(request)

    def _evaluate_arc(self, request: Message) -> Message:
        return self._navlib.evaluate_arc(request)

    def _recorded(
        self,
        kind_in: int,  # noqa: ARG002
        kind_out: int,  # noqa: ARG002
        request: Message,
        function: Callable[[Message], Message],
    ) -> Message:
        answer = function(request)
        self._send(self._navlib.drain())
        return answer
