# SPDX-License-Identifier: Apache-2.0
"""Bulk figures of data product files: only when asked for, on a machine with nothing else to do."""

import time

import pytest

from pyharness.dp_file import DpReader, DpWriter
from pyharness.drive import drive
from pyharness.planners.enav import Enav
from pyharness.records import Record, RecordStream
from pyharness.rerun import compare
from pyharness.scenario import drive_info, load_scenario, make_terrain

pytestmark = [pytest.mark.verify, pytest.mark.timeout(600)]

DRIVE_S = 2300.0  # simulated, of the demonstration drive
FASTER_LEAST = 50.0


@pytest.fixture(scope="module")
def demonstration(tmp_path_factory):
    """The demonstration drive: its file, and the seconds it took to drive it."""
    path = tmp_path_factory.mktemp("speed") / "drive.dp"
    scenario = load_scenario(None, {})
    terrain = make_terrain(scenario)
    start_s = time.perf_counter()
    with DpWriter(path, drive_info(scenario)) as writer:
        assert drive(scenario, terrain, Enav, RecordStream([writer.write])).is_reached
    return path, time.perf_counter() - start_s


def test_an_80_m_drive_is_smaller_than_100_mb(demonstration):
    assert demonstration[0].stat().st_size < 100e6


def test_100_mb_are_scanned_and_checked_in_a_second(demonstration, tmp_path):
    path = tmp_path / "large.dp"
    with DpReader(demonstration[0]) as reader, DpWriter(path, reader.info) as writer:
        records = list(reader.records())[:-1]
        sequence = 0
        while path.stat().st_size < 100e6:
            for record in records:
                writer.write(Record(record.kind, record.time_s, sequence, record.payload))
                sequence += 1
    start_s = time.perf_counter()
    with DpReader(path) as reader:
        count = sum(1 for _ in reader.records())
    duration_s = time.perf_counter() - start_s
    print(f"\n{path.stat().st_size / 1e6:.0f} MB, {count} records: {duration_s:.2f} s")  # noqa: T201
    assert count == sequence
    assert duration_s / (path.stat().st_size / 100e6) < 1.0


def test_a_rerun_is_many_times_faster_than_the_drive(demonstration):
    path, drive_s = demonstration
    start_s = time.perf_counter()
    with DpReader(path) as reader:
        comparison = compare(reader.records(), reader.schema, Enav)
    duration_s = time.perf_counter() - start_s
    assert comparison.difference is None
    print(  # noqa: T201
        f"\nre-run {duration_s:.2f} s: {DRIVE_S / duration_s:.0f} times faster than the rover,"
        f" {drive_s / duration_s:.1f} times faster than the simulation"
    )
    assert DRIVE_S / duration_s > FASTER_LEAST
