# SPDX-License-Identifier: Apache-2.0
"""Data products: their kinds, their layout, and the way between bytes and arrays.

A schema says how the bytes of every kind are laid out. The native one comes from the tables that
the C compiler filled; a data product file carries its own, so that it can be read after the
structs have changed, on a machine of either byte order.
"""

import functools
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from pyharness.clib import ffi, lib
from pyharness.layout import dtype_of

Message = npt.NDArray[np.void]
"""One record as a 0-d structured array: fields are read and written by name."""

ByteOrder = Literal["little", "big"]

RECORD_SIZE_MAX_BYTES = 1 << 24

_NUMBERS = {
    "double": "f8",
    "float": "f4",
    "int8_t": "i1",
    "int16_t": "i2",
    "int32_t": "i4",
    "int64_t": "i8",
    "uint8_t": "u1",
    "uint16_t": "u2",
    "uint32_t": "u4",
    "uint64_t": "u8",
}


@dataclass(frozen=True, slots=True)
class FieldDefinition:
    """One field of a record: `type` is a number type or the name of another record."""

    name: str
    type: str
    count: int
    offset: int
    unit: str
    doc: str


@dataclass(frozen=True, slots=True)
class RecordDefinition:
    """One C struct."""

    type: str
    size_bytes: int
    fields: tuple[FieldDefinition, ...]


@dataclass(frozen=True, slots=True)
class KindDefinition:
    """One kind of data product."""

    kind: int
    name: str
    type: str
    doc: str


@dataclass(frozen=True, slots=True)
class EventDefinition:
    """One kind of event report."""

    id: int
    name: str
    text: str


@dataclass(frozen=True, slots=True, eq=False)
class Schema:
    """The layout of every kind of data product, for one byte order, and what its numbers stand for.

    Attributes:
        byte_order: Of all numbers.
        records: The C structs by their type.
        kinds: The kinds of data products by their number.
        parameters: Names of Navlib's parameters, in the order of INIT_IN.
        enums: Names of the values 0, 1, ... of the enumerations, by their C type.
        events: The event reports by their number.
    """

    byte_order: ByteOrder
    records: Mapping[str, RecordDefinition]
    kinds: Mapping[int, KindDefinition]
    parameters: tuple[str, ...] = ()
    enums: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    events: Mapping[int, EventDefinition] = field(default_factory=dict)
    _dtypes: dict[str, np.dtype[Any]] = field(default_factory=dict)

    def dtype(self, type_name: str) -> np.dtype[Any]:
        """Return the dtype of a record type."""
        return self._dtype(type_name, ())

    def kind_dtype(self, kind: int) -> np.dtype[Any]:
        """Return the dtype of a kind."""
        return self.dtype(self.kinds[kind].type)

    def decode(self, kind: int, payload: bytes) -> Message:
        """Return a record; the unused end of a record that was trimmed is zero.

        Raises:
            ValueError: The payload is longer than the record.
        """
        dtype = self.kind_dtype(kind)
        if len(payload) > dtype.itemsize:
            raise ValueError(
                f"{self.kinds[kind].name} of {len(payload)} bytes, expected at most"
                f" {dtype.itemsize}"
            )
        return np.frombuffer(payload.ljust(dtype.itemsize, b"\0"), dtype=dtype).reshape(())

    def _dtype(self, type_name: str, parents: tuple[str, ...]) -> np.dtype[Any]:
        if type_name not in self._dtypes:
            self._dtypes[type_name] = self._make_dtype(type_name, parents)
        return self._dtypes[type_name]

    def _make_dtype(self, type_name: str, parents: tuple[str, ...]) -> np.dtype[Any]:
        if type_name in _NUMBERS:
            order = "<" if self.byte_order == "little" else ">"
            return np.dtype(order + _NUMBERS[type_name])
        if type_name not in self.records or type_name in parents:
            raise ValueError(f"unknown type {type_name!r} in the schema")
        definition = self.records[type_name]
        if definition.size_bytes > RECORD_SIZE_MAX_BYTES:
            raise ValueError(
                f"{type_name} of {definition.size_bytes} bytes, expected at most"
                f" {RECORD_SIZE_MAX_BYTES}"
            )
        inner = [self._dtype(item.type, (*parents, type_name)) for item in definition.fields]
        return np.dtype(
            {
                "names": [item.name for item in definition.fields],
                "formats": [
                    dtype if item.count == 1 else (dtype, (item.count,))
                    for item, dtype in zip(definition.fields, inner, strict=True)
                ],
                "offsets": [item.offset for item in definition.fields],
                "itemsize": definition.size_bytes,
            }
        )


