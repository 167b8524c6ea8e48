# SPDX-License-Identifier: Apache-2.0
"""Ground undulation: smoothed uniform noise of a wanted horizontal scale and height span."""

from typing import Annotated, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator
from scipy.interpolate import RectBivariateSpline
from scipy.ndimage import gaussian_filter

from sim.config import ConfigModel

# smoothing is done on a grid this many times finer than the Gaussian, then interpolated
CELLS_PER_SIGMA = 4.0


class Undulation(ConfigModel):
    """One layer of hills and depressions.

    The width of the smoothing is given either as a scale or as the Gaussian itself.

    Attributes:
        horizontal_scale_m: Distance over which the correlation of heights falls to 1/e.
        height_span_m: Span of heights between minus and plus two standard deviations.
        gaussian_sigma_m: Standard deviation of the kernel; half the horizontal scale.
        gaussian_radius_m: Where the kernel is cut off; None is four sigma.
    """

    horizontal_scale_m: Annotated[float, Field(gt=0, le=1000)] | None = None
    height_span_m: Annotated[float, Field(ge=0, le=1000)]
    gaussian_sigma_m: Annotated[float, Field(gt=0, le=500)] | None = None
    gaussian_radius_m: Annotated[float, Field(gt=0, le=5000)] | None = None

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (self.horizontal_scale_m is None) == (self.gaussian_sigma_m is None):
            raise ValueError("give horizontal_scale_m or gaussian_sigma_m, one of them")
        return self

    @property
    def sigma_m(self) -> float:
        """White noise smoothed with sigma has a correlation of exp(-d^2 / 4 sigma^2)."""
        if self.gaussian_sigma_m is not None:
            return self.gaussian_sigma_m
        assert self.horizontal_scale_m is not None
        return 0.5 * self.horizontal_scale_m


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
    deviation so that +-2 sigma span `height_span_m`.
    """
    sigma_m, radius_m = layer.sigma_m, layer.gaussian_radius_m
    width_m = sigma_m if radius_m is None else min(sigma_m, radius_m)
    step_m = max(resolution_m, width_m / CELLS_PER_SIGMA)
    radius_cells = None if radius_m is None else max(1, round(radius_m / step_m))
    stretch = resolution_m / step_m
    if step_m > resolution_m:
        margin = 3
        coarse = [int(np.ceil((count - 1) * stretch)) + 1 + 2 * margin for count in shape]
        noise = _smooth_noise(coarse, sigma_m / step_m, radius_cells, rng)
        spline = RectBivariateSpline(np.arange(coarse[0]), np.arange(coarse[1]), noise)
        rows, cols = (margin + stretch * np.arange(count) for count in shape)
        heights: npt.NDArray[np.float64] = spline(rows, cols)
    else:
        heights = _smooth_noise(list(shape), sigma_m / step_m, radius_cells, rng)
    deviation = float(heights.std())
    if deviation == 0.0:
        return np.zeros(shape)
    heights -= heights.mean()
    heights *= layer.height_span_m / (4.0 * deviation)
    return heights


def _smooth_noise(
    shape: list[int], sigma_cells: float, radius_cells: int | None, rng: np.random.Generator
) -> npt.NDArray[np.float64]:
    noise = rng.uniform(-1.0, 1.0, shape)
    smooth: npt.NDArray[np.float64] = gaussian_filter(
        noise, sigma_cells, mode="wrap", radius=radius_cells
    )
    return smooth
