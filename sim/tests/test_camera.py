# SPDX-License-Identifier: Apache-2.0
"""Stereo clouds: geometry, occlusion, noise."""

import math

import numpy as np
import pytest

from sim.camera import CameraConfig, StereoCamera, camera_pair
from sim.camera_model import Cahv, project
from sim.config import parse_model
from sim.errors import ConfigError
from sim.frames import rotation
from sim.settle import SettledState, Settler
from sim.terrain import Terrain
from sim.tests.conftest import range_sigma_m, terrain_of
from sim.vehicle import Vehicle

RNG = np.random.default_rng


def settled(terrain: Terrain, vehicle: Vehicle, yaw_rad: float = 0.0) -> SettledState:
    return Settler(terrain, vehicle).settle(0.0, 0.0, yaw_rad)


def clean(**settings: object) -> CameraConfig:
    return CameraConfig.model_validate(
        {"disparity_sigma_px": 0.0, "cloud_width_px": 80, "cloud_height_px": 60, **settings}
    )


def mast_views(vehicle: Vehicle, config: CameraConfig) -> tuple[Cahv, Cahv]:
    """Left and right camera in the rover frame, looking ahead."""
    mount = rotation(0, math.radians(config.elevation_deg), 0)
    left, right = camera_pair(config)
    mast_m = np.array(vehicle.geometry.mast_azimuth_m)
    return left.turned(mount, mast_m), right.turned(mount, mast_m)


@pytest.mark.parametrize("model", ["navcam", "pinhole"])
def test_the_pair_has_the_published_baseline(model: str) -> None:
    left, right = camera_pair(clean(model=model))
    assert math.dist(left.c, right.c) == pytest.approx(0.4244, abs=1e-4)


def test_a_pinhole_looks_straight_ahead_with_its_field_of_view() -> None:
    left, _ = camera_pair(clean(model="pinhole"))
    np.testing.assert_array_equal(left.a, [1, 0, 0])
    np.testing.assert_allclose(np.degrees(left.fov_rad), [96, 73])


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


def test_noise_slides_points_along_the_left_ray(flat: Terrain, vehicle: Vehicle) -> None:
    state = settled(flat, vehicle)
    still = StereoCamera(flat, vehicle, clean()).image(state, RNG(0)).astype(float)
    moved = StereoCamera(flat, vehicle, clean(disparity_sigma_px=0.32)).image(state, RNG(5))
    camera, right = mast_views(vehicle, clean())
    left, baseline = camera.c, right.c - camera.c
    old, new = still - left, moved.astype(float) - left
    ranges = np.linalg.norm(old, axis=1)
    directions = old / ranges[:, None]
    slide = (new * directions).sum(axis=1) - ranges
    np.testing.assert_allclose(new, (ranges + slide)[:, None] * directions, atol=1e-4)
    sigma = range_sigma_m(ranges, directions, baseline, 0.32 / 1280 * camera.fov_rad[0])
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


def test_points_project_onto_the_middles_of_their_pixels(flat: Terrain, vehicle: Vehicle) -> None:
    config = clean(self_occlusion=False)
    cloud = StereoCamera(flat, vehicle, config).image(settled(flat, vehicle), RNG(0))
    left, _ = mast_views(vehicle, config)
    seen = project(left, cloud.astype(float)) + 0.5
    seen *= [config.cloud_width_px / left.width_px, config.cloud_height_px / left.height_px]
    # five thousand pixels shrink to eighty: a thousandth of a small one
    np.testing.assert_allclose(seen % 1.0, 0.5, atol=1e-3)


@pytest.mark.parametrize("azimuth_deg", [-150.0, -90.0, 0.0, 45.0, 180.0])
def test_the_mast_points_by_azimuth(flat: Terrain, vehicle: Vehicle, azimuth_deg: float) -> None:
    config = clean(self_occlusion=False, range_max_m=8.0, model="pinhole")
    camera = StereoCamera(flat, vehicle, config)
    cloud = camera.image(settled(flat, vehicle), RNG(0), [azimuth_deg])
    from_mast = cloud[:, :2].astype(float) - vehicle.geometry.mast_azimuth_m[:2]
    turned = from_mast @ rotation(0, 0, math.radians(azimuth_deg))[:2, :2]
    ahead = camera.image(settled(flat, vehicle), RNG(0), [0.0])[:, :2].astype(float)
    np.testing.assert_allclose(turned, ahead - vehicle.geometry.mast_azimuth_m[:2], atol=1e-4)


