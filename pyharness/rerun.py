# SPDX-License-Identifier: Apache-2.0
"""Re-run: the recorded inputs go to a planner once more, and its outputs are compared."""

from collections import deque
from collections.abc import Callable, Generator, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from pyharness.clib import lib
from pyharness.dp import (
    Kind,
    Message,
    Schema,
    is_native_layout,
    layout_difference,
    native_schema,
    to_native,
)
from pyharness.errors import RerunError
from pyharness.planner import Planner
from pyharness.records import KIND_END, DriveInfo, Record, RecordStream, Sink
from sim.random_streams import rng_for

PlannerClass = Callable[..., Planner]

_CALLS: Mapping[int, Callable[[Planner, Message], Message]] = {
    Kind.SET_KIOZ_IN: Planner.set_kioz,
    Kind.PROCESS_DISPARITY_IN: Planner.process_disparity,
    Kind.ANALYZE_TERRAIN_IN: Planner.analyze_terrain,
    Kind.SELECT_ARC_IN: Planner.select_arc,
    Kind.EVALUATE_ARC_IN: Planner.evaluate_arc,
}


def is_of_planner(record: Record) -> bool:
    """Whether a record is an input or an output of the planner, not of its host."""
    return 0 < record.kind <= int(lib.NAV_DP_COUNT)


def unbroken(records: Iterable[Record]) -> Generator[Record]:
    """Yield records until one is missing: what comes behind a gap cannot be run again."""
    for index, record in enumerate(records):
        if record.sequence != index:
            return
        yield record


def planner_of(planner_class: type[Planner], info: DriveInfo) -> PlannerClass:
    """Return what starts a planner as a drive did: with its own parameters and random stream."""

    def make(params: Mapping[str, float], sink: Sink, **more: float) -> Planner:
        rng = rng_for(info.seed, "planner")
        return planner_class(params, sink, info.planner_params, rng, **more)

    return make


class Feeder:
    """Gives recorded inputs to a planner that is made when the first, its parameters, comes.

    Attributes:
        planner: None until then.
        call_count: Inputs given.
    """

    def __init__(
        self,
        schema: Schema,
        planner_class: PlannerClass,
        sink: Sink,
        changed_params: Mapping[str, float] | None = None,
    ) -> None:
        """Check that the records mean the same to this program as to the one that wrote them.

        Raises:
            RerunError: They do not.
        """
        difference = layout_difference(schema)
        if difference is not None:
            raise RerunError(
                f"recorded by another version: {difference}; readable, not re-runnable"
            )
        self.planner: Planner | None = None
        self.call_count = 0
        self._schema = schema
        self._planner_class = planner_class
        self._sink = sink
        self._changed_params = changed_params or {}

    def feed(self, record: Record) -> None:
        """Give one record to the planner if it is an input.

        Raises:
            RerunError: The planner cannot take it.
        """
        if record.kind not in _CALLS and record.kind != Kind.INIT_IN:
            return
        if self.planner is None and record.kind != Kind.INIT_IN:
            raise RerunError("the parameters (INIT_IN) are not among the records")
        self.call_count += 1
        payload = to_native(self._schema, record.kind, record.payload)
        request = native_schema().decode(record.kind, payload).copy()  # a planner may write in it
        try:
            if record.kind == Kind.INIT_IN:
                self.planner = self._make_planner(request)
            elif self.planner is not None:
                _CALLS[record.kind](self.planner, request)
        except Exception as error:
            name = Kind(record.kind).name
            raise RerunError(f"record {record.sequence}, {name}: {error}") from error

    def _make_planner(self, request: Message) -> Planner:
        names = native_schema().parameters
        recorded = dict(zip(names, request["params"].tolist(), strict=True))
        time_s = float(request["time_s"])
        more = {} if time_s == 0.0 else {"time_s": time_s}
        return self._planner_class({**recorded, **self._changed_params}, self._sink, **more)


# ------------------------------------------------------------------ comparing


@dataclass(frozen=True, slots=True)
class Difference:
    """The first record in which a re-run differs from what was recorded."""

    sequence: int
    kind: str
    time_s: float
    field: str
    recorded: str
    rerun: str

    def __str__(self) -> str:
        return (
            f"record {self.sequence}, {self.kind} at {self.time_s:.3f} s, {self.field}:"
            f" recorded {self.recorded}, re-run {self.rerun}"
        )


@dataclass(frozen=True, slots=True)
class Comparison:
    """How far a re-run was compared, and the first difference."""

    call_count: int
    record_count: int
    difference: Difference | None