def layout_difference(schema: Schema) -> str | None:
    """Say what of Navlib's inputs and outputs is laid out otherwise than on this machine, or None.

    The byte order does not matter, nor do records that Navlib does not know.
    """
    for kind in range(1, int(lib.NAV_DP_COUNT) + 1):
        if not is_native_layout(schema, kind):
            return f"{native_schema().kinds[kind].name} has another layout"
    if schema.parameters != native_schema().parameters:
        return "Navlib had other parameters"
    return None


def is_native_layout(schema: Schema, kind: int) -> bool:
    """Whether a kind is laid out as on this machine, the byte order aside."""
    native = native_schema()
    if kind not in schema.kinds or kind not in native.kinds:
        return False
    if schema.kinds[kind].name != native.kinds[kind].name:
        return False
    return schema.kind_dtype(kind).newbyteorder("=") == native.kind_dtype(kind).newbyteorder("=")


def to_native(schema: Schema, kind: int, payload: bytes) -> bytes:
    """Return a payload in the byte order of this machine, for a schema of the same layout."""
    native = native_schema()
    if schema.byte_order == native.byte_order:
        return payload
    message = schema.decode(kind, payload)
    return message.astype(native.kind_dtype(kind)).tobytes()[: len(payload)]


def _text(pointer: Any) -> str:
    return str(ffi.string(pointer).decode())


def _record_definition(row: Any) -> RecordDefinition:
    fields = tuple(
        FieldDefinition(
            name=_text(item.name),
            type=_text(item.type),
            count=int(item.count),
            offset=int(item.offset),
            unit=_text(item.unit),
            doc=_text(item.doc),
        )
        for item in row.fields[0 : row.field_count]
    )
    return RecordDefinition(_text(row.type), int(row.size), fields)


@functools.cache
def native_schema() -> Schema:
    """Return the schema of this machine, from the C tables of Navlib and of the host's records."""
    records = [_record_definition(row) for row in (*lib.nav_record_defs, *lib.nav_host_record_defs)]
    kinds = [
        KindDefinition(int(row.kind), _text(row.name), _text(row.type), _text(row.doc))
        for row in (*lib.nav_dp_defs, *lib.nav_host_dp_defs)
    ]
    return Schema(
        byte_order="little" if sys.byteorder == "little" else "big",
        records={item.type: item for item in records},
        kinds={item.kind: item for item in kinds},
        parameters=tuple(_text(row.name) for row in lib.nav_param_defs),
        enums={type_name: _enum_names(type_name, prefix) for type_name, prefix in _ENUMS.items()},
        events={
            int(row.id): EventDefinition(int(row.id), _text(row.name), _text(row.text))
            for row in (*lib.nav_evr_defs, *lib.nav_host_evr_defs)
        },
    )


_ENUMS = {
    "nav_status_t": "NAV_",
    "nav_reason_t": "NAV_REASON_",
    "nav_mode_t": "NAV_MODE_",
    "nav_host_activity_t": "NAV_HOST_",
}
"""The enumerations that have a table in the headers, and the prefix of their names."""


def _enum_names(type_name: str, prefix: str) -> tuple[str, ...]:
    values = ffi.typeof(type_name).elements
    names = [values[value].removeprefix(prefix) for value in sorted(values)]
    return tuple(names[:-1])  # without the sentinel that counts them


def _kinds() -> Any:
    return IntEnum("Kind", {item.name: kind for kind, item in native_schema().kinds.items()})


Kind = _kinds()
"""The kinds of data products by their C names, e.g. `Kind.SELECT_ARC_IN`."""


def new_message(kind: int) -> Message:
    """Return an empty record of a kind, all zero."""
    return np.zeros((), dtype=dtype_of(native_schema().kinds[kind].type))


def init_request(params: Mapping[str, float], time_s: float = 0.0) -> Message:
    """Return a full set of parameters as a record."""
    request = new_message(Kind.INIT_IN)
    request["time_s"] = time_s
    request["params"] = [params[name] for name in native_schema().parameters]
    return request


def used_bytes(kind: int, message: Message) -> bytes:
    """Return a record's bytes to its true length.

    As in Navlib: a record that ends in an array of records, counted by the last field whose name
    ends in `_count`, ends after the entries in use.
    """
    data = message.tobytes()
    tail = _tail(kind)
    if tail is None:
        return data
    count_name, offset, item_bytes = tail
    return data[: offset + int(message[count_name]) * item_bytes]


@functools.cache
def _tail(kind: int) -> tuple[str, int, int] | None:
    """Return what counts the entries that a kind ends in, their offset and size, if it does."""
    definition = native_schema().records[native_schema().kinds[kind].type]
    last = definition.fields[-1]
    counts = [item.name for item in definition.fields if item.name.endswith("_count")]
    if last.type in _NUMBERS or last.count == 1 or not counts:
        return None
    return counts[-1], last.offset, native_schema().records[last.type].size_bytes
