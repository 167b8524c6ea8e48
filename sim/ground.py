# SPDX-License-Identifier: Apache-2.0
"""The slope of the ground around every place: what wheel drop is measured against."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sim.terrain import Terrain

CELL_M = 0.5
PATCH_CELLS = 5
NODES_MIN = 3

Grid = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class GroundSlope:
    """Least-squares planes over rover-sized squares of 2.5 m, one per cell of 0.5 m.

    Attributes:
        gradient: float32 [rows, cols, 2]: z (down) per metre north and east; NaN without ground.
        north_min_m: South edge of row 0, a multiple of the cell.
        east_min_m: West edge of column 0, a multiple of the cell.
    """

    gradient: npt.NDArray[np.float32]
    north_min_m: float
    east_min_m: float


def ground_slope(terrain: Terrain) -> GroundSlope:
    """Fit the planes; nodes without ground (NaN) are left out."""
    rows = np.floor(terrain.north_m / CELL_M + 1e-9).astype(np.int64)
    cols = np.floor(terrain.east_m / CELL_M + 1e-9).astype(np.int64)
    # places within the patch are taken from the middle of their own cell, for exact sums
    u = terrain.north_m - (rows + 0.5) * CELL_M
    v = terrain.east_m - (cols + 0.5) * CELL_M
    known = np.isfinite(terrain.z_site_m)
    z = np.where(known, terrain.z_site_m, 0.0).astype(np.float64)
    w = known.astype(np.float64)
    sums = [
        _cell_sums(values, rows, cols)
        for values in (
            w, w * u[:, None], w * v, z, z * u[:, None], z * v,
            w * (u * u)[:, None], w * (u[:, None] * v), w * (v * v),
        )
    ]  # fmt: skip
    gradient = _plane_gradient(*_patch_moments(*sums))
    return GroundSlope(
        gradient=np.ascontiguousarray(gradient, dtype=np.float32),
        north_min_m=float(rows[0]) * CELL_M,
        east_min_m=float(cols[0]) * CELL_M,
    )


def _cell_sums(values: Grid, rows: npt.NDArray[np.int64], cols: npt.NDArray[np.int64]) -> Grid:
    """Sum the nodes of each cell; cells without nodes (coarse terrain) are zero."""
    by_row = np.zeros((int(rows[-1] - rows[0]) + 1, values.shape[1]))
    first = np.flatnonzero(np.diff(rows, prepend=rows[0] - 1))
    by_row[rows[first] - rows[0]] = np.add.reduceat(values, first, axis=0)
    out = np.zeros((by_row.shape[0], int(cols[-1] - cols[0]) + 1))
    first = np.flatnonzero(np.diff(cols, prepend=cols[0] - 1))
    out[:, cols[first] - cols[0]] = np.add.reduceat(by_row, first, axis=1)
    return out


def _patch_moments(
    w: Grid, u: Grid, v: Grid, z: Grid, uz: Grid, vz: Grid, uu: Grid, uv: Grid, vv: Grid
) -> tuple[Grid, ...]:
    """Moments of the square of cells around each cell, about its middle."""
    total = [np.zeros_like(w) for _ in range(9)]
    reach = PATCH_CELLS // 2
    for i in range(-reach, reach + 1):
        for j in range(-reach, reach + 1):
            a, b = i * CELL_M, j * CELL_M
            moved = (
                w, u + a * w, v + b * w, z, uz + a * z, vz + b * z,
                uu + 2 * a * u + a * a * w, uv + a * v + b * u + a * b * w,
                vv + 2 * b * v + b * b * w,
            )  # fmt: skip
            for sum_of, part in zip(total, moved, strict=True):
                _add_shifted(sum_of, part, i, j)
    return tuple(total)


def _add_shifted(total: Grid, part: Grid, i: int, j: int) -> None:
    """Add to each cell what lies i rows and j columns further."""
    rows, cols = total.shape
    to = (slice(max(0, -i), rows - max(0, i)), slice(max(0, -j), cols - max(0, j)))
    of = (slice(max(0, i), rows - max(0, -i)), slice(max(0, j), cols - max(0, -j)))
    total[to] += part[of]


def _plane_gradient(
    w: Grid, u: Grid, v: Grid, z: Grid, uz: Grid, vz: Grid, uu: Grid, uv: Grid, vv: Grid
) -> Grid:
    """Slopes of z = z0 + gu u + gv v; NaN where too few nodes support them."""
    enough = w >= NODES_MIN
    n = np.where(enough, w, 1.0)
    cuu, cuv, cvv = uu - u * u / n, uv - u * v / n, vv - v * v / n
    cuz, cvz = uz - u * z / n, vz - v * z / n
    determinant = cuu * cvv - cuv * cuv
    enough &= determinant > 1e-6 * (cuu + cvv) ** 2
    safe = np.where(enough, determinant, 1.0)
    north = (cuz * cvv - cvz * cuv) / safe
    east = (cvz * cuu - cuz * cuv) / safe
    return np.where(enough[..., None], np.stack([north, east], axis=-1), np.nan)
