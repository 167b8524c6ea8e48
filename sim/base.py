# SPDX-License-Identifier: Apache-2.0
"""Base terrains from files: a patch of a heightmap or of an orbital map, resampled smoothly."""

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
import numpy.typing as npt
from pydantic import Field
from scipy.interpolate import RectBivariateSpline
from scipy.ndimage import map_coordinates

from sim.config import ConfigModel
from sim.errors import TerrainError
from sim.landforms import Combination
from sim.raster import MapGrid
from sim.rocks import CFA_MAX
from sim.terrain_io import open_map

# nodes read beyond the patch on either side, where there are any: the spline's ends stay outside;
# the second where no-data is near the patch
MARGINS_NODES = (4, 1)

Grid = npt.NDArray[np.float64]


class BaseFile(ConfigModel):
    """A heightmap from a file.

    Attributes:
        file: Terrain file: PGM with side-car, GeoTIFF, PDS3, PDS4, ISIS3, JPEG 2000, ...
        center_m: North and east, from the middle of the map, of the middle of the patch.
        scale: Factor on the heights.
        band: Band of a raster with several, counted from 1.
        true_scale: Pixels as large as they are on the ground where the patch lies; False takes the
            size that the file states. A PGM has no place on a planet: there it is the same.
        combine: How it joins the bases before it.
    """

    file: str
    center_m: tuple[float, float] = (0.0, 0.0)
    scale: Annotated[float, Field(ge=-1000, le=1000)] = 1.0
    band: Annotated[int, Field(ge=1)] | None = None
    true_scale: bool = False
    combine: Combination = "add"


@dataclass(frozen=True, slots=True, eq=False)
class Patch:
    """A square of a map, with its own north and east in metres.

    Attributes:
        source: The map.
        cell_m: North and east size of a pixel.
        middle_m: North and east of the patch's middle from the map's middle, in such pixels.
    """

    source: MapGrid
    cell_m: tuple[float, float]
    middle_m: tuple[float, float]

    def axis_m(self, axis: int) -> Grid:
        """Distance of every row (0) or column (1) of the map from the map's middle."""
        count, cell_m = self.source.shape[axis], self.cell_m[axis]
        result: Grid = -0.5 * (count - 1) * cell_m + cell_m * np.arange(count, dtype=float)
        return result

    def row_col(self, north_m: npt.ArrayLike, east_m: npt.ArrayLike) -> tuple[Grid, Grid]:
        """Row and column, with fractions, of places on the patch."""
        rows, cols = self.source.shape
        north, east = (np.asarray(value, dtype=np.float64) for value in (north_m, east_m))
        return (
            0.5 * (rows - 1) + (self.middle_m[0] + north) / self.cell_m[0],
            0.5 * (cols - 1) + (self.middle_m[1] + east) / self.cell_m[1],
        )


def place_patch(source: MapGrid, center_m: tuple[float, float], true_scale: bool) -> Patch:
    """Patch around a place given from the map's middle, by the size of its pixels there."""
    cell_m = (source.cell_m, source.cell_m)
    if not true_scale or source.place is None:
        return Patch(source, cell_m, center_m)
    middle = (0.5 * (source.shape[0] - 1), 0.5 * (source.shape[1] - 1))
    middle_cell_m = source.cell_true_m(*middle)
    row, col = (middle[axis] + center_m[axis] / middle_cell_m[axis] for axis in (0, 1))
    cell_m = source.cell_true_m(row, col)
    middle_m = ((row - middle[0]) * cell_m[0], (col - middle[1]) * cell_m[1])
    return Patch(source, cell_m, middle_m)


def patch_of(base: BaseFile) -> Patch:
    """The patch that a base stands for."""
    return place_patch(open_map(base.file, base.band), base.center_m, base.true_scale)


