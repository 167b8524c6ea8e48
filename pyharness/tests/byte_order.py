# SPDX-License-Identifier: Apache-2.0
"""Data product files as a machine of the other byte order would have written them."""

import struct
import sys
import zlib
from pathlib import Path

from pyharness.dp_file import DpReader
from pyharness.records import KIND_END

OTHER = ">" if sys.byteorder == "little" else "<"


def write_swapped(path: Path, swapped: Path) -> None:
    """Write a whole file of this machine once more, every number in the other byte order."""
    data = path.read_bytes()
    size = struct.unpack_from("=I", data, 20)[0]
    head = data[:8] + struct.pack(f"{OTHER}4I", *struct.unpack_from("=4I", data, 8))
    head += data[24 : 24 + size]
    parts = [head, struct.pack(f"{OTHER}2I", zlib.crc32(head), 0)]
    mark = struct.unpack_from("=I", data, 24 + size + 8)[0]
    with DpReader(path) as reader:
        for record in reader.records():
            payload = record.payload
            if record.kind != KIND_END:
                dtype = reader.schema.kind_dtype(record.kind)
                message = reader.schema.decode(record.kind, payload)
                payload = message.astype(dtype.newbyteorder()).tobytes()[: len(payload)]
            fields = (mark, record.kind, len(payload), record.sequence, record.time_s)
            part = struct.pack(f"{OTHER}4Id", *fields)
            checks = struct.pack(f"{OTHER}2I", zlib.crc32(part), zlib.crc32(payload))
            parts += [part, checks, payload, bytes(-len(payload) % 8)]
    swapped.write_bytes(b"".join(parts))
