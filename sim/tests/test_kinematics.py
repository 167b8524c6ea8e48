# SPDX-License-Identifier: Apache-2.0
"""Arcs and steering against published numbers."""

import math

import numpy as np
import pytest

from sim.kinematics import (
    Arc,
    duration_s,
    pose_along,
    steering_angles_rad,
    steering_duration_s,
    wheel_path_m,
)
from sim.vehicle import Vehicle

START = (1.0, 2.0, 0.5)


def test_a_straight_metre_takes_24_s(vehicle: Vehicle) -> None:
    assert duration_s(Arc(1.0, 0.0), vehicle) == pytest.approx(23.81, abs=0.01)
    assert duration_s(Arc(-1.0, 0.0), vehicle) == pytest.approx(23.81, abs=0.01)


@pytest.mark.parametrize(
    ("radius_m", "left_deg", "right_deg", "rear_deg", "speed_cm_s"),
    [
        (1.5, 69.7, 24.8, (-67.9, -22.8), 2.23),
        (3, 31.5, 16.3, (-29.0, -14.8), 2.98),
        (10, 7.6, 6.1, (-6.9, -5.6), 3.76),
    ],
)
def test_steering_and_speed_match_the_table(
    vehicle: Vehicle,
    radius_m: float,
    left_deg: float,
    right_deg: float,
    rear_deg: tuple[float, float],
    speed_cm_s: float,
) -> None:
    """The table's turns are to the left: the inner, left wheels steer more."""
    angles = np.degrees(steering_angles_rad(-1 / radius_m, vehicle))
    np.testing.assert_allclose(-angles, [left_deg, rear_deg[0], right_deg, rear_deg[1]], atol=0.1)
    arc = Arc(1.0, -1.0 / radius_m)
    assert 100 / duration_s(arc, vehicle) == pytest.approx(speed_cm_s, abs=0.01)


def test_turning_in_place(vehicle: Vehicle) -> None:
    arc = Arc(0.0, math.radians(90))
    assert arc.is_turn_in_place
    assert duration_s(arc, vehicle) == pytest.approx(90 / 1.51, rel=0.005)
    angles = np.degrees(steering_angles_rad(math.inf, vehicle))
    np.testing.assert_allclose(np.abs(angles), [48.1, 45.3, 48.1, 45.3], atol=0.1)
    assert pose_along(START, arc, 1.0) == pytest.approx((1.0, 2.0, 0.5 + math.pi / 2))


def test_steering_takes_the_time_of_the_corner_that_turns_most(vehicle: Vehicle) -> None:
    assert steering_duration_s(0.0, math.inf, vehicle) == pytest.approx(48.12 / 5, abs=0.01)
    assert steering_duration_s(0.3, 0.3, vehicle) == 0.0
    assert steering_duration_s(math.inf, math.inf, vehicle) == 0.0


@pytest.mark.parametrize("heading_rad", [-2.0, -1e-9, 0.0, 1e-9, 0.7, 6.0])
def test_arcs_have_their_length_and_heading(heading_rad: float) -> None:
    arc = Arc(2.0, heading_rad)
    points = np.array([pose_along(START, arc, f) for f in np.linspace(0, 1, 4001)])
    length = np.hypot(*np.diff(points[:, :2], axis=0).T).sum()
    assert length == pytest.approx(2.0, rel=1e-5)
    assert points[-1, 2] == pytest.approx(0.5 + heading_rad)
    assert points[0] == pytest.approx(np.array(START))


def test_a_right_turn_goes_right() -> None:
    x_m, y_m, _ = pose_along((0, 0, 0), Arc(1.0, 0.5), 1.0)
    assert y_m > 0
    assert x_m < 1
    back_x, back_y, back_yaw = pose_along((0, 0, 0), Arc(-1.0, 0.5), 1.0)
    assert back_x < 0
    assert back_y < 0
    assert back_yaw == 0.5


def test_doing_nothing_takes_no_time(vehicle: Vehicle) -> None:
    assert wheel_path_m(Arc(0.0, 0.0), vehicle) == 0.0
