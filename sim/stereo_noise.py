# SPDX-License-Identifier: Apache-2.0
"""What stereo matching does to ranges: SIM equation (1), correlated errors, dropouts."""

import math
from statistics import NormalDist

import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter1d

Array = npt.NDArray[np.float64]

# kernels are cut at this many standard deviations
TRUNCATE = 4.0


def range_sigma_m(
    ranges_m: Array,
    directions: Array,
    baseline_m: Array,
    pixel_sigma_rad: float,
) -> Array:
    """Standard deviation [n] of the range along the left ray, SIM equation (1).

    sigma = pixel_sigma * d / sin(theta), with d the distance to the right camera and theta the
    angle between the cameras seen from the point. By the sine rule d / sin(theta) equals
    d^2 / |baseline x ray|, which stays exact for far points.

    Args:
        ranges_m: Distances [n] from the left camera.
        directions: Unit vectors [n, 3] of the left rays.
        baseline_m: Right minus left camera centre [3], same frame.
        pixel_sigma_rad: Correlation error as an angle: sigma_px / width_px * field of view.
    """
    along = directions @ baseline_m
    baseline2 = float(baseline_m @ baseline_m)
    distance2 = ranges_m**2 - 2.0 * ranges_m * along + baseline2
    height = np.sqrt(np.maximum(baseline2 - along**2, 1e-12))
    sigma: Array = pixel_sigma_rad * distance2 / height
    return sigma


def correlated_field(
    shape: tuple[int, int], length_px: tuple[float, float], rng: np.random.Generator
) -> Array:
    """Normal deviates [rows, columns] whose correlation falls to 1/e at length_px.

    White noise smoothed by a Gaussian of half that length, scaled back to unit variance.
    """
    field: Array = rng.standard_normal(shape)
    for axis, length in enumerate(length_px):
        sigma_px = 0.5 * length
        reach = int(TRUNCATE * sigma_px + 0.5)
        impulse = np.zeros(2 * reach + 1)
        impulse[reach] = 1.0
        kernel = gaussian_filter1d(impulse, sigma_px, mode="constant", truncate=TRUNCATE)
        field = gaussian_filter1d(field, sigma_px, axis=axis, mode="wrap", truncate=TRUNCATE)
        field /= math.sqrt(float(kernel @ kernel))
    return field


def dropouts(
    fraction: float,
    shape: tuple[int, int],
    length_px: tuple[float, float],
    rng: np.random.Generator,
) -> npt.NDArray[np.bool_]:
    """Pixels [rows, columns] that find no match: patches that cover a fraction of the image."""
    if not 0.0 < fraction < 1.0:
        return np.full(shape, fraction >= 1.0)
    lost: npt.NDArray[np.bool_] = correlated_field(shape, length_px, rng) > NormalDist().inv_cdf(
        1.0 - fraction
    )
    return lost
