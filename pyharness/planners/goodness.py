# SPDX-License-Identifier: Apache-2.0
"""Goodness of ground for a rover-sized disc: tilt, roughness and step, as in GESTALT.

Heights are summed up in cells as moments, so that the plane of a disc is fitted to all heights in
it at once. Each hazard has a goodness from 1 (none) down to 0 (at its limit); the goodness of a
cell is the least of the three, that of a rover whose centre stands there.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.ndimage import maximum_filter, minimum_filter
from scipy.signal import fftconvolve

from pyharness.status import Reason

Floats = npt.NDArray[np.float64]

SINGULAR_SHARE = 1e-9


@dataclass(frozen=True, slots=True)
class Heights:
    """Heights [row from south, column from west], z down; NaN where unknown."""

    z_m: Floats
    first_row: int
    first_col: int
    cell_m: float


@dataclass(frozen=True, slots=True)
class Limits:
    """Where goodness ends, and how it is measured."""

    cell_heights: int
    disc_radius_m: float
    disc_known_min: float
    step_window_m: float
    tilt_max_rad: float
    roughness_max_m: float
    step_max_m: float


@dataclass(frozen=True, slots=True)
class GoodnessMap:
    """Goodness [row, column] from 0 to 1, NaN where unknown; `reason` of the worst hazard."""

    goodness: Floats
    reason: npt.NDArray[np.uint8]
    first_row: int
    first_col: int
    cell_m: float

    def at(self, points_m: Floats) -> tuple[Floats, npt.NDArray[np.uint8]]:
        """Return goodness and reason at points [..., north and east]; unknown outside."""
        index = np.floor(points_m / self.cell_m).astype(np.int64)
        rows, cols = index[..., 0] - self.first_row, index[..., 1] - self.first_col
        count_rows, count_cols = self.goodness.shape
        inside = (rows >= 0) & (rows < count_rows) & (cols >= 0) & (cols < count_cols)
        rows, cols = np.where(inside, rows, 0), np.where(inside, cols, 0)
        return (
            np.where(inside, self.goodness[rows, cols], np.nan),
            np.where(inside, self.reason[rows, cols], np.uint8(Reason.UNKNOWN)),
        )


def goodness_map(heights: Heights, limits: Limits) -> GoodnessMap:
    """Judge every cell of heights whose grid lines are those of the cells."""
    side = limits.cell_heights
    cell_m = side * heights.cell_m
    disc = _disc(limits.disc_radius_m / cell_m)
    known_min = limits.disc_known_min * disc.sum() * side**2
    tilt_slope, roughness_m, count = _planes(heights, side, disc)
    window_m = _window_cells(limits, cell_m) * cell_m
    step_m = _steps(heights, limits, cell_m, disc) - tilt_slope * window_m
    shares = np.stack(
        [
            np.arctan(tilt_slope) / limits.tilt_max_rad,
            roughness_m / limits.roughness_max_m,
            step_m / limits.step_max_m,
        ]
    )
    known = (count >= known_min) & np.isfinite(shares).all(axis=0)
    worst = np.where(known, shares.argmax(axis=0), 0)
    reasons = np.array([Reason.TILT, Reason.CLEARANCE, Reason.WHEEL_DROP], dtype=np.uint8)
    return GoodnessMap(
        goodness=np.where(known, np.clip(1.0 - shares.max(axis=0), 0.0, 1.0), np.nan),
        reason=np.where(known, reasons[worst], np.uint8(Reason.UNKNOWN)),
        first_row=heights.first_row // side,
        first_col=heights.first_col // side,
        cell_m=cell_m,
    )


def _disc(radius_cells: float) -> npt.NDArray[np.bool_]:
    reach = math.floor(radius_cells)
    offsets = np.arange(-reach, reach + 1)
    return np.asarray(np.hypot(offsets[:, None], offsets) <= radius_cells)


def _window_cells(limits: Limits, cell_m: float) -> int:
    return max(2, round(limits.step_window_m / cell_m))


def _planes(
    heights: Heights, side: int, disc: npt.NDArray[np.bool_]
) -> tuple[Floats, Floats, Floats]:
    """Fit a plane to the heights in the disc around every cell: slope, rms residual, count."""
    known = np.isfinite(heights.z_m)
    middle_m = np.median(heights.z_m[known]) if known.any() else 0.0
    z = np.where(known, heights.z_m - middle_m, 0.0)
    one = known.astype(np.float64)
    rows, cols = z.shape
    u = (np.arange(rows) - 0.5 * rows)[:, None] * heights.cell_m * one
    v = (np.arange(cols) - 0.5 * cols) * heights.cell_m * one
    products = np.stack([one, u, v, z, u * u, u * v, v * v, u * z, v * z, z * z])
    cells = products.reshape(len(products), rows // side, side, cols // side, side).sum(axis=(2, 4))
    sums = fftconvolve(cells, disc[None].astype(np.float64), mode="same", axes=(1, 2))
    count = np.rint(sums[0])
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = sums[1:4] / count
        uu, uv, vv, uz, vz, zz = sums[4:] / count - np.stack(
            [mean[i] * mean[j] for i, j in ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))]
        )
        determinant = uu * vv - uv * uv
        determinant = np.where(determinant > SINGULAR_SHARE * uu * vv, determinant, np.nan)
        slope_u = (vv * uz - uv * vz) / determinant
        slope_v = (uu * vz - uv * uz) / determinant
        residual = np.maximum(zz - slope_u * uz - slope_v * vz, 0.0)
    return np.hypot(slope_u, slope_v), np.sqrt(residual), count


def _steps(heights: Heights, limits: Limits, cell_m: float, disc: npt.NDArray[np.bool_]) -> Floats:
    """Return the largest height difference in any window whose middle lies in the disc."""
    side = limits.cell_heights
    rows, cols = heights.z_m.shape
    blocks = heights.z_m.reshape(rows // side, side, cols // side, side)
    high_m = np.where(np.isfinite(blocks), -blocks, -np.inf).max(axis=(1, 3))
    low_m = np.where(np.isfinite(blocks), -blocks, np.inf).min(axis=(1, 3))
    size = _window_cells(limits, cell_m)
    span_m = maximum_filter(high_m, size, mode="nearest") - minimum_filter(
        low_m, size, mode="nearest"
    )
    return np.asarray(maximum_filter(span_m, footprint=disc, mode="nearest"))
