# SPDX-License-Identifier: Apache-2.0
import pytest

from pyharness.dp import Kind, native_schema
from pyharness.evr import evr_line
from pyharness.status import HostEvr, Severity
from pyharness.telemetry import Telemetry


def test_an_event_is_a_record_with_the_text_of_its_table(fake_world):
    records = []
    telemetry = Telemetry(fake_world(), lambda *record: records.append(record))
    telemetry.event(HostEvr.FAULT_NO_PATH, 4, 3, 1694)
    ((kind, time_s, payload),) = records
    assert (kind, time_s) == (Kind.HOST_EVR, 0.0)
    assert native_schema().decode(kind, payload)["severity"] == Severity.WARNING_HIGH
    line = evr_line(native_schema().decode(kind, payload))
    assert line.split(maxsplit=3) == [
        "0.000",
        "WARNING_HIGH",
        "FAULT_NO_PATH",
        "fault no_path: 4 in a row, most rejected by reason 3, 1694 times",
    ]


def test_an_event_with_other_arguments_than_its_text_is_a_defect(fake_world):
    with pytest.raises(ValueError, match="STOPPED: expected 0"):
        Telemetry(fake_world(), lambda *_: None).event(HostEvr.STOPPED, 1.0)
