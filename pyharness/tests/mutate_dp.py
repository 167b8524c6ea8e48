# SPDX-License-Identifier: Apache-2.0
"""Damaged data product files for tests: with broken checksums, and with mended ones."""

import random
import struct
import zlib
from collections.abc import Callable, Sequence

from pyharness.records import Record

HEAD_BYTES = 24
NUMBERS = (0, 1, 2, 7, 8, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF)
DOUBLES = (0.0, -0.0, 1e-300, 1e300, -1e300, float("inf"), float("nan"))


def record_starts(data: bytes, records: Sequence[Record]) -> list[int]:
    """Return where each record of a whole file begins, and where the file ends."""
    starts = [HEAD_BYTES + struct.unpack_from("=I", data, 20)[0] + 8]
    for record in records:
        size = len(record.payload)
        starts.append(starts[-1] + 32 + size + -size % 8)
    return starts


def mend_header(data: bytearray) -> None:
    """Write the right checksum of the header."""
    size = struct.unpack_from("=I", data, 20)[0]
    if HEAD_BYTES + size + 8 <= len(data):
        struct.pack_into("=I", data, HEAD_BYTES + size, zlib.crc32(data[: HEAD_BYTES + size]))


def mend_record(data: bytearray, start: int) -> None:
    """Write the right checksums of the record at a place."""
    size = struct.unpack_from("=I", data, start + 8)[0]
    payload = data[start + 32 : start + 32 + size]
    struct.pack_into("=I", data, start + 24, zlib.crc32(data[start : start + 24]))
    struct.pack_into("=I", data, start + 28, zlib.crc32(payload))


def mutated(data: bytes, starts: Sequence[int], rng: random.Random) -> bytes:
    """Return a file with one to three changes, most of them with checksums that are right again."""
    changed = bytearray(data)
    for _ in range(rng.randint(1, 3)):
        rng.choice(_CHANGES)(changed, starts, rng)
    return bytes(changed)


def _any_byte(data: bytearray, _: Sequence[int], rng: random.Random) -> None:
    data[rng.randrange(len(data))] = rng.randrange(256)


def _cut(data: bytearray, starts: Sequence[int], rng: random.Random) -> None:
    place = rng.randrange(starts[0], len(data))
    del data[place : place + rng.choice((1, 8, 64, 5000))]
    data.extend(bytes(max(0, starts[-1] - len(data))) if rng.random() < 0.5 else b"")
    if len(data) < starts[-1]:
        data.extend(b"\xff" * (starts[-1] - len(data)))


def _description(data: bytearray, _: Sequence[int], rng: random.Random) -> None:
    """Change a number of the layout, which leaves JSON, or any character."""
    size = min(struct.unpack_from("=I", data, 20)[0], len(data) - HEAD_BYTES - 8)
    digits = [k for k in range(HEAD_BYTES, HEAD_BYTES + size) if data[k] in b"0123456789"]
    if digits and rng.random() < 0.8:
        data[rng.choice(digits)] = rng.choice(b"0123456789")
    elif size > 0:
        data[HEAD_BYTES + rng.randrange(size)] = rng.choice(b'09{}[]",:-exyz_ \xff')
    mend_header(data)


def _any_record(data: bytearray, starts: Sequence[int], rng: random.Random) -> int:
    """Choose a kind of record, then one of that kind: most records are ticks of truth."""
    by_kind: dict[bytes, list[int]] = {}
    for index, start in enumerate(starts[:-1]):
        by_kind.setdefault(bytes(data[start + 4 : start + 8]), []).append(index)
    return rng.choice(by_kind[rng.choice(sorted(by_kind))])


def _field(data: bytearray, starts: Sequence[int], rng: random.Random) -> None:
    start = starts[_any_record(data, starts, rng)]
    struct.pack_into("=I", data, start + rng.choice((0, 4, 8, 12)), rng.choice(NUMBERS))
    mend_record(data, start)


def _payload(data: bytearray, starts: Sequence[int], rng: random.Random) -> None:
    index = _any_record(data, starts, rng)
    start, end = starts[index], starts[index + 1]
    for _ in range(rng.randint(1, 4)):
        place = start + 32 + 8 * rng.randrange(max(1, (end - start - 32) // 8))
        if place + 8 <= len(data):
            pack, values = rng.choice((("=d", DOUBLES), ("=I", NUMBERS)))
            struct.pack_into(pack, data, place, rng.choice(values))
    mend_record(data, start)


def _time(data: bytearray, starts: Sequence[int], rng: random.Random) -> None:
    start = starts[_any_record(data, starts, rng)]
    struct.pack_into("=d", data, start + 16, rng.choice(DOUBLES))
    mend_record(data, start)


_CHANGES: Sequence[Callable[[bytearray, Sequence[int], random.Random], None]] = (
    _any_byte,
    _cut,
    _description,
    _field,
    _payload,
    _payload,
    _time,
)
