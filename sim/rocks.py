# SPDX-License-Identifier: Apache-2.0
"""Rocks by the Golombek-Rapp size-frequency law, each with an outline and a profile of its own.

Law: rocks of at least diameter D cover F(D) = k exp(-q D) of the ground, q = 1.79 + 0.152 / k,
where k is the cumulative fractional area (CFA) of all rocks. The family is valid for k of 5 to
40 %; smaller ones are extrapolated.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.special import exp1

from sim.errors import TerrainError
from sim.terrain import ROCK_DTYPE

CFA_MAX = 0.4
ROCKS_MAX = 5_000_000
BINS_PER_DOUBLING = 12
OUTLINE_WAVES = (2, 3, 4, 5)
OUTLINE_AMPLITUDE_MAX = 0.16
STEEPNESS_MIN, STEEPNESS_MAX = 3.0, 6.0
HEIGHT_TO_DIAMETER = 0.5
# surface texture: standard deviation as a share of the height, at most a centimetre
TEXTURE_SHARE, TEXTURE_MAX_M = 0.04, 0.01
# nodes stamped at once, to bound memory
BATCH_NODES = 1_000_000


def decay_per_m(cfa: float) -> float:
    """Exponent q of the law for a CFA (Golombek et al. 2003)."""
    return 1.79 + 0.152 / cfa


def area_fraction(cfa: float, diameter_m: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Share of the ground covered by rocks of at least this diameter."""
    return cfa * np.exp(-decay_per_m(cfa) * np.asarray(diameter_m, dtype=np.float64))


