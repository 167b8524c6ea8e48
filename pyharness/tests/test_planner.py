# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from pyharness.dp import Kind, new_message
from pyharness.params import ParamDefinition, param_values
from pyharness.planner import own_param_faults
from pyharness.planners.enav import Enav
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


class Tuned(Enav):
    OWN_PARAMS = (ParamDefinition("reach_m", 2.0, 1.0, 5.0, "m", "how far"),)


def test_a_planner_has_its_own_parameters_with_defaults():
    sink = RecordStream().publish
    assert Tuned(param_values({}), sink).own_params == {"reach_m": 2.0}
    assert Tuned(param_values({}), sink, {"reach_m": 3.0}).own_params == {"reach_m": 3.0}


def test_values_out_of_range_and_unknown_names_are_faults():
    faults = own_param_faults(Tuned, {"reach_m": 9.0, "reach": 1.0})
    assert faults == {
        "reach_m": "expected 1 to 5 m, got 9",
        "reach": "unknown parameter (known: reach_m)",
    }
    assert own_param_faults(Enav, {}) == {}


def test_chance_comes_from_the_generator_given():
    rng = np.random.default_rng(3)
    assert Tuned(param_values({}), RecordStream().publish, None, rng).rng is rng