def compare(records: Iterable[Record], schema: Schema, planner_class: PlannerClass) -> Comparison:
    """Run a drive's inputs again and compare every record of the planner byte for byte.

    Records that end before their end record may end within a call, which is no difference.
    """
    recorded: deque[Record] = deque()
    again: deque[tuple[int, float, bytes]] = deque()
    feeder = Feeder(schema, planner_class, lambda *record: again.append(record))
    record_count = 0
    last_sequence, last_time_s = 0, 0.0
    is_ended = False
    for record in records:
        if not is_of_planner(record):
            is_ended = record.kind == KIND_END
            continue
        last_sequence, last_time_s = record.sequence, record.time_s
        recorded.append(record)
        feeder.feed(record)
        while recorded and again:
            old, new = recorded.popleft(), again.popleft()
            difference = difference_of(schema, old, new)
            if difference is not None:
                return Comparison(feeder.call_count, record_count, difference)
            record_count += 1
    difference = None
    if recorded:
        old = recorded[0]
        name = Kind(old.kind).name
        difference = Difference(old.sequence, name, old.time_s, "kind", name, "nothing")
    elif again and is_ended:
        name = Kind(again[0][0]).name
        difference = Difference(last_sequence + 1, name, last_time_s, "kind", "nothing", name)
    return Comparison(feeder.call_count, record_count, difference)


def difference_of(schema: Schema, old: Record, new: tuple[int, float, bytes]) -> Difference | None:
    """Return the first field in which a record of this machine differs from a recorded one."""
    kind, time_s, payload = new
    name = Kind(old.kind).name

    def difference(field: str, recorded: object, rerun: object) -> Difference:
        return Difference(old.sequence, name, old.time_s, field, str(recorded), str(rerun))

    if kind != old.kind:
        return difference("kind", name, Kind(kind).name)
    recorded = to_native(schema, old.kind, old.payload)
    if recorded != payload:
        dtype = native_schema().kind_dtype(kind)
        place = _first_difference(recorded, payload, dtype)
        if place is None:
            return difference("length in bytes", len(recorded), len(payload))
        return difference(*place)
    if np.float64(time_s).tobytes() != np.float64(old.time_s).tobytes():
        return difference("time of the record", old.time_s, time_s)
    return None


def _first_difference(
    one: bytes, two: bytes, dtype: np.dtype[Any]
) -> tuple[str, object, object] | None:
    """Return the path of the first field that differs, and its two values."""
    pair = [data.ljust(dtype.itemsize, b"\0") for data in (one, two)]
    bytes_differ = np.not_equal(*(np.frombuffer(data, np.uint8) for data in pair))
    if not bytes_differ.any():
        return None
    path, leaf, offset = field_at(dtype, int(bytes_differ.argmax()))
    old, new = (np.frombuffer(data, leaf, 1, offset)[0].item() for data in pair)
    return path, old, new


def field_at(dtype: np.dtype[Any], offset: int) -> tuple[str, np.dtype[Any], int]:
    """Return the name, the type and the beginning of the number that stands at a byte."""
    path, start = "", 0
    while dtype.fields is not None or dtype.subdtype is not None:
        if dtype.subdtype is not None:
            dtype, _ = dtype.subdtype
            index = (offset - start) // dtype.itemsize
            path, start = f"{path}[{index}]", start + index * dtype.itemsize
        else:
            assert dtype.fields is not None
            places = {name: (item[0], start + item[1]) for name, item in dtype.fields.items()}
            name = next(
                name
                for name, (inner, begin) in places.items()
                if begin <= offset < begin + inner.itemsize
            )
            dtype, start = places[name]
            path = f"{path}.{name}" if path else name
    return path, dtype, start


# ------------------------------------------------------------------ running again in another way


def rerun_into(
    stream: RecordStream,
    records: Iterable[Record],
    schema: Schema,
    planner_class: PlannerClass,
    changed_params: Mapping[str, float],
) -> None:
    """Publish a drive anew: the host's records as they were, the planner's from a re-run."""
    feeder = Feeder(schema, planner_class, stream.publish, changed_params)
    for record in records:
        if is_of_planner(record):
            feeder.feed(record)
        elif record.kind == KIND_END:
            stream.publish(record.kind, record.time_s, record.payload)
        elif is_native_layout(schema, record.kind):
            payload = to_native(schema, record.kind, record.payload)
            stream.publish(record.kind, record.time_s, payload)
