# SPDX-License-Identifier: Apache-2.0
"""What a record stream tells about a drive, sorted: the input of metrics and pictures."""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from pyharness.dp import Kind, Message, Schema
from pyharness.params import param_values
from pyharness.records import KIND_END, DriveInfo, Outcome, Record, read_end

UNFINISHED = Outcome("unfinished", "the records end before the drive does")


@dataclass(slots=True)
class History:
    """Takes in the records of one drive, in order.

    Attributes:
        estimates: What the rover believed, after each fix and at the start of each arc.
        selections: One pair of request and answer for every planning cycle.
        distances_m: True distance driven at each of them.
        evaluations: Every evaluate_arc, request and answer.
        timeline: What the executive did.
        evrs: Event reports, of Navlib and of the executive.
        analysis: The last answer of analyze_terrain.
        zones: The last zones set.
        params: Navlib's parameters, where the planner reports them; else the defaults.
    """

    schema: Schema
    info: DriveInfo
    estimates: list[Message] = field(default_factory=list)
    selections: list[tuple[Message, Message]] = field(default_factory=list)
    distances_m: list[float] = field(default_factory=list)
    evaluations: list[tuple[Message, Message]] = field(default_factory=list)
    timeline: list[Message] = field(default_factory=list)
    evrs: list[Message] = field(default_factory=list)
    analysis: Message | None = None
    zones: Message | None = None
    params: dict[str, float] = field(default_factory=lambda: param_values({}))
    outcome: Outcome = UNFINISHED
    _request: Message | None = None
    _next_sequence: int = 0
    _truths: list[bytes] = field(default_factory=list)

    def take(self, record: Record) -> None:
        """Take in the next record; kinds that are not needed are passed over.

        An answer whose request is lost is passed over too.
        """
        if record.sequence != self._next_sequence:
            self._request = None
        self._next_sequence = record.sequence + 1
        if record.kind == KIND_END:
            self.outcome = read_end(record.payload)
        elif record.kind == Kind.TRUTH:
            size_bytes = self.schema.kind_dtype(record.kind).itemsize
            self._truths.append(record.payload.ljust(size_bytes, b"\0"))
        elif record.kind in _WANTED:
            self._sort(record.kind, self.schema.decode(record.kind, record.payload))

    @property
    def truth(self) -> npt.NDArray[Any]:
        """Ground truth of all ticks so far."""
        return np.frombuffer(b"".join(self._truths), dtype=self.schema.kind_dtype(Kind.TRUTH))

    @property
    def heightmap_size_m(self) -> float:
        """Side of the heightmap."""
        cells = self.schema.kind_dtype(Kind.SURFACE)["z_site_m"].shape[0]
        return math.isqrt(cells) * self.params["heightmap_cell_m"]

    def _sort(self, kind: int, message: Message) -> None:
        if kind in (Kind.SELECT_ARC_IN, Kind.EVALUATE_ARC_IN):
            self._request = message
        elif kind == Kind.SELECT_ARC_OUT and self._request is not None:
            self.selections.append((self._request, message))
            self.distances_m.append(self._distance_m())
        elif kind == Kind.EVALUATE_ARC_OUT and self._request is not None:
            self.evaluations.append((self._request, message))
        elif kind == Kind.ESTIMATE:
            self.estimates.append(message)
        elif kind == Kind.TIMELINE:
            self.timeline.append(message)
        elif kind in (Kind.EVR, Kind.HOST_EVR):
            self.evrs.append(message)
        elif kind == Kind.ANALYZE_TERRAIN_OUT:
            self.analysis = message
        elif kind == Kind.SET_KIOZ_IN:
            self.zones = message
        elif kind == Kind.INIT_IN:
            names = self.schema.parameters
            self.params |= dict(zip(names, message["params"].tolist(), strict=False))

    def _distance_m(self) -> float:
        if not self._truths:
            return 0.0
        return float(self.schema.decode(Kind.TRUTH, self._truths[-1])["distance_driven_m"])


_WANTED = frozenset(
    {
        Kind.SELECT_ARC_IN,
        Kind.SELECT_ARC_OUT,
        Kind.EVALUATE_ARC_IN,
        Kind.EVALUATE_ARC_OUT,
        Kind.ESTIMATE,
        Kind.TIMELINE,
        Kind.EVR,
        Kind.HOST_EVR,
        Kind.ANALYZE_TERRAIN_OUT,
        Kind.SET_KIOZ_IN,
        Kind.INIT_IN,
    }
)
