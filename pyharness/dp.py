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


@dataclass(frozen=True, slots=True, eq=False)
class Schema:
    """The layout of every kind of data product, for one byte order."""

    byte_order: ByteOrder
    records: Mapping[str, RecordDefinition]
    kinds: Mapping[int, KindDefinition]
    _dtypes: dict[str, np.dtype[Any]] = field(default_factory=dict)

    def dtype(self, type_name: str) -> np.dtype[Any]:
        """Return the dtype of a record type."""
        if type_name not in self._dtypes:
            self._dtypes[type_name] = self._make_dtype(type_name, ())
        return self._dtypes[type_name]

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

    def _make_dtype(self, type_name: str, parents: tuple[str, ...]) -> np.dtype[Any]:
        if type_name in _NUMBERS:
            order = "<" if self.byte_order == "little" else ">"
            return np.dtype(order + _NUMBERS[type_name])
        if type_name not in self.records or type_name in parents:
            raise ValueError(f"unknown type {type_name!r} in the schema")
        definition = self.records[type_name]
        inner = [self._make_dtype(item.type, (*parents, type_name)) for item in definition.fields]
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
    )


def _kinds() -> Any:
    return IntEnum("Kind", {item.name: kind for kind, item in native_schema().kinds.items()})


Kind = _kinds()
"""The kinds of data products by their C names, e.g. `Kind.SELECT_ARC_IN`."""


def new_message(kind: int) -> Message:
    """Return an empty record of a kind, all zero."""
    return np.zeros((), dtype=dtype_of(native_schema().kinds[kind].type))


def used_bytes(kind: int, message: Message) -> bytes:
    """Return a record's bytes to its true length.

    As in Navlib: a record that ends in an array of records, counted by the last field whose name
    ends in `_count`, ends after the entries in use.
    """
    definition = native_schema().records[native_schema().kinds[kind].type]
    last = definition.fields[-1]
    counts = [item.name for item in definition.fields if item.name.endswith("_count")]
    data = message.tobytes()
    if last.type in _NUMBERS or last.count == 1 or not counts:
        return data
    item_bytes = native_schema().records[last.type].size_bytes
    return data[: last.offset + int(message[counts[-1]]) * item_bytes]
