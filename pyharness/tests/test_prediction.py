# SPDX-License-Identifier: Apache-2.0
import math
from dataclasses import replace

import pytest

from pyharness.executive_config import PoseUncertainty
from pyharness.messages import Arc
from pyharness.prediction import Predictor


@pytest.fixture
def world(fake_world):
    world = fake_world()
    world.state = replace(world.state, x_m=2.0, yaw_rad=math.pi / 2, sigma_local_m=0.04)
    return world


def test_the_pose_is_that_at_the_arcs_end_shifted_by_the_expected_slip(world, expected_slip):
    world.slip = expected_slip(0.01, -0.03, 0.02, 0.005)
    pose, _ = Predictor(world, PoseUncertainty()).at_end(Arc(0.5, 0.0))
    assert (pose.x_m, pose.y_m) == pytest.approx((2.01, 0.47))


def test_uncertainty_adds_the_fix_the_motion_since_it_and_the_spread_of_slip(world, expected_slip):
    config = PoseUncertainty(slip_sigmas=2.0)
    predictor = Predictor(world, config)
    now = predictor.now()
    assert now.position_m == pytest.approx(config.position_base_m + 0.04)
    world.slip = expected_slip(0.0, 0.0, 0.02, 0.005)
    _, end = predictor.at_end(Arc(0.5, 0.0))
    assert end.position_m - now.position_m == pytest.approx(0.04)
    assert end.yaw_rad - now.yaw_rad == pytest.approx(0.01)


def test_zones_grow_by_three_sigmas_of_the_error_before_the_next_fix(world):
    predictor = Predictor(world, PoseUncertainty())
    assert predictor.now().global_position_m == pytest.approx(3 * 0.1)
    ahead_m = 0.5 + predictor.config.unfixed_ahead_m
    _, end = predictor.at_end(Arc(0.5, 0.0))
    assert end.global_position_m == pytest.approx(3 * (0.1 + 0.1 * ahead_m))
