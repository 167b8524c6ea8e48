# SPDX-License-Identifier: Apache-2.0
import pytest

from pyharness.dp import Kind, new_message
from pyharness.params import param_values
from pyharness.records import RecordStream


def test_what_goes_in_and_out_of_any_planner_is_recorded(fake_planner):
    records = []
    planner = fake_planner(param_values({}), RecordStream([records.append]).publish)
    request = new_message(Kind.EVALUATE_ARC_IN)
    request["time_s"] = 3.0
    planner.evaluate_arc(request)
    assert [(item.kind, item.time_s) for item in records] == [
        (Kind.INIT_IN, 0.0),
        (Kind.INIT_OUT, 0.0),
        (Kind.EVALUATE_ARC_IN, 3.0),
        (Kind.EVALUATE_ARC_OUT, 3.0),
    ]
    assert records[2].payload == request.tobytes()


def test_a_planner_without_zones_refuses_them(fake_planner):
    planner = fake_planner(param_values({}), RecordStream().publish)
    request = new_message(Kind.SET_KIOZ_IN)
    assert planner.set_kioz(request)["status"] == 0
    request["zone_count"] = 1
    with pytest.raises(NotImplementedError, match="knows no zones"):
        planner.set_kioz(request)
