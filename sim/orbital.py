# SPDX-License-Identifier: Apache-2.0
"""Terrains from orbital maps: a highway chart, and patches drawn where rovers would drive."""

import math
from dataclasses import dataclass
from typing import Annotated, Any, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator
from scipy.ndimage import label, minimum_filter

from sim.base import BaseFile, check_cfa, place_patch, same_projection
from sim.config import ConfigModel
from sim.errors import TerrainError
from sim.generate import TerrainRecipe
from sim.random_streams import SEED_MAX, rng_for
from sim.raster import MapGrid, MapPlace
from sim.rocks import CFA_MAX
from sim.routes import Highways, RouteCost, find_highways
from sim.terrain_io import open_map

# routes are planned on at most this many cells; larger maps are averaged in blocks
CELLS_MAX = 400_000
STRIP_NODES = 4_000_000

Grid = npt.NDArray[np.float64]
PointM = tuple[float, float]


class Ellipse(ConfigModel):
    """Landing probability: a normal distribution on the ground.

    Attributes:
        center_m: North and east from the middle of the map.
        sigma_m: Standard deviations along and across.
        azimuth_deg: Direction of the first, clockwise from north.
    """

    center_m: PointM = (0.0, 0.0)
    sigma_m: tuple[Annotated[float, Field(gt=0)], Annotated[float, Field(gt=0)]]
    azimuth_deg: float = 0.0


class Region(ConfigModel):
    """A region of interest: a disc, reached where the way is cheapest."""

    center_m: PointM
    radius_m: Annotated[float, Field(ge=0)] = 10.0