def number_per_m2(cfa: float, diameter_m: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Rocks larger than this diameter on a square metre.

    From dF = -(pi / 4) D^2 dN: N(>D) = (4 k q / pi) (exp(-q D) / D - q E1(q D)).
    """
    q, diameter = decay_per_m(cfa), np.asarray(diameter_m, dtype=np.float64)
    tail: npt.NDArray[np.float64] = np.exp(-q * diameter) / diameter - q * exp1(q * diameter)
    return 4.0 * cfa * q / math.pi * tail


def achieved_area_fraction(
    diameters_m: npt.NDArray[np.float64], area_m2: float, at_least_m: npt.ArrayLike
) -> npt.NDArray[np.float64]:
    """Share of an area that listed rocks of at least these diameters cover."""
    ordered = np.sort(diameters_m)[::-1]
    covered_m2 = np.concatenate([[0.0], np.cumsum(0.25 * math.pi * ordered**2)])
    count = np.searchsorted(-ordered, -np.asarray(at_least_m, dtype=np.float64), side="right")
    result: npt.NDArray[np.float64] = covered_m2[count] / area_m2
    return result


@dataclass(frozen=True, slots=True, eq=False)
class RockField:
    """Drawn rocks, all arrays of the same length n.

    Attributes:
        rocks: ROCK_DTYPE [n].
        amplitude: Relative outline waves [n, len(OUTLINE_WAVES)].
        phase_rad: Their phases, same shape.
        steepness: Exponent of the profile [n]; larger is steeper at the rim.
    """

    rocks: npt.NDArray[np.void]
    amplitude: npt.NDArray[np.float64]
    phase_rad: npt.NDArray[np.float64]
    steepness: npt.NDArray[np.float64]

    @property
    def radius_m(self) -> npt.NDArray[np.float64]:
        """Radius about which the outline waves, so that its area is that of the diameter."""
        mean_square = 1.0 + 0.5 * np.sum(self.amplitude**2, axis=1)
        radius: npt.NDArray[np.float64] = 0.5 * self.rocks["diameter_m"] / np.sqrt(mean_square)
        return radius

    @property
    def reach_m(self) -> npt.NDArray[np.float64]:
        """Radius [n] of a circle that holds the whole outline."""
        reach: npt.NDArray[np.float64] = self.radius_m * (1.0 + np.sum(self.amplitude, axis=1))
        return reach

    def subset(self, keep: npt.NDArray[np.bool_]) -> "RockField":
        """The rocks where `keep` is True."""
        return RockField(
            self.rocks[keep], self.amplitude[keep], self.phase_rad[keep], self.steepness[keep]
        )


def draw_rocks(
    cfa: float,
    diameter_min_m: float,
    diameter_max_m: float,
    size_m: tuple[float, float],
    rng: np.random.Generator,
) -> RockField:
    """Rocks on a rectangle [north, east] centred on the origin.

    Poisson counts in narrow bins of log diameter whose means give each bin its area of the law;
    positions uniform.
    """
    doublings = math.log2(diameter_max_m / diameter_min_m)
    bin_count = max(1, math.ceil(BINS_PER_DOUBLING * doublings))
    edges = np.geomspace(diameter_min_m, diameter_max_m, bin_count + 1)
    area_m2 = -np.diff(area_fraction(cfa, edges)) * size_m[0] * size_m[1]
    # mean of D^2 over a bin that is uniform in log D
    mean_square = 0.5 * np.diff(edges**2) / np.diff(np.log(edges))
    expected = area_m2 / (0.25 * math.pi * mean_square)
    if not expected.sum() <= ROCKS_MAX:
        raise TerrainError(
            f"rocks: about {expected.sum():.2g} of them at a CFA of {cfa:g} and diameters from"
            f" {diameter_min_m:g} m, expected at most {ROCKS_MAX} (a larger rock_diameter_min_m,"
            " or a smaller size_m)"
        )
    counts = rng.poisson(expected)
    count = int(counts.sum())
    low, high = np.repeat(edges[:-1], counts), np.repeat(edges[1:], counts)
    rocks = np.zeros(count, dtype=ROCK_DTYPE)
    rocks["diameter_m"] = low * (high / low) ** rng.random(count)
    rocks["height_m"] = HEIGHT_TO_DIAMETER * rocks["diameter_m"]
    rocks["north_m"] = (rng.random(count) - 0.5) * size_m[0]
    rocks["east_m"] = (rng.random(count) - 0.5) * size_m[1]
    waves = len(OUTLINE_WAVES)
    return RockField(
        rocks=rocks,
        amplitude=rng.uniform(0.0, OUTLINE_AMPLITUDE_MAX, (count, waves)) / np.sqrt(OUTLINE_WAVES),
        phase_rad=rng.uniform(0.0, 2.0 * math.pi, (count, waves)),
        steepness=rng.uniform(STEEPNESS_MIN, STEEPNESS_MAX, count),
    )


def thinned(
    field: RockField, cfa_drawn: float, cfa: npt.NDArray[np.float64], rng: np.random.Generator
) -> RockField:
    """Rocks as a varying CFA has them, from rocks drawn at the largest CFA.

    The density of rocks of a diameter is proportional to k q exp(-q D), which grows with k at every
    diameter: each rock stays with the ratio of the two densities.

    Args:
        field: Rocks drawn at `cfa_drawn`.
        cfa_drawn: At least every value of `cfa`.
        cfa: CFA [n] at each rock.
        rng: Draws one number per rock.
    """
    diameter_m = field.rocks["diameter_m"]
    chance = rng.random(len(diameter_m))
    # k q = 1.79 k + 0.152; without rocks there is no q
    k = np.maximum(cfa, 1e-9)
    q_change = 0.152 / k - 0.152 / cfa_drawn
    share = (1.79 * k + 0.152) / (1.79 * cfa_drawn + 0.152) * np.exp(-q_change * diameter_m)
    return field.subset(chance < np.where(cfa > 0, share, 0.0))


def outside_strip(
    field: RockField,
    start_m: tuple[float, float],
    yaw_rad: float,
    strip: tuple[float, float, float],
    height_max_m: float,
) -> npt.NDArray[np.bool_]:
    """Which rocks may stay when a strip (behind, ahead, half width) before a start is cleared.

    A rock goes when it is higher than `height_max_m` and its outline can touch the strip.
    """
    behind_m, ahead_m, half_width_m = strip
    north = field.rocks["north_m"] - start_m[0]
    east = field.rocks["east_m"] - start_m[1]
    forward = north * math.cos(yaw_rad) + east * math.sin(yaw_rad)
    right = east * math.cos(yaw_rad) - north * math.sin(yaw_rad)
    outside_x = np.maximum(np.maximum(-behind_m - forward, forward - ahead_m), 0.0)
    outside_y = np.maximum(np.abs(right) - half_width_m, 0.0)
    touches = np.hypot(outside_x, outside_y) <= field.reach_m
    stays: npt.NDArray[np.bool_] = ~(touches & (field.rocks["height_m"] > height_max_m))
    return stays


def stamp_rocks(
    z_site_m: npt.NDArray[np.float64],
    resolution_m: float,
    origin_m: tuple[float, float],
    field: RockField,
    texture: npt.NDArray[np.float64],
) -> npt.NDArray[np.float64]:
    """Ground heights (z down) with the rocks on it.

    Each rock stands on the ground height under its centre and the higher of rock and ground wins,
    so neither slope nor undulation bends a rock (SIM section 3).

    Args:
        z_site_m: Ground [n, m], z down; not changed.
        resolution_m: Distance between nodes.
        origin_m: North and east of node [0, 0].
        field: The rocks.
        texture: Noise of unit standard deviation, shape of the ground.
    """
    rows, cols = z_site_m.shape
    result = z_site_m.copy()
    flat = result.reshape(-1)
    row = (field.rocks["north_m"] - origin_m[0]) / resolution_m
    col = (field.rocks["east_m"] - origin_m[1]) / resolution_m
    row_near = np.clip(np.rint(row).astype(np.int64), 0, rows - 1)
    col_near = np.clip(np.rint(col).astype(np.int64), 0, cols - 1)
    base_z_m = _bilinear(z_site_m, row, col)
    deviation_m = np.minimum(TEXTURE_SHARE * field.rocks["height_m"], TEXTURE_MAX_M)
    half_window = np.ceil(field.reach_m / resolution_m).astype(np.int64)
    for half, chosen in _batches(half_window):
        offset = np.arange(-half, half + 1)
        r = row_near[chosen, None, None] + offset[None, :, None]
        c = col_near[chosen, None, None] + offset[None, None, :]
        north_m = (r - row[chosen, None, None]) * resolution_m
        east_m = (c - col[chosen, None, None]) * resolution_m
        profile = _profile(field, chosen, north_m, east_m)
        covered = (profile > 0) & (r >= 0) & (r < rows) & (c >= 0) & (c < cols)
        which = np.nonzero(covered)
        node = (r * cols + c)[which]
        rock = chosen[which[0]]
        height_m = field.rocks["height_m"][rock] * profile[which]
        height_m += deviation_m[rock] * texture.reshape(-1)[node]
        np.minimum.at(flat, node, base_z_m[rock] - height_m)
    return result


def _batches(
    half_window: npt.NDArray[np.int64],
) -> Iterator[tuple[int, npt.NDArray[np.int64]]]:
    """Indices of rocks of equal window size, few enough at a time."""
    for half in np.unique(half_window):
        members = np.nonzero(half_window == half)[0]
        size = max(1, BATCH_NODES // int(2 * half + 1) ** 2)
        for first in range(0, len(members), size):
            yield int(half), members[first : first + size]


def _profile(
    field: RockField,
    chosen: npt.NDArray[np.int64],
    north_m: npt.NDArray[np.float64],
    east_m: npt.NDArray[np.float64],
) -> npt.NDArray[np.float64]:
    """Relative height [n, w, w]: 1 at the peak, 0 at the outline, negative outside.

    Along every direction the peak joins the outline by 1 - exp(-c (1 - r / outline)), normalised.
    """
    distance_m = np.hypot(north_m, east_m)
    bearing = np.arctan2(east_m, north_m)
    outline = np.ones_like(bearing)
    for wave, order in enumerate(OUTLINE_WAVES):
        phase = field.phase_rad[chosen, wave, None, None]
        outline += field.amplitude[chosen, wave, None, None] * np.sin(order * bearing + phase)
    outline *= field.radius_m[chosen, None, None]
    steepness = field.steepness[chosen, None, None]
    inward = 1.0 - distance_m / outline
    height = -np.expm1(-steepness * np.maximum(inward, -0.1)) / -np.expm1(-steepness)
    result: npt.NDArray[np.float64] = height
    return result


def _bilinear(
    grid: npt.NDArray[np.float64], row: npt.NDArray[np.float64], col: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    rows, cols = grid.shape
    row = np.clip(row, 0, rows - 1)
    col = np.clip(col, 0, cols - 1)
    i = np.minimum(row.astype(np.int64), rows - 2)
    j = np.minimum(col.astype(np.int64), cols - 2)
    u, v = row - i, col - j
    south = grid[i, j] * (1 - v) + grid[i, j + 1] * v
    north = grid[i + 1, j] * (1 - v) + grid[i + 1, j + 1] * v
    result: npt.NDArray[np.float64] = south * (1 - u) + north * u
    return result
