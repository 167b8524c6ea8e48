# SPDX-License-Identifier: Apache-2.0
"""Data product files: written record by record, read up to the first damage.

navlib_c/SPEC_DP.md fixes every byte.
"""

import json
import os
import stat
import struct
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO, Literal, Self

from pyharness.clib import lib
from pyharness.dp import (
    ByteOrder,
    EventDefinition,
    FieldDefinition,
    Kind,
    KindDefinition,
    RecordDefinition,
    Schema,
    native_schema,
)
from pyharness.errors import DpFileError
from pyharness.records import KIND_END, DriveInfo, Record, Waypoint, read_end

MAGIC = b"ENAVDP\r\n"  # the line end shows files that passed through a text conversion
FORMAT_VERSION = 1
BYTE_ORDER_MARK = 0x01020304
SYNC = 0x52444E45
ALIGNMENT_BYTES = 8
SCHEMA_SIZE_MAX_BYTES = 1 << 20
END_SIZE_MAX_BYTES = 1 << 16
SEARCH_BLOCK_BYTES = 1 << 20

FLUSHED_KINDS = frozenset({Kind.SELECT_ARC_OUT, Kind.HOST_EVR})
"""What ends a planning cycle, and what tells of a fault."""

_FILE_HEADER = "8s4I"  # magic, byte-order mark, format version, content version, schema size
_RECORD_HEADER = "4Id"  # sync, kind, payload size, sequence, time
_CHECKS = "2I"  # of the record header, of the payload
_FILE_HEADER_BYTES = struct.calcsize("<" + _FILE_HEADER)
_RECORD_HEADER_BYTES = struct.calcsize("<" + _RECORD_HEADER)
_CHECKS_BYTES = struct.calcsize("<" + _CHECKS)


def _padding(size_bytes: int) -> int:
    return -size_bytes % ALIGNMENT_BYTES


# ------------------------------------------------------------------ the description in the header


def description(schema: Schema, info: DriveInfo) -> dict[str, Any]:
    """Return, as plain data, what the records of a drive look like and what drive it is."""
    return {
        "drive": asdict(info),
        "enums": schema.enums,
        "events": [asdict(item) for item in schema.events.values()],
        "kinds": [asdict(item) for item in schema.kinds.values()],
        "parameters": schema.parameters,
        "records": [asdict(item) for item in schema.records.values()],
    }


def _describe(schema: Schema, info: DriveInfo) -> bytes:
    """Return the JSON text of a header, to a multiple of the alignment."""
    data = description(schema, info)
    text = json.dumps(data, separators=(",", ":"), ensure_ascii=False, allow_nan=False).encode()
    return text + b" " * _padding(len(text))


def _read_schema(data: Mapping[str, Any], byte_order: ByteOrder) -> Schema:
    records = [
        RecordDefinition(
            row["type"], row["size_bytes"], tuple(FieldDefinition(**item) for item in row["fields"])
        )
        for row in data["records"]
    ]
    kinds = [KindDefinition(**row) for row in data["kinds"]]
    schema = Schema(
        byte_order,
        records={item.type: item for item in records},
        kinds={item.kind: item for item in kinds},
        parameters=tuple(data["parameters"]),
        enums={name: tuple(values) for name, values in data["enums"].items()},
        events={row["id"]: EventDefinition(**row) for row in data["events"]},
    )
    for item in kinds:
        schema.kind_dtype(item.kind)
    return schema


def _read_info(data: Mapping[str, Any]) -> DriveInfo:
    waypoints = tuple(Waypoint(**item) for item in data["waypoints"])
    return DriveInfo(**{**data, "waypoints": waypoints})


# ------------------------------------------------------------------ writing


