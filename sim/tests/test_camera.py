# SPDX-License-Identifier: Apache-2.0
"""Stereo clouds: geometry, occlusion, noise."""

import math

import numpy as np
import pytest

from sim.camera import CameraConfig, StereoCamera, load_stereo_pair, range_sigma_m
from sim.frames import rotation
from sim.settle import SettledState, Settler
from sim.terrain import Terrain
from sim.tests.conftest import terrain_of
from sim.vehicle import Vehicle

RNG = np.random.default_rng


def settled(terrain: Terrain, vehicle: Vehicle, yaw_rad: float = 0.0) -> SettledState:
    return Settler(terrain, vehicle).settle(0.0, 0.0, yaw_rad)


def clean(**settings: object) -> CameraConfig:
    return CameraConfig.model_validate(
        {"disparity_sigma_px": 0.0, "cloud_width_px": 80, "cloud_height_px": 60, **settings}
    )


def test_the_pair_has_the_published_baseline() -> None:
    pair = load_stereo_pair("navcam")
    assert math.dist(pair.left_center_m, pair.right_center_m) == pytest.approx(0.4244, abs=1e-4)


def test_clean_points_lie_on_the_ground(rocky: Terrain, vehicle: Vehicle) -> None:
    state = settled(rocky, vehicle, 0.8)
    cloud = StereoCamera(rocky, vehicle, clean()).image(state, RNG(0))
    assert cloud.dtype == np.float32
    assert len(cloud) > 2000
    turn = rotation(state.roll_rad, state.pitch_rad, state.yaw_rad)
    site = cloud.astype(float) @ turn.T + [state.x_m, state.y_m, state.z_m]
    gap = rocky.height_at(site[:, 0], site[:, 1]) - site[:, 2]
    assert np.abs(gap).max() < 1e-4


def test_the_view_on_flat_ground(flat: Terrain, vehicle: Vehicle) -> None:
    state = settled(flat, vehicle)
    cloud = StereoCamera(flat, vehicle, clean()).image(state, RNG(0))
    np.testing.assert_allclose(cloud[:, 2], 0.0, atol=1e-4)
    assert 1.5 < cloud[:, 0].min() < 2.2
    assert np.linalg.norm(cloud[:, :2], axis=1).max() > 15
    right = StereoCamera(flat, vehicle, clean(azimuths_deg=(60.0,))).image(state, RNG(0))
    assert np.median(right[:, 1]) > np.median(cloud[:, 1]) + 2
    both = StereoCamera(flat, vehicle, clean(azimuths_deg=(0.0, 60.0))).image(state, RNG(0))
    assert len(both) == len(cloud) + len(right)


def test_a_wall_hides_what_is_behind_it(vehicle: Vehicle) -> None:
    wall = terrain_of(lambda n, _e: np.where((n > 5) & (n < 5.5), 3.0, 0.0), size_m=40)
    cloud = StereoCamera(wall, vehicle, clean()).image(settled(wall, vehicle), RNG(0))
    assert cloud[:, 0].max() < 5.6


def test_range_limits_drop_points(flat: Terrain, vehicle: Vehicle) -> None:
    config = clean(range_min_m=4.0, range_max_m=8.0)
    cloud = StereoCamera(flat, vehicle, config).image(settled(flat, vehicle), RNG(0))
    ranges = np.linalg.norm(cloud - [0.93, 0.34, -1.97], axis=1)
    assert ranges.min() > 3.9
    assert ranges.max() < 8.1


@pytest.mark.parametrize(
    ("range_m", "sigma_m"), [(3, 0.009), (5, 0.025), (8, 0.063), (10, 0.099), (20, 0.40)]
)
def test_noise_matches_the_published_formula(range_m: float, sigma_m: float) -> None:
    """First-order numbers of 0.32 px, 1280 px, 96 degrees, 0.424 m, on the axis."""
    pixel_sigma = 0.32 / 1280 * math.radians(96)
    sigma = range_sigma_m(
        np.array([range_m], float), np.array([[1.0, 0, 0]]), np.array([0, 0.424, 0]), pixel_sigma
    )
    assert sigma[0] == pytest.approx(sigma_m, rel=0.06)


def test_noise_equals_d_over_sin_theta() -> None:
    rng = RNG(3)
    baseline = np.array([0.01, 0.42, -0.02])
    directions = rng.normal(size=(500, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    ranges = rng.uniform(1, 30, 500)
    to_right = baseline - ranges[:, None] * directions
    distance = np.linalg.norm(to_right, axis=1)
    cosine = (-ranges[:, None] * directions * to_right).sum(axis=1) / (ranges * distance)
    expected = distance / np.sqrt(1 - cosine**2)
    np.testing.assert_allclose(
        range_sigma_m(ranges, directions, baseline, 1.0), expected, rtol=1e-6
    )


def test_noise_slides_points_along_the_left_ray(flat: Terrain, vehicle: Vehicle) -> None:
    state = settled(flat, vehicle)
    still = StereoCamera(flat, vehicle, clean()).image(state, RNG(0)).astype(float)
    moved = StereoCamera(flat, vehicle, clean(disparity_sigma_px=0.32)).image(state, RNG(5))
    pair = load_stereo_pair("navcam")
    mount = rotation(0, math.radians(-30), 0)
    left = np.array(vehicle.geometry.mast_azimuth_m) + mount @ np.array(pair.left_center_m)
    baseline = mount @ np.subtract(pair.right_center_m, pair.left_center_m)
    old, new = still - left, moved.astype(float) - left
    ranges = np.linalg.norm(old, axis=1)
    directions = old / ranges[:, None]
    slide = (new * directions).sum(axis=1) - ranges
    np.testing.assert_allclose(new, (ranges + slide)[:, None] * directions, atol=1e-4)
    sigma = range_sigma_m(ranges, directions, baseline, 0.32 / 1280 * math.radians(96))
    assert np.std(slide / sigma) == pytest.approx(1.0, abs=0.05)
    assert np.mean(slide / sigma) == pytest.approx(0.0, abs=0.05)


def test_huge_noise_keeps_points_in_front(flat: Terrain, vehicle: Vehicle) -> None:
    config = clean(disparity_sigma_px=50.0)
    cloud = StereoCamera(flat, vehicle, config).image(settled(flat, vehicle), RNG(1))
    assert np.isfinite(cloud).all()
    assert (cloud[:, 0] > 0.5).all()


def test_images_repeat_with_the_generator(flat: Terrain, vehicle: Vehicle) -> None:
    camera = StereoCamera(flat, vehicle, CameraConfig())
    state = settled(flat, vehicle)
    one, two = camera.image(state, RNG(1)), camera.image(state, RNG(1))
    assert one.tobytes() == two.tobytes()
    assert camera.image(state, RNG(2)).tobytes() != one.tobytes()


def test_off_the_map_sees_nothing(flat: Terrain, vehicle: Vehicle) -> None:
    state = Settler(flat, vehicle).settle(1000, 0, 0)
    camera = StereoCamera(flat, vehicle, clean())
    assert camera.image(state, RNG(0)).shape == (0, 3)
    assert (camera.picture(state) == 255).all()


def test_a_picture_shades_slopes_and_leaves_the_sky_white(rocky: Terrain, vehicle: Vehicle) -> None:
    picture = StereoCamera(rocky, vehicle, clean(elevation_deg=-10.0)).picture(
        settled(rocky, vehicle)
    )
    assert picture.shape == (60, 80)
    assert (picture[0] == 255).any()
    assert picture[-1].std() > 1
