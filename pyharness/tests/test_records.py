# SPDX-License-Identifier: Apache-2.0
from pyharness.records import Outcome, RecordStream, end_payload, read_end


def test_every_subscriber_gets_the_records_numbered_in_order():
    first, second = [], []
    stream = RecordStream([first.append, second.append])
    stream.publish(3, 0.5, b"x")
    stream.publish(4, 0.25, b"")
    assert [(item.kind, item.time_s, item.sequence, item.payload) for item in first] == [
        (3, 0.5, 0, b"x"),
        (4, 0.25, 1, b""),
    ]
    assert second == first


def test_an_outcome_survives_its_record():
    outcome = Outcome("no_path", "tilt 12, ünknown")
    assert read_end(end_payload(outcome)) == outcome
    assert not outcome.is_reached
    assert Outcome("goal_reached").is_reached
