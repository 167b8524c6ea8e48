# SPDX-License-Identifier: Apache-2.0
import pytest

from pyharness.dp import Kind, new_message
from pyharness.evr import evr_line, evr_table, evr_text


def test_every_text_has_as_many_places_as_arguments():
    for row in evr_table().values():
        assert row.text.count("{}") == row.arg_count, row.name


def test_arguments_are_filled_in_without_needless_digits():
    by_name = {row.name: row.evr_id for row in evr_table().values()}
    assert (
        evr_text(by_name["ZONES_SET"], [2.0, 1.0, 0.0, 0.0]) == "2 keep-out and 1 keep-in zones set"
    )


def test_a_line_names_time_severity_and_event():
    evr = new_message(Kind.EVR)
    evr["time_s"], evr["id"] = 12.5, next(iter(evr_table()))
    row = evr_table()[int(evr["id"])]
    assert evr_line(evr).split()[:3] == ["12.500", row.severity, row.name]


@pytest.mark.parametrize("evr_id", [0, 9999])
def test_an_unknown_event_is_shown_as_it_is(evr_id):
    assert "unknown event" in evr_text(evr_id, [1.0])