class DpWriter:
    """Writes a data product file of this machine's layout and byte order.

    Whole planning cycles are handed to the operating system at once: a killed program loses the
    current one at most. The disk has them all when the file is closed.
    """

    def __init__(self, path: Path, info: DriveInfo) -> None:
        """Create the file, which must not exist, and write its header."""
        self._file: BinaryIO = path.open("xb")
        text = _describe(native_schema(), info)
        head = struct.pack(
            "=" + _FILE_HEADER,
            MAGIC,
            BYTE_ORDER_MARK,
            FORMAT_VERSION,
            lib.NAV_DP_VERSION,
            len(text),
        )
        check = struct.pack("=2I", zlib.crc32(head + text), 0)
        self._file.write(head + text + check)

    def write(self, record: Record) -> None:
        """Append one record; planning cycles and faults are handed on at once."""
        head = struct.pack(
            "=" + _RECORD_HEADER,
            SYNC,
            record.kind,
            len(record.payload),
            record.sequence,
            record.time_s,
        )
        checks = struct.pack("=" + _CHECKS, zlib.crc32(head), zlib.crc32(record.payload))
        self._file.write(head + checks + record.payload + bytes(_padding(len(record.payload))))
        if record.kind in FLUSHED_KINDS:
            self._file.flush()

    def close(self) -> None:
        """Bring the file to the disk and close it."""
        with self._file:
            self._file.flush()
            os.fsync(self._file.fileno())

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> Literal[False]:
        self.close()
        return False


# ------------------------------------------------------------------ reading


@dataclass(frozen=True, slots=True)
class Damage:
    """Where a file stops being intact, and why."""

    offset: int
    reason: str

    def __str__(self) -> str:
        return f"damaged at byte {self.offset}: {self.reason}"


class _DamageError(Exception):
    """Raised inside the reader at the first bad byte."""