def base_z_m(base: BaseFile, axis_m: Grid) -> tuple[Grid, float]:
    """Heights (z down, zero in the middle) of a base on the nodes of a square.

    A cubic spline runs through the map's own pixels, so that what the map shows stays as it is.

    Returns:
        The heights, and the elevation in the map of the place where they are zero.
    """
    patch = patch_of(base)
    path, half_m = patch.source.path, float(axis_m[-1])
    axes = []
    for axis in (0, 1):
        axes.append(patch.axis_m(axis))
        middle_m = patch.middle_m[axis]
        if not axes[axis][0] <= middle_m - half_m <= middle_m + half_m <= axes[axis][-1]:
            size_m = [patch.cell_m[axis] * (patch.source.shape[axis] - 1) for axis in (0, 1)]
            raise TerrainError(
                f"{path}: {2 * half_m:g} m around center {list(base.center_m)} is not"
                f" inside the base of {size_m[0]:g} x {size_m[1]:g} m"
            )
    for margin in MARGINS_NODES:
        rows, cols = (_window(axes[axis], patch, axis, half_m, margin) for axis in (0, 1))
        heights = -patch.source.read(rows, cols).astype(np.float32).astype(np.float64)
        if np.all(np.isfinite(heights)):
            break
    else:
        raise TerrainError(f"{path}: no-data nodes inside the wanted window, expected heights")
    degree = min(3, min(heights.shape) - 1)
    spline = RectBivariateSpline(axes[0][rows], axes[1][cols], heights, kx=degree, ky=degree)
    z_m: Grid = spline(patch.middle_m[0] + axis_m, patch.middle_m[1] + axis_m)
    middle_z_m = float(z_m[len(axis_m) // 2, len(axis_m) // 2])
    z_m -= middle_z_m
    z_m *= base.scale
    return z_m, -middle_z_m


def _window(axis_m: Grid, patch: Patch, axis: int, half_m: float, margin: int) -> slice:
    """Nodes of an axis within half_m of the middle of a patch, and a margin on either side."""
    middle_m, step_m = patch.middle_m[axis], patch.cell_m[axis]
    first = math.floor((middle_m - half_m - axis_m[0]) / step_m) - margin
    last = math.ceil((middle_m + half_m - axis_m[0]) / step_m) + margin
    return slice(max(first, 0), min(last, len(axis_m) - 1) + 1)


@dataclass(frozen=True, slots=True, eq=False)
class CfaPatch:
    """CFA on a patch of ground, from a map.

    Attributes:
        values: The map's pixels around the patch [rows, columns], row 0 south.
        first: Row and column of values[0, 0] in the map.
        patch: How the ground lies on the map.
    """

    values: Grid
    first: tuple[int, int]
    patch: Patch

    def at(self, north_m: npt.ArrayLike, east_m: npt.ArrayLike) -> Grid:
        """Bilinear CFA at places on the ground."""
        row, col = self.patch.row_col(north_m, east_m)
        places = np.stack([row - self.first[0], col - self.first[1]])
        result: Grid = map_coordinates(self.values, places, order=1, mode="nearest")
        return result


def read_cfa(path: str, base: BaseFile | None, half_m: float) -> CfaPatch:
    """CFA on the ground of a base, or of a square of its own without one.

    Two maps that both have a place on the planet are laid on each other by their coordinates;
    otherwise their middles coincide.
    """
    source = open_map(path)
    patch = _cfa_patch(source, base)
    row, col = patch.row_col([-half_m, half_m], [-half_m, half_m])
    reach = 1e-6  # of a pixel: a patch may end where the map ends
    limits = [(source.shape[axis] - 1) for axis in (0, 1)]
    if min(row[0], col[0]) < -0.5 - reach or any(
        last > limit + 0.5 + reach for last, limit in zip((row[1], col[1]), limits, strict=True)
    ):
        raise TerrainError(f"{path}: the CFA map does not cover the terrain")
    rows, cols = (
        slice(max(0, math.floor(low)), min(limit, math.ceil(high)) + 1)
        for (low, high), limit in zip((row, col), limits, strict=True)
    )
    # one more where the square lies within a single row or column of the map
    rows, cols = (
        slice(min(part.start, limit - 1), max(part.stop, part.start + 2))
        for part, limit in zip((rows, cols), limits, strict=True)
    )
    values = source.read(rows, cols)
    check_cfa(path, values)
    return CfaPatch(values, (rows.start, cols.start), patch)


def _cfa_patch(source: MapGrid, base: BaseFile | None) -> Patch:
    if base is None:
        return place_patch(source, (0.0, 0.0), False)
    ground = patch_of(base)
    here, there = source.place, ground.source.place
    if here is None or there is None:
        return place_patch(source, base.center_m, base.true_scale)
    if not same_projection(here.crs_wkt, there.crs_wkt):
        raise TerrainError(
            f"{source.path}: another projection than {ground.source.path}, expected the same"
        )
    ground_row, ground_col = ground.row_col(0.0, 0.0)
    row, col = here.row_col(*there.xy(float(ground_row), float(ground_col)))
    stretch = here.step / there.step
    cell_m = (ground.cell_m[0] * stretch, ground.cell_m[1] * stretch)
    middle_m = (
        (row - 0.5 * (source.shape[0] - 1)) * cell_m[0],
        (col - 0.5 * (source.shape[1] - 1)) * cell_m[1],
    )
    return Patch(source, cell_m, middle_m)


def same_projection(first_wkt: str, second_wkt: str) -> bool:
    """Whether two maps share their coordinates."""
    from rasterio.crs import CRS

    return bool(first_wkt == second_wkt or CRS.from_wkt(first_wkt) == CRS.from_wkt(second_wkt))


def check_cfa(path: str, values: Grid) -> None:
    """Refuse holes and what is no CFA."""
    if not np.all(np.isfinite(values)):
        raise TerrainError(f"{path}: no-data inside the wanted window, expected CFA values")
    low, high = float(values.min()), float(values.max())
    if low < 0 or high > CFA_MAX:
        wrong = low if low < 0 else high
        raise TerrainError(f"{path}: CFA {wrong:g}, expected fractions of 0 to {CFA_MAX:g}")