class OrbitalConfig(ConfigModel):
    """What to make from a map. Places are north and east in metres from the middle of the map.

    Attributes:
        dem: Elevation map.
        band: Its band, where it has several.
        true_scale: Pixels as large as they are on the ground, whatever the projection.
        cfa: Cumulative fractional area of rocks everywhere.
        cfa_file: Map of it instead.
        landing_points_m: Where routes start; none draws `landing_count` of them.
        landing_ellipse: Distribution to draw them from; None is all level ground.
        landing_count: How many are drawn.
        landing_slope_max_deg: Nobody lands on steeper ground.
        regions: Where routes go; none draws `region_count` of them from passable ground.
        region_count: How many are drawn.
        cost: What a route minimises.
        count: Patches to draw.
        size_m: Edge of a patch.
        resolution_m: Distance between its nodes.
        rock_diameter_min_m: Smallest rock sprinkled.
        rock_diameter_max_m: Largest rock.
        start_m: Where drives start on a patch; the strip of the first crawl is cleared.
        start_yaw_deg: Their heading.
        seed: Of everything drawn.
    """

    dem: str
    band: Annotated[int, Field(ge=1)] | None = None
    true_scale: bool = True
    cfa: Annotated[float, Field(ge=0, le=CFA_MAX)] | None = None
    cfa_file: str | None = None
    landing_points_m: tuple[PointM, ...] = ()
    landing_ellipse: Ellipse | None = None
    landing_count: Annotated[int, Field(ge=1, le=10_000)] = 64
    landing_slope_max_deg: Annotated[float, Field(gt=0, le=60)] = 10.0
    regions: tuple[Region, ...] = ()
    region_count: Annotated[int, Field(ge=1, le=1000)] = 8
    cost: RouteCost = RouteCost()
    count: Annotated[int, Field(ge=1, le=100_000)] = 10
    size_m: Annotated[float, Field(gt=0, le=10_000)] = 120.0
    resolution_m: Annotated[float, Field(ge=0.01, le=10)] = 0.1
    rock_diameter_min_m: Annotated[float, Field(ge=0.02, le=10)] = 0.1
    rock_diameter_max_m: Annotated[float, Field(ge=0.02, le=20)] = 2.0
    start_m: PointM | None = (-40.0, 0.0)
    start_yaw_deg: float = 0.0
    seed: Annotated[int, Field(ge=0, le=SEED_MAX)] = 0

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.cfa is not None and self.cfa_file is not None:
            raise ValueError("give cfa or cfa_file, not both")
        if self.landing_points_m and self.landing_ellipse is not None:
            raise ValueError("give landing_points_m or landing_ellipse, not both")
        if self.rock_diameter_min_m >= self.rock_diameter_max_m:
            raise ValueError("rock_diameter_min_m must be less than rock_diameter_max_m")
        if self.start_m is not None and max(map(abs, self.start_m)) > 0.5 * self.size_m:
            raise ValueError(f"start_m {list(self.start_m)} is not on the patch")
        return self


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """A map as routes see it, row 0 south, NaN where there is no data.

    Attributes:
        source: The map.
        block: Its pixels in a cell, each way.
        cell_m: North and east size of a cell on the ground.
        up_m: Mean elevation.
        slope_rad: Mean slope of the pixels.
        cfa: Rocks.
    """

    source: MapGrid
    block: int
    cell_m: tuple[float, float]
    up_m: Grid
    slope_rad: Grid
    cfa: Grid

    @property
    def place(self) -> MapPlace | None:
        """Where the grid of cells lies."""
        place = self.source.place
        if place is None:
            # metres from the middle of the map
            rows, cols = self.source.shape
            step = self.source.cell_m
            place = MapPlace("", -0.5 * (cols - 1) * step, -0.5 * (rows - 1) * step, step)
        shift = 0.5 * (self.block - 1) * place.step
        return MapPlace(
            place.crs_wkt, place.x_min + shift, place.y_min + shift, self.block * place.step
        )

    def pixel_of(self, cell: npt.ArrayLike) -> Grid:
        """Row (0) or column (1) of the map in the middle of cells."""
        result: Grid = np.asarray(cell, dtype=float) * self.block + 0.5 * (self.block - 1)
        return result

    def offset_m(self, cell: npt.ArrayLike, axis: int) -> Grid:
        """North (axis 0) or east (1) of cells from the middle of the map."""
        size_m = self.cell_m[axis] / self.block
        middle = 0.5 * (self.source.shape[axis] - 1)
        result: Grid = (self.pixel_of(cell) - middle) * size_m
        return result

    def cell_at(self, point_m: PointM) -> tuple[int, int]:
        """Cell that holds a place."""
        row, col = (
            math.floor(
                (point_m[axis] / self.cell_m[axis] * self.block + 0.5 * self.source.shape[axis])
                / self.block
            )
            for axis in (0, 1)
        )
        if not (0 <= row < self.up_m.shape[0] and 0 <= col < self.up_m.shape[1]):
            raise TerrainError(
                f"{self.source.path}: {point_m[0]:g}, {point_m[1]:g} m from its middle is not on"
                " the map"
            )
        return row, col


@dataclass(frozen=True, slots=True, eq=False)
class OrbitalPlan:
    """Routes over a map, and the patches drawn from them.

    Attributes:
        config: With the landing points and regions that were drawn.
        ground: The map.
        highways: The routes.
        cells: Row and column [count, 2] of the middle of every patch.
        recipes: How to make them.
        origins: Where they came from.
    """

    config: OrbitalConfig
    ground: Ground
    highways: Highways
    cells: npt.NDArray[np.int64]
    recipes: tuple[TerrainRecipe, ...]
    origins: tuple[dict[str, Any], ...]


def plan_orbital(config: OrbitalConfig) -> OrbitalPlan:
    """Read the maps, find the highways, draw the patches."""
    ground = read_ground(config)
    cost = config.cost.per_m(ground.slope_rad, ground.cfa)
    passable = _largest_part(np.isfinite(cost))
    if not passable.any():
        raise TerrainError(f"{config.dem}: no ground that can be driven on, by slope and CFA")
    config = config.model_copy(
        update={
            "landing_points_m": config.landing_points_m or _draw_landings(config, ground, passable),
            "regions": config.regions or _draw_regions(config, ground, passable),
        }
    )
    starts = [ground.cell_at(point_m) for point_m in config.landing_points_m]
    regions = [_cells_in(region, ground) for region in config.regions]
    highways = find_highways(cost, ground.cell_m, starts, regions)
    if not highways.routes:
        raise TerrainError(
            f"{config.dem}: no route from a landing point to a region of interest"
            f" (ground steeper than {config.cost.slope_max_deg:g} deg or with a CFA over"
            f" {config.cost.cfa_max:g} is not driven on)"
        )
    cells = _draw_patches(config, ground, highways)
    made = [_recipe_at(config, ground, index, cell) for index, cell in enumerate(cells)]
    return OrbitalPlan(
        config,
        ground,
        highways,
        cells,
        tuple(recipe for recipe, _ in made),
        tuple(origin for _, origin in made),
    )


