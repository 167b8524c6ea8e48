# SPDX-License-Identifier: Apache-2.0
import pytest

from pyharness.called_safe import CalledSafe, called_safe
from pyharness.dp import Kind, native_schema, new_message
from pyharness.dp_file import DpReader
from pyharness.history import History
from pyharness.messages import Arc, timeline_record
from pyharness.records import Outcome, RecordStream, end_payload
from pyharness.status import Activity, HostEvr, Mode, Status

SPEED_M_S = 0.05


class Story:
    """A drive told by its records: the rover drives whenever an arc is told."""

    def __init__(self, info):
        self.history = History(native_schema(), info)
        self._stream = RecordStream([self.history.take])
        self.time_s = 0.0
        self.driven_m = 0.0

    def send(self, kind, **values):
        message = new_message(kind)
        for name, value in values.items():
            message[name] = value
        self._stream.publish(kind, self.time_s, message.tobytes())

    def event(self, event):
        self.send(Kind.HOST_EVR, time_s=self.time_s, id=event)

    def select(self, cycle, mode=Mode.AVOID_ALL, is_leaving=0, status=Status.OK):
        self.send(Kind.SELECT_ARC_IN, time_s=self.time_s, mode=mode)
        self.send(Kind.SELECT_ARC_OUT, status=status, is_leaving=is_leaving)
        self._bar(Activity.SELECT_ARC, self.time_s, self.time_s + 1.0, cycle)

    def drive(self, cycle, length_m=1.0, selecting=None):
        """Drive an arc; in its middle select the next."""
        start_s = self.time_s
        for half in range(2):
            for _ in range(10):
                self.time_s += length_m / SPEED_M_S / 20
                self.driven_m += length_m / 20
                self.send(Kind.TRUTH, time_s=self.time_s, distance_driven_m=self.driven_m)
            if half == 0 and selecting is not None:
                self.select(cycle, **selecting)
        self._bar(Activity.DRIVING, start_s, self.time_s, cycle)

    def end(self, outcome):
        self._stream.publish(0, self.time_s, end_payload(Outcome(outcome)))
        return called_safe(self.history)

    def _bar(self, activity, start_s, end_s, cycle):
        record = timeline_record(activity, start_s, end_s, cycle, Arc(0.0, 0.0))
        self._stream.publish(Kind.TIMELINE, self.time_s, record.tobytes())


@pytest.fixture
def story(drive_info):
    return Story(drive_info)


def safe(distance_m, leaving_m=0.0, violations=0, violations_leaving=0):
    return CalledSafe(
        pytest.approx(distance_m), pytest.approx(leaving_m), violations, violations_leaving
    )


def test_a_crawl_is_not_called_safe(story):
    story.event(HostEvr.CRAWL)
    story.drive(0, 5.5)
    story.select(0)
    story.drive(1, 1.0)
    assert story.end("goal_reached") == safe(1.0)


def test_an_arc_is_what_was_selected_while_the_one_before_was_driven(story):
    story.select(0)
    story.drive(1, 1.0, selecting={"is_leaving": 1})
    story.drive(2, 0.5, selecting={"mode": Mode.AVOID_KOZ})
    story.drive(3, 0.7, selecting={"mode": Mode.GUARDED})
    story.drive(4, 0.2)
    assert story.end("goal_reached") == safe(1.2, 0.5)


def test_the_last_selection_before_an_arc_counts(story):
    story.select(0, is_leaving=1)
    story.time_s += 5.0
    story.select(0, status=Status.NO_PATH)
    story.time_s += 5.0
    story.select(0)
    story.drive(1, 1.0)
    assert story.end("goal_reached") == safe(1.0)


def test_a_crawl_after_the_rover_was_set_down_elsewhere_is_not_called_safe(story):
    story.select(0)
    story.drive(1, 1.0)
    story.time_s += 1.0
    story.event(HostEvr.CRAWL)
    story.drive(1, 5.5)
    assert story.end("goal_reached") == safe(1.0)


@pytest.mark.parametrize(
    ("selected", "expected"),
    [
        ({}, safe(1.0, 0.0, 1)),
        ({"is_leaving": 1}, safe(0.0, 1.0, 0, 1)),
        ({"mode": Mode.UNGUARDED}, safe(0.0)),
    ],
)
def test_a_violation_counts_where_the_arc_had_passed(story, selected, expected):
    story.select(0, **selected)
    story.drive(1, 1.0)
    assert story.end("limit_violation") == expected


def test_a_violation_on_another_arc_does_not_count(story):
    story.select(0)
    story.drive(1, 1.0)
    story.time_s += 1.0
    story.event(HostEvr.DIRECTED_ARC)
    story.drive(1, 1.0)
    assert story.end("limit_violation") == safe(1.0)


def test_a_drive_that_never_moved_has_nothing(story):
    assert story.end("no_path") == CalledSafe(0.0, 0.0, 0, 0)


def test_of_a_real_drive_all_but_the_crawl_is_called_safe(quick_drive):
    with DpReader(quick_drive) as reader:
        history = History(reader.schema, reader.info)
        for record in reader.records():
            history.take(record)
    driven_m = float(history.truth["distance_driven_m"][-1])
    crawl_m = sum(
        float(bar["arc"]["length_m"])
        for bar in history.timeline
        if bar["activity"] == Activity.DRIVING and bar["cycle"] == 0
    )
    assert crawl_m > 5.0
    assert called_safe(history).distance_m == pytest.approx(driven_m - crawl_m, abs=0.15)
    assert called_safe(history).violations == 0
