# SPDX-License-Identifier: Apache-2.0
"""Ground undulation: smoothed uniform noise of a wanted horizontal scale and height span."""

from typing import Annotated

import numpy as np
import numpy.typing as npt
from pydantic import Field
from scipy.interpolate import RectBivariateSpline
from scipy.ndimage import gaussian_filter

from sim.config import ConfigModel

# smoothing is done on a grid this many times finer than the Gaussian, then interpolated
CELLS_PER_SIGMA = 4.0


class Undulation(ConfigModel):
    """One layer of hills and depressions.

    Attributes:
        horizontal_scale_m: Distance over which the correlation of heights falls to 1/e.
        height_span_m: Span of heights between minus and plus two standard deviations.
    """

    horizontal_scale_m: Annotated[float, Field(gt=0, le=1000)]
    height_span_m: Annotated[float, Field(ge=0, le=1000)]


# Without a base the ground gets centimetres of roughness at wheel scale and gentle hills: 0.8 m of
# span at 10 m is an rms slope of 2.3 deg, so that the wanted slope stays the dominant one.
UNDULATION_DEFAULT = (
    Undulation(horizontal_scale_m=0.1, height_span_m=0.02),
    Undulation(horizontal_scale_m=10.0, height_span_m=0.8),
)


def undulation_up_m(
    shape: tuple[int, int], resolution_m: float, layer: Undulation, rng: np.random.Generator
) -> npt.NDArray[np.float64]:
    """Heights (up) of one layer on a grid [shape].

    As SIM section 3: uniform noise in [-1, 1], Gaussian smoothing, scaled by the measured standard
    deviation so that +-2 sigma span `height_span_m`. White noise smoothed with sigma has a
    correlation of exp(-d^2 / 4 sigma^2), hence sigma = scale / 2.
    """
    sigma_m = 0.5 * layer.horizontal_scale_m
    step_m = max(resolution_m, sigma_m / CELLS_PER_SIGMA)
    stretch = resolution_m / step_m
    if step_m > resolution_m:
        margin = 3
        coarse = [int(np.ceil((count - 1) * stretch)) + 1 + 2 * margin for count in shape]
        noise = _smooth_noise(coarse, sigma_m / step_m, rng)
        spline = RectBivariateSpline(np.arange(coarse[0]), np.arange(coarse[1]), noise)
        rows, cols = (margin + stretch * np.arange(count) for count in shape)
        heights: npt.NDArray[np.float64] = spline(rows, cols)
    else:
        heights = _smooth_noise(list(shape), sigma_m / step_m, rng)
    deviation = float(heights.std())
    if deviation == 0.0:
        return np.zeros(shape)
    heights -= heights.mean()
    heights *= layer.height_span_m / (4.0 * deviation)
    return heights


def _smooth_noise(
    shape: list[int], sigma_cells: float, rng: np.random.Generator
) -> npt.NDArray[np.float64]:
    noise = rng.uniform(-1.0, 1.0, shape)
    smooth: npt.NDArray[np.float64] = gaussian_filter(noise, sigma_cells, mode="wrap")
    return smooth