class DpReader:
    """Reads a data product file of either byte order, with the layout the file itself states.

    `records()` yields what is intact, also behind damage: a gap in the sequence numbers shows where
    something is missing. Afterwards `damage` tells where and why the file is not whole, or is None.
    """

    def __init__(self, path: Path) -> None:
        """Open the file and read its header.

        Raises:
            DpFileError: There is no such file, or its header is unusable.
        """
        self.path = path
        self._damages: list[Damage] = []
        self._lost_count = 0
        self._file = _open_regular(path)
        try:
            self.version, self.schema, self.info = self._read_header()
        except _DamageError as error:
            self._file.close()
            raise DpFileError(f"{path}: damaged at byte 0: {error}") from None
        self._start = self._file.tell()

    @property
    def damage(self) -> Damage | None:
        """The first damage met so far, and how much is missing before the last intact record."""
        if not self._damages:
            return None
        first = self._damages[0]
        if self._lost_count == 0:
            return first
        places = len(self._damages)
        lost = f"{self._lost_count} record{'s' if self._lost_count > 1 else ''} lost"
        where = f" in {places} places" if places > 1 else ""
        return Damage(first.offset, f"{first.reason}; {lost}{where}")

    def records(self) -> Iterator[Record]:
        """Yield the intact records from the first on."""
        self._damages, self._lost_count = [], 0
        offset: int | None = self._start
        sequence = 0
        is_gap_known = False
        while offset is not None:
            self._file.seek(offset)
            try:
                record = self._read_record(sequence)
            except _DamageError as error:
                self._damages.append(Damage(offset, str(error)))
                is_gap_known = True
                offset = self._find_record(offset + 1, sequence)
                continue
            if record.sequence > sequence and not is_gap_known:
                reason = f"record number {record.sequence}, expected {sequence}"
                self._damages.append(Damage(offset, reason))
            self._lost_count += record.sequence - sequence
            sequence, is_gap_known = record.sequence + 1, False
            offset = self._file.tell()
            if record.kind == KIND_END:
                if self._file.read(1):
                    self._damages.append(Damage(offset, "bytes after the end record"))
                offset = None
            yield record

    def _find_record(self, offset: int, sequence: int) -> int | None:
        """Return where the next intact record begins, which may be anywhere, or None."""
        mark = struct.pack(self._prefix + "I", SYNC)
        header_bytes = _RECORD_HEADER_BYTES + _CHECKS_BYTES
        while True:
            self._file.seek(offset)
            block = self._take_up_to(SEARCH_BLOCK_BYTES)
            place = block.find(mark)
            while 0 <= place <= len(block) - header_bytes:
                head = block[place : place + _RECORD_HEADER_BYTES]
                check = struct.unpack_from(self._prefix + "I", block, place + len(head))[0]
                if check == zlib.crc32(head) and self._is_record(offset + place, sequence):
                    return offset + place
                place = block.find(mark, place + 1)
            if len(block) < SEARCH_BLOCK_BYTES:
                return None
            offset += len(block) - header_bytes + 1

    def _is_record(self, offset: int, sequence: int) -> bool:
        self._file.seek(offset)
        try:
            self._read_record(sequence)
        except _DamageError:
            return False
        return True

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> Literal[False]:
        self.close()
        return False

    def _read_header(self) -> tuple[int, Schema, DriveInfo]:
        beginning = self._take_up_to(len(MAGIC))
        if beginning != MAGIC[: len(beginning)]:
            raise _DamageError(f"not a data product file, expected it to begin with {MAGIC!r}")
        head = beginning + self._take(_FILE_HEADER_BYTES - len(beginning), "the file header")
        mark = struct.unpack_from("<I", head, len(MAGIC))[0]
        orders: dict[int, ByteOrder] = {
            BYTE_ORDER_MARK: "little",
            int.from_bytes(BYTE_ORDER_MARK.to_bytes(4, "little"), "big"): "big",
        }
        if mark not in orders:
            raise _DamageError(f"byte-order mark {mark:#010x} is neither order")
        self._prefix = "<" if orders[mark] == "little" else ">"
        _, _, version, content, size = struct.unpack(self._prefix + _FILE_HEADER, head)
        if version != FORMAT_VERSION:
            raise _DamageError(f"format version {version}, this program reads {FORMAT_VERSION}")
        if size > SCHEMA_SIZE_MAX_BYTES:
            raise _DamageError(
                f"a schema of {size} bytes, expected at most {SCHEMA_SIZE_MAX_BYTES}"
            )
        text = self._take(size, "the schema")
        checks = self._take(8, "the header's checksum")
        if struct.unpack(self._prefix + "2I", checks) != (zlib.crc32(head + text), 0):
            raise _DamageError("the header's checksum does not match")
        try:
            data = json.loads(text)
            return content, _read_schema(data, orders[mark]), _read_info(data["drive"])
        except (KeyError, TypeError, ValueError, RecursionError) as error:
            raise _DamageError(f"the schema makes no sense: {error}") from None

    def _read_record(self, sequence: int) -> Record:
        head = self._take(_RECORD_HEADER_BYTES, "a record header", is_start=True)
        header_check, payload_check = struct.unpack(
            self._prefix + _CHECKS, self._take(_CHECKS_BYTES, "a record header")
        )
        sync, kind, size, found, time_s = struct.unpack(self._prefix + _RECORD_HEADER, head)
        if sync != SYNC:
            raise _DamageError(f"expected the mark of a record, found {sync:#010x}")
        if header_check != zlib.crc32(head):
            raise _DamageError("the checksum of the record header does not match")
        if found < sequence:
            raise _DamageError(f"record number {found}, expected {sequence}")
        if size > self._size_max_bytes(kind):
            raise _DamageError(f"a record of kind {kind} with {size} bytes is too long")
        payload = self._take(size, "a record")
        if payload_check != zlib.crc32(payload):
            name = self.schema.kinds[kind].name if kind != KIND_END else "the end"
            raise _DamageError(f"the checksum of record {found}, {name}, does not match")
        if any(self._take(_padding(size), "the padding of a record")):
            raise _DamageError("the padding of the record is not zero")
        if kind == KIND_END:
            _check_end(payload)
        return Record(kind, time_s, found, payload)

    def _size_max_bytes(self, kind: int) -> int:
        if kind == KIND_END:
            return END_SIZE_MAX_BYTES
        if kind not in self.schema.kinds:
            raise _DamageError(f"kind {kind} is not in the file's schema")
        return self.schema.kind_dtype(kind).itemsize

    def _take(self, size: int, what: str, is_start: bool = False) -> bytes:
        data = self._take_up_to(size)
        if is_start and not data:
            raise _DamageError("the file ends without its end record")
        if len(data) < size:
            raise _DamageError(f"the file ends within {what}")
        return data

    def _take_up_to(self, size: int) -> bytes:
        try:
            return self._file.read(size)
        except OSError as error:
            raise _DamageError(f"cannot be read: {error.strerror}") from None


def _check_end(payload: bytes) -> None:
    try:
        read_end(payload)
    except (KeyError, TypeError, ValueError, RecursionError):
        raise _DamageError("the end record makes no sense") from None


def _open_regular(path: Path) -> BinaryIO:
    try:
        if not stat.S_ISREG(path.stat().st_mode):
            raise DpFileError(f"{path}: not a file, expected data products")
        return path.open("rb")
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise DpFileError(f"{path}: cannot be read: {reason}") from None
