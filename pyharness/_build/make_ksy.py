# SPDX-License-Identifier: Apache-2.0
"""Write navlib_c/enav_dp.ksy, the Kaitai Struct description of data product files: `make docs`."""

from collections.abc import Iterator
from pathlib import Path

from pyharness.dp import FieldDefinition, RecordDefinition, native_schema

KSY = Path(__file__).resolve().parents[2] / "navlib_c/enav_dp.ksy"
NUMBERS = {
    "double": "f8",
    "float": "f4",
    "int8_t": "s1",
    "int16_t": "s2",
    "int32_t": "s4",
    "int64_t": "s8",
    "uint8_t": "u1",
    "uint16_t": "u2",
    "uint32_t": "u4",
    "uint64_t": "u8",
}
ENVELOPE = """\
# SPDX-License-Identifier: Apache-2.0
# made by `make docs` from the tables of navlib_c/include and navlib_c/stubs: do not edit
meta:
  id: enav_dp
  title: ENav data product file
  file-extension: dp
  license: Apache-2.0
  ks-version: "0.10"
  encoding: UTF-8
doc: |
  The records of one drive; SPEC_DP.md fixes every byte. Checksums are CRC-32, they are not checked
  here. The layouts below are those of content version {version}; a file of another one says its own
  in its description.
seq:
  - id: magic
    contents: [0x45, 0x4e, 0x41, 0x56, 0x44, 0x50, 0x0d, 0x0a]
  - id: byte_order
    size: 4
  - id: body
    type: body
enums:
  dp_kind:
    0: end
{kinds}types:
  body:
    meta:
      endian:
        switch-on: _root.byte_order
        cases:
          '[0x04, 0x03, 0x02, 0x01]': le
          '[0x01, 0x02, 0x03, 0x04]': be
    seq:
      - id: format_version
        type: u4
        valid: 1
      - id: content_version
        type: u4
      - id: description_size
        type: u4
        valid:
          max: 1048576
      - id: description
        type: str
        size: description_size
        doc: JSON, padded with spaces
      - id: header_crc
        type: u4
      - id: reserved
        type: u4
        valid: 0
      - id: records
        type: record
        repeat: eos
    types:
      record:
        seq:
          - id: mark
            type: u4
            valid: 0x52444e45
          - id: kind
            type: u4
            enum: dp_kind
          - id: payload_size
            type: u4
          - id: sequence
            type: u4
          - id: time_s
            type: f8
          - id: header_crc
            type: u4
          - id: payload_crc
            type: u4
          - id: payload
            size: payload_size
            type:
              switch-on: kind
              cases:
                dp_kind::end: end_t
{cases}          - id: padding
            size: (8 - payload_size % 8) % 8
      end_t:
        seq:
          - id: outcome
            type: str
            size-eos: true
            doc: JSON
"""


def ksy_text() -> str:
    """Return the whole description."""
    from pyharness.clib import lib

    schema = native_schema()
    kinds = "".join(f"    {item.kind}: {item.name.lower()}\n" for item in schema.kinds.values())
    cases = "".join(
        f"                dp_kind::{item.name.lower()}: {item.type}\n"
        for item in schema.kinds.values()
    )
    head = ENVELOPE.format(version=int(lib.NAV_DP_VERSION), kinds=kinds, cases=cases)
    return head + "".join(line + "\n" for row in schema.records.values() for line in _type(row))


def _type(record: RecordDefinition) -> Iterator[str]:
    yield f"      {record.type}:"
    yield "        seq:"
    for field in record.fields:
        yield from _field(field, is_last=field is record.fields[-1])


def _field(field: FieldDefinition, is_last: bool) -> Iterator[str]:
    yield f"          - id: {field.name}"
    yield f"            type: {NUMBERS.get(field.type, field.type)}"
    if field.count > 1 and is_last and field.type not in NUMBERS:
        yield "            repeat: eos"  # trimmed to the entries in use
    elif field.count > 1:
        yield "            repeat: expr"
        yield f"            repeat-expr: {field.count}"
    about = ", ".join(text for text in (field.unit if field.unit != "1" else "", field.doc) if text)
    if about:
        yield f"            doc: '{about.replace(chr(39), chr(39) * 2)}'"


def main() -> None:
    KSY.write_text(ksy_text(), encoding="utf-8")


if __name__ == "__main__":
    main()
