# SPDX-License-Identifier: Apache-2.0
import pytest

from pyharness.dp import native_schema
from pyharness.history import History


@pytest.fixture
def history(drive_info, some_records):
    history = History(native_schema(), drive_info)
    for record in some_records:
        history.take(record)
    return history


def test_records_are_sorted(history):
    assert len(history.selections) == 1
    assert history.distances_m == [0.0]
    assert history.truth["distance_driven_m"].tolist() == [4.0]
    assert history.outcome.is_reached


def test_a_stream_without_an_end_is_unfinished(drive_info, some_records):
    history = History(native_schema(), drive_info)
    for record in some_records[:-1]:
        history.take(record)
    assert history.outcome.outcome == "unfinished"


def test_the_heightmap_is_as_large_as_its_cells(history):
    assert history.heightmap_size_m == pytest.approx(30.0)
