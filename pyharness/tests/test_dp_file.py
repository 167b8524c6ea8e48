# SPDX-License-Identifier: Apache-2.0
import os
import random
import struct
import time

import pytest

from pyharness.dp import Kind, layout_difference, native_schema, to_native
from pyharness.dp_file import DpReader, DpWriter
from pyharness.errors import DpFileError
from pyharness.tests.byte_order import write_swapped

FILE_HEADER_BYTES = 24


@pytest.fixture
def golden(tmp_path, drive_info, some_records):
    path = tmp_path / "drive.dp"
    with DpWriter(path, drive_info) as writer:
        for record in some_records:
            writer.write(record)
    return path


def read(path):
    with DpReader(path) as reader:
        return list(reader.records()), reader.damage


def record_starts(data, records):
    starts = [header_bytes(data)]
    for record in records[:-1]:
        starts.append(starts[-1] + 32 + (len(record.payload) + 7) // 8 * 8)
    return starts


def header_bytes(data):
    return FILE_HEADER_BYTES + struct.unpack_from("=I", data, 20)[0] + 8


def test_what_is_written_is_read(golden, some_records, drive_info):
    with DpReader(golden) as reader:
        assert list(reader.records()) == some_records
        assert reader.damage is None
        assert reader.info == drive_info
        assert reader.schema.kinds == native_schema().kinds
        assert reader.schema.records == native_schema().records
        assert list(reader.records()) == some_records


def test_the_same_records_give_the_same_bytes(golden, tmp_path, drive_info, some_records):
    with DpWriter(tmp_path / "again.dp", drive_info) as writer:
        for record in some_records:
            writer.write(record)
    assert (tmp_path / "again.dp").read_bytes() == golden.read_bytes()


def test_every_part_begins_at_a_multiple_of_eight(golden):
    data = golden.read_bytes()
    assert len(data) % 8 == 0
    assert header_bytes(data) % 8 == 0


@pytest.mark.faults
def test_a_file_cut_anywhere_gives_all_whole_records_and_the_offset(golden, some_records):
    data = golden.read_bytes()
    start = header_bytes(data)
    ends = [start]
    for record in some_records:
        ends.append(ends[-1] + 32 + (len(record.payload) + 7) // 8 * 8)
    assert ends[-1] == len(data)
    for size in range(start, len(data), 7):
        golden.write_bytes(data[:size])
        records, damage = read(golden)
        whole = sum(end <= size for end in ends[1:])
        assert records == some_records[:whole]
        assert damage is not None
        assert damage.offset == ends[whole]


@pytest.mark.faults
def test_a_header_cut_anywhere_is_one_error(golden):
    data = golden.read_bytes()
    for size in range(0, header_bytes(data), 97):
        golden.write_bytes(data[:size])
        with pytest.raises(DpFileError, match="damaged at byte 0"):
            DpReader(golden)


@pytest.mark.faults
def test_a_flipped_bit_costs_one_record_and_is_reported_with_its_offset(golden, some_records):
    data = golden.read_bytes()
    starts = record_starts(data, some_records)
    rng = random.Random(1)
    for _ in range(400):
        place, bit = rng.randrange(len(data)), 1 << rng.randrange(8)
        golden.write_bytes(data[:place] + bytes([data[place] ^ bit]) + data[place + 1 :])
        try:
            records, damage = read(golden)
        except DpFileError:
            assert place < header_bytes(data)
            continue
        hit = max(index for index, start in enumerate(starts) if start <= place)
        assert records == some_records[:hit] + some_records[hit + 1 :]
        assert damage.offset == starts[hit]


@pytest.mark.faults
def test_records_behind_lost_bytes_are_found_and_the_loss_is_counted(golden, some_records):
    data = golden.read_bytes()
    starts = record_starts(data, some_records)
    golden.write_bytes(data[: starts[1] + 5] + data[starts[2] + 3 :])
    records, damage = read(golden)
    assert records == [some_records[0], *some_records[3:]]
    assert damage.offset == starts[1]
    assert damage.reason.endswith("; 2 records lost")


@pytest.mark.faults
def test_a_record_cut_out_cleanly_is_missed(golden, some_records):
    data = golden.read_bytes()
    starts = record_starts(data, some_records)
    golden.write_bytes(data[: starts[1]] + data[starts[2] :])
    records, damage = read(golden)
    assert records == [some_records[0], *some_records[2:]]
    assert damage.reason == "record number 2, expected 1; 1 record lost"


@pytest.mark.faults
def test_a_long_stretch_of_marks_is_searched_in_no_time(golden, some_records):
    data = golden.read_bytes()
    golden.write_bytes(data[:-100] + struct.pack("=I", 0x52444E45) * 500_000 + data[-100:])
    start_s = time.perf_counter()
    records, damage = read(golden)
    assert time.perf_counter() - start_s < 5.0
    assert records[:-1] == some_records[: len(records) - 1]
    assert damage is not None


@pytest.mark.faults
def test_swapped_and_repeated_records_are_damage(tmp_path, drive_info, some_records):
    for order, kept in (([1, 0], [1]), ([0, 0], [0]), ([0, 2], [0, 2])):
        path = tmp_path / f"order{order}.dp"
        with DpWriter(path, drive_info) as writer:
            for index in order:
                writer.write(some_records[index])
        records, damage = read(path)
        assert [record.sequence for record in records] == kept
        assert "record number" in damage.reason


def test_bytes_after_the_end_are_reported_at_their_offset(golden, some_records):
    size = golden.stat().st_size
    golden.write_bytes(golden.read_bytes() * 2)
    records, damage = read(golden)
    assert records == some_records
    assert str(damage) == f"damaged at byte {size}: bytes after the end record"


def test_a_record_longer_than_its_struct_is_damage(tmp_path, drive_info, some_records):
    record = some_records[0]
    big = type(record)(Kind.ESTIMATE, 0.0, 0, bytes(5000))
    with DpWriter(tmp_path / "long.dp", drive_info) as writer:
        writer.write(big)
    assert "too long" in read(tmp_path / "long.dp")[1].reason


def test_a_file_of_the_other_byte_order_is_read(golden, tmp_path, some_records):
    path = tmp_path / "swapped.dp"
    write_swapped(golden, path)
    assert path.read_bytes() != golden.read_bytes()
    with DpReader(path) as reader:
        assert reader.schema.byte_order != native_schema().byte_order
        records = list(reader.records())
        assert reader.damage is None
        assert layout_difference(reader.schema) is None
        for record, original in zip(records, some_records, strict=True):
            if record.kind:
                native = to_native(reader.schema, record.kind, record.payload)
                assert native == original.payload


@pytest.mark.faults
def test_a_text_conversion_is_noticed(golden):
    golden.write_bytes(golden.read_bytes().replace(b"\r\n", b"\n"))
    with pytest.raises(DpFileError, match="not a data product file"):
        DpReader(golden)


@pytest.mark.faults
def test_what_is_no_file_is_refused(tmp_path):
    os.mkfifo(tmp_path / "fifo")
    (tmp_path / "empty").touch()
    for name in ("missing", ".", "fifo", "empty"):
        with pytest.raises(DpFileError):
            DpReader(tmp_path / name)


def test_an_existing_file_is_not_overwritten(golden, drive_info):
    with pytest.raises(FileExistsError):
        DpWriter(golden, drive_info)
