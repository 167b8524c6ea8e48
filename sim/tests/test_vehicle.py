# SPDX-License-Identifier: Apache-2.0
"""The vehicle file."""

import re
from pathlib import Path

import numpy as np
import pytest

from sim.config import dump_model
from sim.errors import ConfigError
from sim.vehicle import Vehicle, load_vehicle


def test_the_default_is_perseverance(vehicle: Vehicle) -> None:
    assert vehicle.geometry.wheel_radius_m == 0.26288
    assert vehicle.hubs_m[0, 0] - vehicle.hubs_m[2, 0] == pytest.approx(2.26)
    assert vehicle.hubs_m[4, 1] - vehicle.hubs_m[1, 1] == pytest.approx(2.369)


def test_the_right_side_mirrors_the_left(vehicle: Vehicle) -> None:
    for points in (
        vehicle.hubs_m.reshape(2, 3, 3),
        vehicle.rocker_pivots_m[:, None],
        vehicle.bogie_pivots_m[:, None],
    ):
        np.testing.assert_array_equal(points[1], points[0] * [1, -1, 1])


def test_navlib_limits_leave_a_margin_to_the_faults(vehicle: Vehicle) -> None:
    keep, fault = vehicle.navlib_limits, vehicle.fault_limits
    assert keep.tilt_max_deg < fault.tilt_max_deg
    assert keep.rocker_max_deg < fault.rocker_max_deg
    assert keep.bogie_max_deg < fault.bogie_max_deg
    assert keep.wheel_drop_max_m < fault.wheel_drop_max_m
    assert vehicle.belly.height_m - keep.clearance_margin_m > fault.clearance_min_m


def test_another_vehicle_is_another_file(vehicle: Vehicle, tmp_path: Path) -> None:
    path = tmp_path / "small.yaml"
    path.write_text(dump_model(vehicle).replace("name: perseverance", "name: small"))
    small = load_vehicle(path, {"geometry.wheel_radius_m": 0.2})
    assert (small.name, small.geometry.wheel_radius_m) == ("small", 0.2)


@pytest.mark.parametrize(
    ("key", "value", "fault"),
    [
        ("geometry.wheel_radius_m", 0, "expected > 0.0"),
        ("geometry.hub_left_front_m", [-2, -1, 0], "front, middle, rear"),
        ("geometry.hub_left_front_m", [1, 1, 0], "negative y"),
        ("belly.rear_m", 2, "rear_m must be less"),
        ("settling.wheel", "square", "expected one of point, disc, cylinder"),
        ("fault_limits.tilt_max_deg", 95, "expected < 90.0"),
    ],
)
def test_bad_vehicles_are_refused(key: str, value: object, fault: str) -> None:
    with pytest.raises(ConfigError, match=re.escape(fault)):
        load_vehicle(overrides={key: value})
