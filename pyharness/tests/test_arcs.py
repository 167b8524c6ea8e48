# SPDX-License-Identifier: Apache-2.0
import math

import numpy as np
import pytest

from pyharness.clib import ffi, lib
from pyharness.planners.arcs import Place, arc_points, wrapped

PLACE = Place(3.0, -2.0, 0.7)


@pytest.mark.parametrize("arc", [(3.0, 0.0), (2.0, 0.9), (-1.5, -0.4), (1.0, 1e-9)])
def test_points_lie_where_navlib_has_its_poses(arc):
    length_m, heading_rad = arc
    points = arc_points(PLACE, length_m, heading_rad, 0.25)[0]
    start = ffi.new("nav_pose2_t *", (PLACE.x_m, PLACE.y_m, PLACE.yaw_rad))
    c_arc = ffi.new("nav_arc_t *", (length_m, heading_rad))
    for index, (north_m, east_m) in enumerate(points, start=1):
        pose = lib.nav_arc_pose(start, c_arc, index / len(points))
        assert (north_m, east_m) == pytest.approx((pose.x_m, pose.y_m), abs=1e-9)


def test_points_are_as_dense_as_asked_on_the_longest_arc():
    points = arc_points(PLACE, [1.0, 2.0], [0.0, 0.0], 0.25)
    assert points.shape == (2, 8, 2)
    assert np.hypot(*(points[1, 0] - (PLACE.x_m, PLACE.y_m))) == pytest.approx(0.25)


def test_a_turn_in_place_stays_where_it_is():
    assert arc_points(PLACE, 0.0, 1.0, 0.25)[0] == pytest.approx(np.array([[3.0, -2.0]]))


def test_a_turn_before_an_arc_turns_the_arc():
    turned = arc_points(PLACE, [2.0, 2.0], [0.5, 0.5], 0.25, [0.0, 0.3])[1]
    other = arc_points(Place(3.0, -2.0, 1.0), 2.0, 0.5, 0.25)[0]
    assert turned == pytest.approx(other)


def test_angles_are_wrapped_to_half_a_turn():
    assert wrapped(1.5 * math.pi) == pytest.approx(-0.5 * math.pi)
