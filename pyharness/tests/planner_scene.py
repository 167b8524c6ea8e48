# SPDX-License-Identifier: Apache-2.0
"""A planner that has seen ground; the rover stands at the origin and heads north to the goal."""

import numpy as np

from pyharness import messages
from pyharness.dp import Kind, new_message
from pyharness.messages import Arc, Pose6, Uncertainty
from pyharness.params import param_values
from pyharness.records import RecordStream, Waypoint
from pyharness.status import Status

HERE = Pose6(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
CERTAIN = Uncertainty(0.02, 0.003, 0.1)


def rocks(*places):
    """Ground, z down, with boxes (north, east, half side, height) on a plane."""

    def ground(north_m, east_m):
        z_m = np.zeros_like(north_m)
        for rock_north_m, rock_east_m, half_m, height_m in places:
            inside = np.maximum(abs(north_m - rock_north_m), abs(east_m - rock_east_m)) <= half_m
            z_m = np.where(inside, -height_m, z_m)
        return z_m

    return ground


class Scene:
    """A planner, and what it says."""

    def __init__(self, planner_class, ground, own_params=None, goal_m=(30.0, 0.0), seed=0):
        self.records = []
        stream = RecordStream([self.records.append])
        rng = np.random.default_rng(seed)
        self.planner = planner_class(param_values({}), stream.publish, own_params, rng)
        self.goal_m = goal_m
        axis_m = np.arange(-14.975, 15.0, 0.05)
        north_m, east_m = np.meshgrid(axis_m, axis_m, indexing="ij")
        z_m = ground(north_m, east_m)
        cloud_m = np.stack([north_m, east_m, z_m], axis=-1).reshape(-1, 3).astype(np.float32)
        for request in messages.cloud_requests(0.0, HERE, 1, cloud_m[np.isfinite(cloud_m[:, 2])]):
            assert self.planner.process_disparity(request)["status"] == Status.OK

    def forbid(self, north_m, east_m, radius_m):
        """Set one keep-out circle."""
        request = new_message(Kind.SET_KIOZ_IN)
        request["zone_count"] = 1
        zone = request["zones"][0]
        zone["center_x_site_m"], zone["center_y_site_m"] = north_m, east_m
        zone["radius_m"] = radius_m
        assert self.planner.set_kioz(request)["status"] == Status.OK

    def goal(self, mode="avoid_all"):
        return Waypoint(*self.goal_m, 2.0, mode)

    def analyze(self):
        request = messages.analyze_request(0.0, HERE, self.goal(), 0.1)
        assert self.planner.analyze_terrain(request)["status"] == Status.OK
        return self

    def select(self, mode="avoid_all", pose=HERE):
        request = messages.select_request(0.0, pose, CERTAIN, self.goal(mode), Arc(1.0, 0.0))
        return self.planner.select_arc(request)

    def evaluate(self, length_m, heading_rad=0.0, mode="avoid_all", pose=HERE):
        request = messages.evaluate_request(0.0, pose, CERTAIN, Arc(length_m, heading_rad), mode)
        return self.planner.evaluate_arc(request)