# ------------------------------------------------------------------ the map


def read_ground(config: OrbitalConfig) -> Ground:
    """Elevation, slope and CFA on the cells that routes are planned on."""
    source = open_map(config.dem, config.band)
    rows, cols = source.shape
    if min(rows, cols) < 3:
        raise TerrainError(f"{config.dem}: {cols} x {rows} pixels, too small to plan routes on")
    block = max(1, math.ceil(math.sqrt(rows * cols / CELLS_MAX)))
    middle = 0.5 * (rows - 1), 0.5 * (cols - 1)
    pixel_m = source.cell_true_m(*middle) if config.true_scale else (source.cell_m,) * 2
    for axis, size in enumerate((rows, cols)):
        if pixel_m[axis] * (size - 1) < config.size_m:
            raise TerrainError(
                f"{config.dem}: a patch of {config.size_m:g} m is larger than the map of"
                f" {pixel_m[0] * (rows - 1):g} x {pixel_m[1] * (cols - 1):g} m"
            )
    up_m, slope_rad = _read_blocks(source, block, pixel_m)
    if not np.any(np.isfinite(up_m)):
        raise TerrainError(f"{config.dem}: every pixel is no-data, expected heights in metres")
    cell_m = (block * pixel_m[0], block * pixel_m[1])
    ground = Ground(source, block, cell_m, up_m, slope_rad, np.zeros_like(up_m))
    if config.cfa_file is not None:
        ground.cfa[:] = _read_cfa(config.cfa_file, ground)
    elif config.cfa is not None:
        ground.cfa[:] = config.cfa
    return ground