@pytest.mark.parametrize("elevation_deg", [-60.0, -45.0, -30.0])
def test_the_mast_points_by_elevation(
    flat: Terrain, vehicle: Vehicle, elevation_deg: float
) -> None:
    config = clean(elevation_deg=elevation_deg, model="pinhole", self_occlusion=False)
    nearest = StereoCamera(flat, vehicle, config).image(settled(flat, vehicle), RNG(0))[:, 0].min()
    left, _ = mast_views(vehicle, config)
    steepest = math.radians(-elevation_deg + 36.5)
    if steepest < math.pi / 2:
        # the middle of the lowest row is half a pixel inside the field of view
        assert nearest == pytest.approx(left.c[0] - left.c[2] / math.tan(steepest), abs=0.05)
    else:
        assert nearest < left.c[0]


def test_pairs_of_all_directions_add_up(flat: Terrain, vehicle: Vehicle) -> None:
    camera = StereoCamera(flat, vehicle, clean())
    state = settled(flat, vehicle)
    parts = [camera.image(state, RNG(0), [azimuth]) for azimuth in range(-180, 180, 20)]
    around = camera.image(state, RNG(0), range(-180, 180, 20))
    np.testing.assert_array_equal(around, np.concatenate(parts))
    assert camera.image(state, RNG(0), []).shape == (0, 3)


def test_the_rover_hides_what_is_behind_its_deck(flat: Terrain, vehicle: Vehicle) -> None:
    state = settled(flat, vehicle)
    hidden = StereoCamera(flat, vehicle, clean()).image(state, RNG(0), [180.0]).astype(float)
    every = StereoCamera(flat, vehicle, clean(self_occlusion=False)).image(state, RNG(0), [180.0])
    assert len(hidden) < 0.8 * len(every)
    left = StereoCamera(flat, vehicle, clean())._view(180.0).center_m
    deck = vehicle.deck
    assert deck is not None
    # along every line of sight that is left, no place is inside the box
    for part in np.linspace(0.0, 1.0, 300):
        place = left + part * (hidden - left)
        inside = (
            (place[:, 0] > deck.rear_m + 1e-6)
            & (place[:, 0] < deck.front_m - 1e-6)
            & (np.abs(place[:, 1]) < deck.half_width_m - 1e-6)
            & (-place[:, 2] < deck.height_m - 1e-6)
            & (-place[:, 2] > vehicle.belly.height_m + 1e-6)
        )
        assert not inside.any()
    bare = vehicle.model_copy(update={"deck": None})
    assert len(StereoCamera(flat, bare, clean()).image(state, RNG(0), [180.0])) == len(every)


def test_nothing_of_the_rover_hides_the_way_ahead(flat: Terrain, vehicle: Vehicle) -> None:
    state = settled(flat, vehicle)
    ahead = StereoCamera(flat, vehicle, clean()).image(state, RNG(0))
    bare = StereoCamera(flat, vehicle, clean(self_occlusion=False)).image(state, RNG(0))
    assert len(ahead) == len(bare)


def test_the_rover_is_black_in_its_pictures(flat: Terrain, vehicle: Vehicle) -> None:
    camera = StereoCamera(flat, vehicle, clean())
    assert (camera.picture(settled(flat, vehicle), azimuth_deg=180.0) == 0).mean() > 0.2
    assert (camera.picture(settled(flat, vehicle)) > 0).all()


def test_the_sun_lights_slopes_that_face_it(vehicle: Vehicle) -> None:
    ramp = terrain_of(lambda n, _e: 0.2 * n, size_m=40)
    camera = StereoCamera(ramp, vehicle, clean(sun_azimuth_deg=180.0, sun_elevation_deg=30.0))
    state = settled(ramp, vehicle)
    # rising to the north, the ground faces a sun in the south
    normal = np.array([-0.2, 0.0, 1.0]) / math.hypot(1, 0.2)
    for azimuth_deg in (0.0, 90.0, 180.0):
        azimuth, elevation = math.radians(azimuth_deg), math.radians(30)
        sun = [math.cos(azimuth) * math.cos(elevation), 0.0, math.sin(elevation)]
        expected = 20 + 220 * max(0.0, float(normal @ sun))
        grey = camera.picture(state, None, azimuth_deg)[-1, 40]
        assert grey == pytest.approx(expected, abs=1.5)
    assert (camera.picture(state)[-1] > 150).all()


