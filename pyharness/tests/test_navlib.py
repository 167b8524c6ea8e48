# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from pyharness.dp import Kind, native_schema, new_message
from pyharness.messages import Pose6, cloud_requests
from pyharness.navlib import Navlib, NavlibError, Zones, zone_fault
from pyharness.params import param_values
from pyharness.status import Status, ZoneKind

LEVEL = Pose6(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def circle(kind=ZoneKind.KEEP_OUT, radius_m=2.0):
    request = new_message(Kind.SET_KIOZ_IN)
    request["zone_count"] = 1
    request["zones"][0]["kind"] = kind
    request["zones"][0]["radius_m"] = radius_m
    return request


def kinds(navlib):
    return [kind for kind, _, _ in navlib.drain() if kind != Kind.EVR]


def test_every_call_sends_its_input_and_output():
    navlib = Navlib(param_values({}))
    assert kinds(navlib) == [Kind.INIT_IN, Kind.INIT_OUT]
    assert navlib.set_kioz(circle())["status"] == Status.OK
    assert kinds(navlib) == [Kind.SET_KIOZ_IN, Kind.SET_KIOZ_OUT]
    assert kinds(navlib) == []


def test_records_arrive_as_they_were_given():
    navlib = Navlib(param_values({}))
    navlib.set_kioz(circle(radius_m=3.5))
    payloads = {kind: payload for kind, _, payload in navlib.drain()}
    zones = native_schema().decode(Kind.SET_KIOZ_IN, payloads[Kind.SET_KIOZ_IN])
    assert zones.tobytes() == circle(radius_m=3.5).tobytes()


def test_a_cloud_is_merged():
    navlib = Navlib(param_values({}))
    points = np.array([[3.0, 0.0, 0.1], [3.0, 1.0, 0.2], [90.0, 0.0, 0.0]], dtype=np.float32)
    (request,) = cloud_requests(0.0, LEVEL, 1, points)
    answer = navlib.process_disparity(request)
    assert (answer["status"], answer["merged_count"], answer["outside_count"]) == (Status.OK, 2, 1)


def test_a_call_out_of_order_is_refused_with_a_status():
    navlib = Navlib(param_values({}))
    assert navlib.select_arc(new_message(Kind.SELECT_ARC_IN))["status"] == Status.ORDER


def test_a_foreign_record_never_reaches_c():
    navlib = Navlib(param_values({}))
    with pytest.raises(NavlibError, match="takes a nav_select_arc_in_t"):
        navlib.select_arc(new_message(Kind.EVALUATE_ARC_IN))


def test_parameters_out_of_range_are_refused():
    with pytest.raises(NavlibError, match="outside its range"):
        Navlib({**param_values({}), "tilt_max_rad": 9.0})


def test_two_contexts_do_not_disturb_each_other():
    one, two = Navlib(param_values({})), Navlib(param_values({}))
    list(one.drain())
    one.set_kioz(circle())
    assert two.select_arc(new_message(Kind.SELECT_ARC_IN))["status"] == Status.ORDER


def test_zones_forbid_where_they_lie():
    assert Zones(circle()).forbids(0.0, 1.9)
    assert not Zones(circle()).forbids(0.0, 2.1)
    assert Zones(circle(ZoneKind.KEEP_IN)).forbids(0.0, 2.1)
    assert not Zones(new_message(Kind.SET_KIOZ_IN)).forbids(0.0, 0.0)


def test_a_degenerate_zone_has_a_fault():
    assert zone_fault(circle()["zones"][0]) is None
    assert "degenerate" in zone_fault(circle(radius_m=0.0)["zones"][0])
