# SPDX-License-Identifier: Apache-2.0
"""A recording damaged in every way: what is intact comes out, the damage is named."""

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pyharness.dp import Kind
from pyharness.dp_file import DpReader, DpWriter
from pyharness.errors import DpFileError, HarnessError
from pyharness.records import RecordStream
from pyharness.tests.fuzz_dp import use
from pyharness.tests.mutate_dp import mutated, record_starts

pytestmark = pytest.mark.faults


@pytest.fixture(scope="module")
def whole(quick_drive, tmp_path_factory):
    """A recording, without most of its ticks of truth to be quick: path, bytes, records, starts."""
    path = tmp_path_factory.mktemp("damage") / "drive.dp"
    records = []
    with DpReader(quick_drive) as reader, DpWriter(path, reader.info) as writer:
        stream = RecordStream([writer.write, records.append])
        for record in reader.records():
            if record.kind != Kind.TRUTH or record.sequence % 40 == 0:
                stream.publish(record.kind, record.time_s, record.payload)
    data = path.read_bytes()
    return path, data, records, record_starts(data, records)


def read(path, data):
    path.write_bytes(data)
    with DpReader(path) as reader:
        return list(reader.records()), reader.damage


def test_cut_at_every_record_all_before_come_out(whole, tmp_path):
    _, data, records, starts = whole
    assert starts[-1] == len(data)
    for index, start in enumerate(starts[:-1]):
        found, damage = read(tmp_path / "cut.dp", data[:start])
        assert found == records[:index]
        assert str(damage) == f"damaged at byte {start}: the file ends without its end record"


def test_cut_anywhere_all_whole_records_come_out_and_the_offset_is_that_of_the_next(
    whole, tmp_path
):
    _, data, records, starts = whole
    rng = random.Random(5)
    for _ in range(200):
        size = rng.randrange(starts[0], len(data))
        found, damage = read(tmp_path / "cut.dp", data[:size])
        index = sum(start <= size for start in starts) - 1
        assert found == records[:index]
        assert damage.offset == starts[index]


def test_of_a_thousand_changed_bytes_each_costs_one_record_and_is_named(whole, tmp_path):
    _, data, records, starts = whole
    rng = random.Random(6)
    in_header = 0
    for _ in range(1000):
        place = rng.randrange(len(data))
        changed = bytearray(data)
        changed[place] ^= rng.randrange(1, 256)
        if place < starts[0]:
            in_header += 1
            with pytest.raises(DpFileError, match="damaged at byte 0"):
                read(tmp_path / "bad.dp", changed)
            continue
        found, damage = read(tmp_path / "bad.dp", changed)
        hit = sum(start <= place for start in starts) - 1
        assert found == records[:hit] + records[hit + 1 :]
        assert damage.offset == starts[hit]
    assert in_header < 200


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_changes_with_right_checksums_never_end_in_a_traceback(whole, tmp_path_factory, seed):
    _, data, _, starts = whole
    path = tmp_path_factory.getbasetemp() / "mutated.dp"
    path.write_bytes(mutated(data, starts, random.Random(seed)))
    use(path)


@settings(max_examples=60, deadline=None)
@given(data=st.binary(max_size=200))
def test_any_bytes_are_refused_or_read(whole, tmp_path_factory, data):
    path = tmp_path_factory.getbasetemp() / "any.dp"
    path.write_bytes(data)
    with pytest.raises(HarnessError):
        DpReader(path)
    path.write_bytes(whole[1][: whole[3][0]] + data)
    with DpReader(path) as reader:
        assert list(reader.records()) == []
        assert reader.damage.offset == whole[3][0]
