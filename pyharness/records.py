# SPDX-License-Identifier: Apache-2.0
"""The record stream: the only thing that recorder, metrics, pictures and GUI see of a drive."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

KIND_END = 0
"""The last record of a complete drive: not a data product, its payload is JSON text."""


@dataclass(frozen=True, slots=True)
class Record:
    """One data product of a drive.

    Attributes:
        kind: What it is, `dp.Kind`, or `KIND_END`.
        time_s: Simulated time it belongs to.
        sequence: Counts up by one, from 0.
        payload: The C struct, to its true length.
    """

    kind: int
    time_s: float
    sequence: int
    payload: bytes


Sink = Callable[[int, float, bytes], None]
"""Takes kind, time and payload of the next record."""


@dataclass(slots=True)
class RecordStream:
    """Numbers the records of a drive and hands each to every subscriber, in order."""

    subscribers: list[Callable[[Record], None]] = field(default_factory=list)
    count: int = 0

    def publish(self, kind: int, time_s: float, payload: bytes) -> None:
        """Send the next record."""
        self.forward(Record(kind, time_s, self.count, payload))

    def forward(self, record: Record) -> None:
        """Send a record that has its number already."""
        self.count = record.sequence + 1
        for subscriber in self.subscribers:
            subscriber(record)


@dataclass(frozen=True, slots=True)
class Waypoint:
    """A goal: a disc on the ground, and how to go there (a mode name in lower case)."""

    north_m: float
    east_m: float
    radius_m: float
    mode: str


@dataclass(frozen=True, slots=True)
class DriveInfo:
    """What is known of a drive before it starts and is in no data product."""

    name: str
    planner: str
    seed: int
    start_north_m: float
    start_east_m: float
    start_yaw_rad: float
    waypoints: tuple[Waypoint, ...]
    planner_params: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a drive ended: `goal_reached`, `arcs_driven`, `stopped`, or a fault and the details."""

    outcome: str
    fault_detail: str = ""

    @property
    def is_reached(self) -> bool:
        """Whether the rover did what it was told to."""
        return self.outcome in ("goal_reached", "arcs_driven")


def end_payload(outcome: Outcome) -> bytes:
    """Return the payload of the last record of a drive."""
    data = {"outcome": outcome.outcome, "fault_detail": outcome.fault_detail}
    return json.dumps(data, separators=(",", ":"), ensure_ascii=False).encode()


def read_end(payload: bytes) -> Outcome:
    """Return how a drive ended from the payload of its last record."""
    data = json.loads(payload)
    return Outcome(str(data["outcome"]), str(data["fault_detail"]))
