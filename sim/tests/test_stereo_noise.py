# SPDX-License-Identifier: Apache-2.0
"""Errors of stereo matching have the sizes that equation (1) gives them."""

import math

import numpy as np
import pytest

from sim.stereo_noise import correlated_field, dropouts, slid_points_m
from sim.tests.conftest import range_sigma_m

RNG = np.random.default_rng
PIXEL_RAD = 1.0 / 1280 * math.radians(96)


@pytest.mark.parametrize(
    ("range_m", "sigma_m"), [(3, 0.009), (5, 0.025), (8, 0.063), (10, 0.099), (20, 0.40)]
)
def test_noise_matches_the_published_formula(range_m: float, sigma_m: float) -> None:
    """First-order numbers of 0.32 px, 1280 px, 96 degrees, 0.424 m, on the axis."""
    ahead, baseline = np.array([[1.0, 0, 0]]), np.array([0, 0.424, 0])
    sigma = range_sigma_m(np.array([range_m], float), ahead, baseline, 0.32 * PIXEL_RAD)
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


def test_the_formula_is_the_derivative_of_triangulation() -> None:
    """Turn the right ray by a small angle in the epipolar plane and intersect it again."""
    rng = RNG(4)
    baseline = np.array([0.02, 0.42, 0.01])
    for _ in range(200):
        direction = np.array([1.0, *rng.uniform(-1, 1, 2)])
        direction /= np.linalg.norm(direction)
        range_m = rng.uniform(2, 20)
        normal = np.cross(baseline, direction)
        normal /= np.linalg.norm(normal)
        ray = range_m * direction - baseline
        turn_rad = 1e-6
        ray = math.cos(turn_rad) * ray + math.sin(turn_rad) * np.cross(normal, ray)
        met = np.linalg.lstsq(np.stack([direction, -ray], axis=1), baseline, rcond=None)[0]
        sigma = range_sigma_m(np.array([range_m]), direction[None], baseline, turn_rad)
        assert abs(met[0] - range_m) == pytest.approx(sigma[0], rel=1e-3)


def test_points_slide_along_their_rays_and_none_comes_out_behind_the_camera() -> None:
    ranges = np.array([math.nan, 5, 10, math.nan, 20], np.float32)
    directions = np.tile([0.6, 0.0, 0.8], (5, 1))
    center, baseline = np.array([1.0, 2, 3]), np.array([0, 0.5, 0])
    # the right camera is at right angles to the rays: sigma = pixel (r^2 + b^2) / b
    near, middle, far = slid_points_m(ranges, directions, center, baseline, 1e-3, None)
    np.testing.assert_allclose(near, center + 5 * directions[0], rtol=1e-6)
    np.testing.assert_allclose(middle, center + 10 * directions[0], rtol=1e-6)
    np.testing.assert_allclose(far, center + 20 * directions[0], rtol=1e-6)
    moved = slid_points_m(ranges, directions, center, baseline, 1e-3, np.array([2.0, -1, -25]))
    slid = np.array([5 + 2e-3 * 25.25 / 0.5, 10 - 1e-3 * 100.25 / 0.5])
    np.testing.assert_allclose(moved, center + slid[:, None] * directions[:2], rtol=1e-6)


def test_a_correlated_field_has_unit_variance_and_its_length() -> None:
    fields = np.array([correlated_field((120, 160), (6.0, 12.0), RNG(seed)) for seed in range(30)])
    assert fields.std() == pytest.approx(1.0, abs=0.03)
    assert fields.mean() == pytest.approx(0.0, abs=0.05)
    down = float(np.mean(fields[:, :-6] * fields[:, 6:]))
    across = float(np.mean(fields[:, :, :-12] * fields[:, :, 12:]))
    assert down == pytest.approx(math.exp(-1), abs=0.04)
    assert across == pytest.approx(math.exp(-1), abs=0.04)


@pytest.mark.parametrize("fraction", [0.0, 0.05, 0.5, 1.0])
def test_dropouts_cover_their_fraction(fraction: float) -> None:
    lost = [dropouts(fraction, (120, 160), (4.0, 4.0), RNG(seed)).mean() for seed in range(20)]
    assert np.mean(lost) == pytest.approx(fraction, abs=0.01)