def test_correlated_error_is_shared_by_neighbours(flat: Terrain, vehicle: Vehicle) -> None:
    state = settled(flat, vehicle)
    still = StereoCamera(flat, vehicle, clean()).image(state, RNG(0)).astype(float)
    left, right = mast_views(vehicle, clean())
    ranges = np.linalg.norm(still - left.c, axis=1)
    directions = (still - left.c) / ranges[:, None]
    sigma = range_sigma_m(
        ranges, directions, right.c - left.c, 0.5 / 1280 * camera_pair(clean())[0].fov_rad[0]
    )
    config = clean(disparity_correlated_sigma_px=0.5, correlation_length_px=64.0)
    camera = StereoCamera(flat, vehicle, config)
    errors = []
    for seed in range(40):
        moved = camera.image(state, RNG(seed)).astype(float)
        errors.append(((moved - still) * directions).sum(axis=1) / sigma)
    found = np.array(errors)
    assert found.std() == pytest.approx(1.0, abs=0.06)
    # a pixel of the cloud is 16 of the matched images; few neighbours in the list change row
    neighbours = float(np.mean(found[:, :-1] * found[:, 1:]))
    assert neighbours == pytest.approx(math.exp(-((16 / 64) ** 2)), abs=0.06)


def test_dropouts_take_their_share_of_the_image(flat: Terrain, vehicle: Vehicle) -> None:
    state = settled(flat, vehicle)
    every = len(StereoCamera(flat, vehicle, clean()).image(state, RNG(0)))
    camera = StereoCamera(flat, vehicle, clean(dropout_fraction=0.2))
    kept = [len(camera.image(state, RNG(seed))) / every for seed in range(60)]
    assert np.mean(kept) == pytest.approx(0.8, abs=0.02)
    nothing = StereoCamera(flat, vehicle, clean(dropout_fraction=1.0))
    assert len(nothing.image(state, RNG(0))) == 0


def test_what_is_off_draws_nothing(flat: Terrain, vehicle: Vehicle) -> None:
    rng = RNG(3)
    StereoCamera(flat, vehicle, clean()).image(settled(flat, vehicle), rng)
    assert rng.random() == RNG(3).random()


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("model: fisheye", "expected one of navcam, pinhole"),
        ("pinhole: {fov_horizontal_deg: 180}", "expected < 170"),
        ("pinhole: {left_center_m: [0, 0, 0], right_center_m: [0, 0, 0]}", "1 mm apart"),
        ("range_min_m: 30", "range_min_m must be less"),
        ("dropout_fraction: 1.5", "expected <= 1"),
        ("azimuths_deg: []", "azimuths_deg"),
    ],
)
def test_bad_cameras_are_refused(text: str, fault: str) -> None:
    with pytest.raises(ConfigError, match=fault):
        parse_model(text, "camera.yaml", CameraConfig)


def test_the_noise_of_a_million_points_has_the_sigma_of_the_equation(
    flat: Terrain, vehicle: Vehicle
) -> None:
    """SIM equation (1) written out: d / sin(theta) from the triangle camera, camera, point."""
    state = settled(flat, vehicle)
    still = StereoCamera(flat, vehicle, clean(cloud_width_px=320, cloud_height_px=240))
    noisy = StereoCamera(flat, vehicle, CameraConfig())
    left, right = mast_views(vehicle, CameraConfig())
    points = still.image(state, RNG(0)).astype(float)
    to_left, to_right = left.c - points, right.c - points
    ranges, d = np.linalg.norm(to_left, axis=1), np.linalg.norm(to_right, axis=1)
    theta = np.arccos((to_left * to_right).sum(axis=1) / (ranges * d))
    sigma = 0.32 / 1280 * left.fov_rad[0] * d / np.sin(theta)
    count, total, square = 0, 0.0, 0.0
    by_range = np.zeros((2, 30))
    for seed in range(1 + 1_000_000 // len(points)):
        moved = noisy.image(state, RNG(seed)).astype(float)
        eta = ((points - moved) * to_left).sum(axis=1) / ranges / sigma
        count, total, square = count + len(eta), total + eta.sum(), square + (eta**2).sum()
        bins = ranges.astype(int)
        by_range += [np.bincount(bins, minlength=30), np.bincount(bins, eta**2, minlength=30)]
    assert count >= 1_000_000
    assert math.sqrt(square / count) == pytest.approx(1.0, rel=0.01)
    assert total / count == pytest.approx(0.0, abs=0.004)
    full = by_range[0] > 20_000
    assert full.sum() > 5
    np.testing.assert_allclose(np.sqrt(by_range[1, full] / by_range[0, full]), 1.0, atol=0.025)
