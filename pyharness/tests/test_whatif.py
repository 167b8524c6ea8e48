# SPDX-License-Identifier: Apache-2.0
import pytest

from pyharness.dp import native_schema
from pyharness.dp_file import DpReader
from pyharness.errors import HarnessError
from pyharness.history import History
from pyharness.planners.enav import Enav
from pyharness.records import RecordStream
from pyharness.rerun import rerun_into
from pyharness.whatif import changed_params, comparison_text
from sim.errors import ConfigError

NOTHING_PASSES = {"clearance_min_m": 0.59, "leave_clearance_min_m": 0.59}


def what_if(path, planner_class, params):
    with DpReader(path) as reader:
        recorded = History(reader.schema, reader.info)
        again = History(native_schema(), reader.info)
        for record in reader.records():
            recorded.take(record)
        stream = RecordStream([again.take])
        rerun_into(stream, reader.records(), reader.schema, planner_class, params)
    return recorded, again


def test_nothing_changed_shows_no_difference(quick_drive):
    recorded, again = what_if(quick_drive, Enav, {})
    text = comparison_text(recorded, again)
    assert f"selected arcs that changed: 0 of {len(recorded.selections)}" in text
    assert f"evaluations of arcs that changed: 0 of {len(recorded.evaluations)}" in text


def test_a_limit_that_nothing_passes_shows_every_cycle_without_a_path(quick_drive):
    recorded, again = what_if(quick_drive, Enav, NOTHING_PASSES)
    count = len(recorded.selections)
    text = comparison_text(recorded, again)
    assert f"selected arcs that changed: {count} of {count}" in text
    assert f"cycles without a path              0         {count}\n" in text
    assert text.count("no_path") == count
    assert "clearance at pose 0" in text
    assert again.params["clearance_min_m"] == 0.59


def test_another_planner_answers_the_same_requests(quick_drive, fake_planner):
    recorded, again = what_if(quick_drive, fake_planner, {})
    assert len(again.selections) == len(recorded.selections)
    for (asked, _), (asked_again, answer) in zip(
        recorded.selections, again.selections, strict=True
    ):
        assert asked.tobytes() == asked_again.tobytes()
        assert float(answer["arc"]["length_m"]) == 1.0


def test_settings_are_parameters_by_their_scenario_keys():
    assert changed_params([("navlib.tilt_max_rad", "0.3")]) == {"tilt_max_rad": 0.3}


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("tilt_max_rad", "0.3", "expected navlib.NAME"),
        ("seed", "3", "expected navlib.NAME"),
        ("navlib.tilt_mx_rad", "0.3", "did you mean 'tilt_max_rad'"),
        ("navlib.tilt_max_rad", "steep", "expected a number"),
        ("navlib.tilt_max_rad", "9", "expected 0.05 to 1.2 rad, got 9"),
    ],
)
def test_what_is_no_parameter_is_refused_with_its_key(key, value, message):
    with pytest.raises((HarnessError, ConfigError), match=message) as caught:
        changed_params([(key, value)])
    assert key in str(caught.value)
