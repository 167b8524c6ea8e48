# SPDX-License-Identifier: Apache-2.0
"""Terrain: heights on a regular grid, bilinear in between, and the rocks that stand on it."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from sim.errors import TerrainError

ROCK_DTYPE = np.dtype(
    [("north_m", "f8"), ("east_m", "f8"), ("diameter_m", "f8"), ("height_m", "f8")]
)
# numbers in a class map; 0 leaves the choice to the slip configuration
CLASS_NAMES = ("unspecified", "bedrock", "cohesive_soil", "sand")


def no_rocks() -> npt.NDArray[np.void]:
    """An empty rock list."""
    return np.zeros(0, dtype=ROCK_DTYPE)


@dataclass(frozen=True, slots=True, eq=False)
class Terrain:
    """Heights in the SITE frame.

    Attributes:
        z_site_m: float32 [n_north, n_east], z down; the row index grows north, the column east.
        resolution_m: Distance between nodes.
        north_min_m: North of row 0.
        east_min_m: East of column 0.
        rocks: ROCK_DTYPE [n]; diameter of the circle of equal area, height above the ground.
        recipe: Plain data from which the terrain can be made again, or None.
        classes: Terrain class of every node, indices of CLASS_NAMES; None is no map.
    """

    z_site_m: npt.NDArray[np.float32]
    resolution_m: float
    north_min_m: float
    east_min_m: float
    rocks: npt.NDArray[np.void] = field(default_factory=no_rocks)
    recipe: dict[str, Any] | None = None
    classes: npt.NDArray[np.uint8] | None = None

    def __post_init__(self) -> None:
        """Check and freeze the grid."""
        z = np.ascontiguousarray(self.z_site_m, dtype=np.float32)
        if z.ndim != 2 or min(z.shape) < 2:
            raise TerrainError(f"terrain: expected at least 2 x 2 nodes, got shape {z.shape}")
        if not (np.isfinite(self.resolution_m) and self.resolution_m > 0):
            raise TerrainError(f"terrain: resolution must be positive, got {self.resolution_m}")
        if not (np.isfinite(self.north_min_m) and np.isfinite(self.east_min_m)):
            raise TerrainError("terrain: the position of the first node must be finite")
        if z.flags.writeable:
            z = z.copy() if z is self.z_site_m else z
            z.flags.writeable = False
        object.__setattr__(self, "z_site_m", z)
        if self.classes is not None and self.classes.shape != z.shape:
            raise TerrainError(
                f"terrain: classes of shape {self.classes.shape}, expected {z.shape}"
            )

    @property
    def north_max_m(self) -> float:
        """North of the last row."""
        return self.north_min_m + float(self.z_site_m.shape[0] - 1) * self.resolution_m

    @property
    def east_max_m(self) -> float:
        """East of the last column."""
        return self.east_min_m + float(self.z_site_m.shape[1] - 1) * self.resolution_m

    @property
    def north_m(self) -> npt.NDArray[np.float64]:
        """North of every row."""
        return self.north_min_m + self.resolution_m * np.arange(self.z_site_m.shape[0], dtype=float)

    @property
    def east_m(self) -> npt.NDArray[np.float64]:
        """East of every column."""
        return self.east_min_m + self.resolution_m * np.arange(self.z_site_m.shape[1], dtype=float)

    def contains(self, north_m: float, east_m: float, margin_m: float = 0.0) -> bool:
        """Whether a point lies at least `margin_m` inside the grid; False for NaN."""
        return bool(
            self.north_min_m + margin_m <= north_m <= self.north_max_m - margin_m
            and self.east_min_m + margin_m <= east_m <= self.east_max_m - margin_m
        )

    def height_at(self, north_m: npt.ArrayLike, east_m: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """Bilinear z (down) at points of any shape; NaN outside the grid."""
        row = (np.asarray(north_m, dtype=np.float64) - self.north_min_m) / self.resolution_m
        col = (np.asarray(east_m, dtype=np.float64) - self.east_min_m) / self.resolution_m
        rows, cols = self.z_site_m.shape
        inside = (row >= 0) & (row <= rows - 1) & (col >= 0) & (col <= cols - 1)
        row, col = np.where(inside, row, 0.0), np.where(inside, col, 0.0)
        i = np.minimum(row.astype(np.int64), rows - 2)
        j = np.minimum(col.astype(np.int64), cols - 2)
        u, v = row - i, col - j
        z = self.z_site_m
        south = z[i, j] * (1 - v) + z[i, j + 1] * v
        north = z[i + 1, j] * (1 - v) + z[i + 1, j + 1] * v
        return np.where(inside, south * (1 - u) + north * u, np.nan)

    def class_at(self, north_m: npt.ArrayLike, east_m: npt.ArrayLike) -> npt.NDArray[np.uint8]:
        """Class of the nearest node; 0 (unspecified) outside the grid or without a map."""
        north, east = np.broadcast_arrays(
            np.asarray(north_m, dtype=np.float64), np.asarray(east_m, dtype=np.float64)
        )
        result = np.zeros(north.shape, dtype=np.uint8)
        if self.classes is None:
            return result
        row = (north - self.north_min_m) / self.resolution_m
        col = (east - self.east_min_m) / self.resolution_m
        rows, cols = self.classes.shape
        inside = (row >= -0.5) & (row < rows - 0.5) & (col >= -0.5) & (col < cols - 0.5)
        i, j = np.rint(row[inside]).astype(np.int64), np.rint(col[inside]).astype(np.int64)
        result[inside] = self.classes[i, j]
        return result


def centred(
    z_site_m: npt.NDArray[np.float32],
    resolution_m: float,
    rocks: npt.NDArray[np.void] | None = None,
    recipe: dict[str, Any] | None = None,
    classes: npt.NDArray[np.uint8] | None = None,
) -> Terrain:
    """Terrain whose middle is the SITE origin, as every stored terrain has it."""
    rows, cols = z_site_m.shape
    return Terrain(
        z_site_m=z_site_m,
        resolution_m=resolution_m,
        north_min_m=-0.5 * (rows - 1) * resolution_m,
        east_min_m=-0.5 * (cols - 1) * resolution_m,
        rocks=no_rocks() if rocks is None else rocks,
        recipe=recipe,
        classes=classes,
    )
