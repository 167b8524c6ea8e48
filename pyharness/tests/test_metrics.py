# SPDX-License-Identifier: Apache-2.0
import csv
import io
import json

import pytest

from pyharness import metrics
from pyharness.dp import Kind, native_schema, new_message
from pyharness.history import History
from pyharness.records import Outcome, RecordStream, end_payload
from pyharness.status import Reason, Status


@pytest.fixture
def history(drive_info):
    """Two planning cycles, the second without a path, and three ticks of truth."""
    history = History(native_schema(), drive_info)
    stream = RecordStream([history.take])

    def send(kind, **values):
        message = new_message(kind)
        for name, value in values.items():
            message[name] = value
        stream.publish(kind, values["time_s"], message.tobytes())

    send(Kind.SELECT_ARC_IN, time_s=1.0)
    answer = new_message(Kind.SELECT_ARC_OUT)
    answer["ace_evaluations"] = 100
    answer["rejections"][Reason.COST] = 3
    answer["arc"]["length_m"] = 1.0
    stream.publish(Kind.SELECT_ARC_OUT, 1.0, answer.tobytes())
    send(Kind.TRUTH, distance_driven_m=1.0, time_s=10.0, clearance_m=0.5, rocker_rad=-0.1)
    send(Kind.TRUTH, distance_driven_m=2.0, time_s=20.0, clearance_m=0.4)
    send(Kind.SELECT_ARC_IN, time_s=21.0)
    answer["ace_evaluations"] = 300
    answer["status"] = Status.NO_PATH
    stream.publish(Kind.SELECT_ARC_OUT, 21.0, answer.tobytes())
    nan = float("nan")
    send(Kind.TRUTH, time_s=3600.0, distance_driven_m=2.5, clearance_m=nan)
    estimate = new_message(Kind.ESTIMATE)
    estimate["pose"]["x_site_m"], estimate["pose"]["y_site_m"] = 3.0, 4.0
    stream.publish(Kind.ESTIMATE, 3600.0, estimate.tobytes())
    stream.publish(0, 3600.0, end_payload(Outcome("no_path", "all of them")))
    return history


def test_the_summary_has_these_keys_in_this_order(history):
    assert list(metrics.summarize(history)) == [
        "outcome",
        "fault_detail",
        "planner",
        "mode",
        "seed",
        "distance_driven_m",
        "distance_straight_m",
        "path_inefficiency",
        "duration_sim_s",
        "drive_rate_m_per_h",
        "planning_cycles",
        "ace_evaluations_mean",
        "ace_evaluations_max",
        "overthink_rate",
        "clearance_min_m",
        "tilt_max_rad",
        "rocker_max_rad",
        "bogie_max_rad",
        "wheel_drop_max_m",
        "slip_max",
        "localization_error_final_m",
        "distance_called_safe_m",
        "distance_leaving_m",
        "violations_called_safe",
        "violations_leaving",
        "rejections",
    ]


def test_the_numbers_are_right(history):
    summary = metrics.summarize(history)
    expected = {
        "outcome": "no_path",
        "fault_detail": "all of them",
        "seed": 7,
        "distance_driven_m": 2.5,
        "distance_straight_m": 20.0,
        "path_inefficiency": 2.5 / 20.0 - 1.0,
        "duration_sim_s": 3600.0,
        "drive_rate_m_per_h": 2.5,
        "planning_cycles": 2,
        "ace_evaluations_mean": 200.0,
        "ace_evaluations_max": 300,
        "overthink_rate": 0.5,
        "clearance_min_m": 0.4,
        "rocker_max_rad": 0.1,
        "localization_error_final_m": 5.0,
    }
    assert {key: summary[key] for key in expected} == expected
    assert summary["rejections"]["cost"] == 6
    assert "none" not in summary["rejections"]


def test_a_drive_without_a_step_still_has_a_summary(drive_info):
    summary = metrics.summarize(History(native_schema(), drive_info))
    assert summary["clearance_min_m"] is None
    assert json.loads(metrics.summary_text(summary))["distance_driven_m"] == 0.0


def test_there_is_one_row_per_planning_cycle(history):
    rows = list(csv.DictReader(io.StringIO(metrics.cycles_csv(history))))
    assert [row["status"] for row in rows] == ["ok", "no_path"]
    assert [row["distance_driven_m"] for row in rows] == ["0", "2"]
    assert rows[0]["arc_length_m"] == "1"
    assert rows[1]["arc_length_m"] == ""


def test_there_is_one_row_per_tick(history):
    rows = list(csv.DictReader(io.StringIO(metrics.truth_csv(history))))
    assert [row["time_s"] for row in rows] == ["10", "20", "3600"]
    assert rows[2]["clearance_m"] == "nan"