def _read_blocks(source: MapGrid, block: int, pixel_m: tuple[float, float]) -> tuple[Grid, Grid]:
    """Mean elevation and mean slope of blocks of pixels; a hole spoils its block."""
    rows, cols = source.shape[0] // block, source.shape[1] // block
    up_m, slope_rad = np.empty((rows, cols)), np.empty((rows, cols))
    strip = max(1, STRIP_NODES // (block * source.shape[1]))
    for first in range(0, rows, strip):
        last = min(first + strip, rows)
        low, high = max(0, first * block - 1), min(source.shape[0], last * block + 1)
        heights = source.read(slice(low, high), slice(0, source.shape[1]))
        north, east = np.gradient(heights, *pixel_m)
        slope = np.arctan(np.hypot(north, east))
        inner = slice(first * block - low, last * block - low)
        for values, result in ((heights, up_m), (slope, slope_rad)):
            part = values[inner, : cols * block].reshape(last - first, block, cols, block)
            result[first:last] = part.mean(axis=(1, 3))
    return up_m, slope_rad


def _read_cfa(path: str, ground: Ground) -> Grid:
    """CFA of the nearest pixel of a map; NaN beyond its edge."""
    source = open_map(path)
    rows, cols = (ground.pixel_of(np.arange(ground.up_m.shape[axis])) for axis in (0, 1))
    here, there = source.place, ground.source.place
    if here is not None and there is not None:
        if not same_projection(here.crs_wkt, there.crs_wkt):
            raise TerrainError(
                f"{path}: another projection than {ground.source.path}, expected the same"
            )
        ratio = there.step / here.step
        rows = ((there.y_min - here.y_min) / there.step + rows) * ratio
        cols = ((there.x_min - here.x_min) / there.step + cols) * ratio
    else:
        ratio = ground.source.cell_m / source.cell_m
        rows = (rows - 0.5 * (ground.source.shape[0] - 1)) * ratio + 0.5 * (source.shape[0] - 1)
        cols = (cols - 0.5 * (ground.source.shape[1] - 1)) * ratio + 0.5 * (source.shape[1] - 1)
    i, j = np.rint(rows).astype(np.int64), np.rint(cols).astype(np.int64)
    inside = ((i >= 0) & (i < source.shape[0]))[:, None] & ((j >= 0) & (j < source.shape[1]))
    if not inside.any():
        raise TerrainError(f"{path}: the CFA map does not lie on {ground.source.path}")
    values = source.read(slice(0, source.shape[0]), slice(0, source.shape[1]))
    known = values[np.isfinite(values)]
    check_cfa(path, known if len(known) else values)
    i, j = np.clip(i, 0, source.shape[0] - 1), np.clip(j, 0, source.shape[1] - 1)
    return np.where(inside, values[np.ix_(i, j)], np.nan)


# ------------------------------------------------------------------ places


def _largest_part(passable: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """The largest connected part: from anywhere in it a rover can reach everywhere else."""
    parts, count = label(passable, structure=np.ones((3, 3)))
    if count == 0:
        return passable
    sizes = np.bincount(parts.reshape(-1))
    sizes[0] = 0
    result: npt.NDArray[np.bool_] = parts == int(np.argmax(sizes))
    return result


def _draw_cells(weight: Grid, count: int, rng: np.random.Generator) -> npt.NDArray[np.int64]:
    """Cells [count, 2] drawn with these weights, each once where there are enough.

    Exponential keys: a larger count begins with the cells of a smaller one.
    """
    flat = weight.reshape(-1)
    with np.errstate(divide="ignore"):
        key = np.where(flat > 0, rng.standard_exponential(flat.size) / flat, np.inf)
    usable = int(np.count_nonzero(flat))
    chosen = np.resize(np.argsort(key, kind="stable")[: min(count, usable)], count)
    return np.column_stack(np.unravel_index(chosen, weight.shape))


def _places_m(ground: Ground, cells: npt.NDArray[np.int64]) -> list[PointM]:
    north, east = ground.offset_m(cells[:, 0], 0), ground.offset_m(cells[:, 1], 1)
    return [(round(float(n), 6), round(float(e), 6)) for n, e in zip(north, east, strict=True)]


def _draw_landings(
    config: OrbitalConfig, ground: Ground, passable: npt.NDArray[np.bool_]
) -> tuple[PointM, ...]:
    level = passable & (ground.slope_rad <= math.radians(config.landing_slope_max_deg))
    weight = level.astype(np.float64)
    if config.landing_ellipse is not None:
        weight *= _density(config.landing_ellipse, ground)
    if not weight.sum() > 0:
        raise TerrainError(
            f"{config.dem}: nowhere to land on slopes up to {config.landing_slope_max_deg:g} deg"
        )
    cells = _draw_cells(weight, config.landing_count, rng_for(config.seed, "orbital.landing"))
    return tuple(_places_m(ground, cells))


def _density(ellipse: Ellipse, ground: Ground) -> Grid:
    north = ground.offset_m(np.arange(ground.up_m.shape[0]), 0)[:, None] - ellipse.center_m[0]
    east = ground.offset_m(np.arange(ground.up_m.shape[1]), 1)[None, :] - ellipse.center_m[1]
    azimuth_rad = math.radians(ellipse.azimuth_deg)
    along = north * math.cos(azimuth_rad) + east * math.sin(azimuth_rad)
    across = east * math.cos(azimuth_rad) - north * math.sin(azimuth_rad)
    distance2 = (along / ellipse.sigma_m[0]) ** 2 + (across / ellipse.sigma_m[1]) ** 2
    result: Grid = np.exp(-0.5 * distance2)
    return result


def _draw_regions(
    config: OrbitalConfig, ground: Ground, passable: npt.NDArray[np.bool_]
) -> tuple[Region, ...]:
    rng = rng_for(config.seed, "orbital.regions")
    cells = _draw_cells(passable.astype(np.float64), config.region_count, rng)
    return tuple(Region(center_m=place_m) for place_m in _places_m(ground, cells))


def _cells_in(region: Region, ground: Ground) -> npt.NDArray[np.int64]:
    row, col = ground.cell_at(region.center_m)
    rows, cols = ground.up_m.shape
    north = ground.offset_m(np.arange(rows), 0)[:, None] - region.center_m[0]
    east = ground.offset_m(np.arange(cols), 1)[None, :] - region.center_m[1]
    inside = np.hypot(north, east) <= region.radius_m
    inside[row, col] = True
    result: npt.NDArray[np.int64] = np.flatnonzero(inside)
    return result


# ------------------------------------------------------------------ patches


def _draw_patches(
    config: OrbitalConfig, ground: Ground, highways: Highways
) -> npt.NDArray[np.int64]:
    """Cells drawn uniformly along the routes where a whole patch has ground under it."""
    has_ground = np.isfinite(ground.up_m) & np.isfinite(ground.cfa)
    reach = [math.ceil(0.5 * config.size_m / cell_m) + 1 for cell_m in ground.cell_m]
    fits = minimum_filter(
        has_ground.astype(np.uint8), size=[2 * cells + 1 for cells in reach], mode="constant"
    )
    weight = highways.driven_m * fits
    if not weight.sum() > 0:
        raise TerrainError(
            f"{config.dem}: no place on a route where a patch of {config.size_m:g} m has ground"
            " everywhere (the edge of the map or no-data is too near)"
        )
    return _draw_cells(weight, config.count, rng_for(config.seed, "orbital.patches"))


def _recipe_at(
    config: OrbitalConfig, ground: Ground, index: int, cell: npt.NDArray[np.int64]
) -> tuple[TerrainRecipe, dict[str, Any]]:
    center_m = _places_m(ground, cell[None])[0]
    recipe = TerrainRecipe(
        size_m=config.size_m,
        resolution_m=config.resolution_m,
        base_file=config.dem,
        base_center_m=center_m,
        base_band=config.band,
        base_true_scale=config.true_scale,
        cfa=config.cfa,
        cfa_file=config.cfa_file,
        rock_diameter_min_m=config.rock_diameter_min_m,
        rock_diameter_max_m=config.rock_diameter_max_m,
        start_m=config.start_m,
        start_yaw_deg=config.start_yaw_deg,
        seed=int(rng_for(config.seed, f"orbital.patch.{index}").integers(2**31)),
    )
    return recipe, origin_of(recipe, ground)


def origin_of(recipe: TerrainRecipe, ground: Ground) -> dict[str, Any]:
    """Where the middle of a patch lies, and what the map says about the patch."""
    base: BaseFile = recipe.base_files()[0]
    patch = place_patch(ground.source, base.center_m, base.true_scale)
    row, col = (float(value) for value in patch.row_col(0.0, 0.0))
    half_m = 0.5 * recipe.size_m
    (low_row, high_row), (low_col, high_col) = (
        (ground.cell_at((base.center_m[0] - half_m, base.center_m[1] - half_m))[axis],
         ground.cell_at((base.center_m[0] + half_m, base.center_m[1] + half_m))[axis] + 1)
        for axis in (0, 1)
    )  # fmt: skip
    window = (slice(low_row, high_row), slice(low_col, high_col))
    origin: dict[str, Any] = {
        "dem": base.file,
        # as pictures and GDAL count them: from the north-western pixel's middle
        "pixel_line": round(ground.source.shape[0] - 1 - row, 4),
        "pixel_sample": round(col, 4),
        "pixel_north_m": round(patch.cell_m[0], 6),
        "pixel_east_m": round(patch.cell_m[1], 6),
        "slope_mean_deg": round(float(np.degrees(np.mean(ground.slope_rad[window]))), 3),
        "cfa_mean": round(float(np.mean(ground.cfa[window])), 5),
    }
    place = ground.source.place
    if place is not None:
        x, y = place.xy(row, col)
        longitude_deg, latitude_deg = place.lonlat_deg(row, col)
        origin |= {
            "map_x": round(x, 3),
            "map_y": round(y, 3),
            "longitude_deg": round(longitude_deg, 7),
            "latitude_deg": round(latitude_deg, 7),
        }
    return origin
