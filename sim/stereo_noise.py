# SPDX-License-Identifier: Apache-2.0
"""What stereo matching does to ranges: SIM equation (1), correlated errors, dropouts.

Kernel of the equation: `kernels/cloud.c`.
"""

import math
from statistics import NormalDist

import numpy as np
import numpy.typing as npt
from scipy.ndimage import gaussian_filter1d

from sim.clib import ffi, lib, pointer

Array = npt.NDArray[np.float64]

# kernels are cut at this many standard deviations
TRUNCATE = 4.0


def slid_points_m(
    ranges_m: npt.NDArray[np.float32],
    directions: Array,
    center_m: Array,
    baseline_m: Array,
    pixel_rad: float,
    error_px: Array | None,
) -> npt.NDArray[np.float32]:
    """Points [m, 3] that matching makes of ranges: slid along their left rays, equation (1).

    Those that would come out behind the camera are dropped.

    Args:
        ranges_m: True distances [n] from the left camera; NaN gives no point.
        directions: Unit vectors [n, 3] of the left rays.
        center_m: Left camera centre [3], same frame.
        baseline_m: Right minus left camera centre [3], same frame.
        pixel_rad: Angle of a pixel of the matched images: field of view / width_px.
        error_px: Of the matching, one for each range that is not NaN; None is no error.
    """
    points = np.empty((len(ranges_m), 3), dtype=np.float32)
    stereo = ffi.new(
        "sim_stereo_t *",
        {
            "center_m": center_m.tolist(),
            "baseline_m": baseline_m.tolist(),
            "pixel_rad": pixel_rad,
            "directions": pointer(directions, "const double *"),
            "count": len(ranges_m),
        },
    )
    count = lib.sim_cloud(
        stereo,
        pointer(ranges_m, "const float *"),
        ffi.NULL if error_px is None else pointer(error_px, "const double *"),
        pointer(points, "float *"),
    )
    return points[:count]


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
