# SPDX-License-Identifier: Apache-2.0
import math

import numpy as np
import pytest

from pyharness.messages import Arc, Pose6, Uncertainty, cloud_requests, pose_after, select_request
from pyharness.records import Waypoint

NORTH = Pose6(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def test_a_quarter_circle_ends_where_geometry_says():
    end = pose_after(NORTH, Arc(math.pi / 2, math.pi / 2))
    assert (end.x_m, end.y_m, end.yaw_rad) == pytest.approx((1.0, 1.0, math.pi / 2))


def test_a_turn_in_place_moves_nothing():
    end = pose_after(NORTH, Arc(0.0, 1.0))
    assert (end.x_m, end.y_m, end.yaw_rad) == (0.0, 0.0, 1.0)


def test_the_ground_under_the_rover_goes_on():
    end = pose_after(Pose6(0.0, 0.0, 0.0, 0.0, math.radians(10), 0.0), Arc(1.0, 0.0))
    assert end.z_m == pytest.approx(-math.tan(math.radians(10)))


def test_the_parts_of_an_arc_make_the_arc():
    arc = Arc(1.0, 0.4)
    halfway = pose_after(NORTH, arc.part(0.25))
    end, whole = pose_after(halfway, arc.part(0.75)), pose_after(NORTH, arc)
    assert (end.x_m, end.y_m, end.yaw_rad) == pytest.approx((whole.x_m, whole.y_m, whole.yaw_rad))


@pytest.mark.parametrize(("count", "chunks"), [(0, 1), (1, 1), (8192, 1), (8193, 2), (20000, 3)])
def test_a_cloud_is_cut_into_full_chunks(count, chunks):
    points = np.arange(3 * count, dtype=np.float32).reshape(-1, 3)
    requests = list(cloud_requests(1.0, NORTH, 5, points))
    assert [int(item["chunk_index"]) for item in requests] == list(range(chunks))
    assert {int(item["chunk_count"]) for item in requests} == {chunks}
    axes = ("x_m", "y_m", "z_m")
    used = [item["points"][: int(item["point_count"])] for item in requests]
    parts = [np.column_stack([part[axis] for axis in axes]) for part in used]
    np.testing.assert_array_equal(np.concatenate(parts), points)


def test_a_cloud_of_another_type_is_refused():
    with pytest.raises(ValueError, match="float32 cloud"):
        list(cloud_requests(0.0, NORTH, 1, np.zeros((4, 3))))


@pytest.mark.parametrize(
    ("arc", "in_place", "curvature"),
    [(Arc(0.0, 0.0), 0, 0.0), (Arc(0.0, 0.5), 1, 0.0), (Arc(2.0, 0.5), 0, 0.25)],
)
def test_the_steering_of_the_driven_arc_is_stated(arc, in_place, curvature):
    goal = Waypoint(1.0, 2.0, 3.0, "guarded")
    request = select_request(0.0, NORTH, Uncertainty(0.1, 0.2, 0.3), goal, arc)
    assert int(request["steering"]["in_place"]) == in_place
    assert float(request["steering"]["curvature_per_m"]) == curvature
    assert int(request["mode"]) == 1
