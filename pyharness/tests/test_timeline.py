# SPDX-License-Identifier: Apache-2.0
from pyharness.dp import Kind
from pyharness.dp_file import DpWriter
from pyharness.messages import Arc, timeline_record
from pyharness.records import RecordStream
from pyharness.status import Activity
from pyharness.timeline import draw_timeline_of


def test_the_activities_of_a_recorded_drive_are_drawn(tmp_path, drive_info):
    with DpWriter(tmp_path / "drive.dp", drive_info) as writer:
        stream = RecordStream([writer.write])
        for cycle in range(8):
            record = timeline_record(Activity.DRIVING, 20.0 * cycle, 20.0, cycle, Arc(1.0, 0.0))
            stream.publish(Kind.TIMELINE, 20.0 * cycle, record.tobytes())
    draw_timeline_of(tmp_path / "drive.dp", tmp_path / "t.png")
    assert (tmp_path / "t.png").read_bytes().startswith(b"\x89PNG")
