# SPDX-License-Identifier: Apache-2.0
"""Terrain from a recipe, in layers: base, undulation, slope, rocks (SIM section 3)."""

import json
import math
from pathlib import Path
from typing import Annotated, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator
from scipy.interpolate import RectBivariateSpline

from sim.config import ConfigModel, parse_model
from sim.errors import TerrainError
from sim.landforms import Landform, landform_up_m
from sim.random_streams import SEED_MAX, rng_for
from sim.rocks import draw_rocks, outside_strip, stamp_rocks
from sim.terrain import Terrain, centred, no_rocks
from sim.terrain_io import read_terrain
from sim.undulation import UNDULATION_DEFAULT, Undulation, undulation_up_m

NODES_MAX = 50_000_000
# the strip of the first crawl of 5.5 m: behind, ahead, half width, and the rock height it allows
CLEAR_STRIP_M = (2.5, 8.0, 2.2)
CLEAR_HEIGHT_MAX_M = 0.10
TEXTURE_SCALE_M = 0.1

Grid = npt.NDArray[np.float64]


class TerrainRecipe(ConfigModel):
    """Everything needed to make a terrain again, byte for byte.

    Attributes:
        size_m: Edge of the square.
        resolution_m: Distance between nodes.
        base_file: Terrain file (PGM, GeoTIFF, ...) under the other layers.
        base_center_m: North and east, from the middle of the base, of the middle of this terrain.
        base_scale: Factor on the base's heights.
        landform: A made base; not together with `base_file`.
        slope_deg: Constant slope.
        slope_azimuth_deg: Up-slope direction clockwise from north; None draws it from the seed.
        cfa: Cumulative fractional area of rocks, a fraction; None or 0 is no rocks.
        undulation: Layers; None is the default of two, or none with a base file.
        rock_diameter_min_m: Smallest rock made.
        rock_diameter_max_m: Largest rock made.
        start_m: Where a drive starts; the strip of its first crawl is cleared of rocks.
        start_yaw_deg: Heading of that drive.
        seed: Of every random layer.
    """

    size_m: Annotated[float, Field(gt=0, le=10_000)] = 120.0
    resolution_m: Annotated[float, Field(ge=0.01, le=10)] = 0.1
    base_file: str | None = None
    base_center_m: tuple[float, float] = (0.0, 0.0)
    base_scale: Annotated[float, Field(ge=-1000, le=1000)] = 1.0
    landform: Landform | None = None
    slope_deg: Annotated[float, Field(ge=0, le=60)] = 0.0
    slope_azimuth_deg: Annotated[float, Field(ge=-360, le=360)] | None = None
    cfa: Annotated[float, Field(ge=0, le=0.5)] | None = None
    undulation: tuple[Undulation, ...] | None = None
    rock_diameter_min_m: Annotated[float, Field(ge=0.02, le=10)] = 0.1
    rock_diameter_max_m: Annotated[float, Field(ge=0.02, le=20)] = 2.0
    start_m: tuple[float, float] | None = None
    start_yaw_deg: float = 0.0
    seed: Annotated[int, Field(ge=0, le=SEED_MAX)] = 0

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.rock_diameter_min_m >= self.rock_diameter_max_m:
            raise ValueError("rock_diameter_min_m must be less than rock_diameter_max_m")
        if self.base_file is not None and self.landform is not None:
            raise ValueError("give base_file or landform, not both")
        nodes = self.size_m / self.resolution_m
        if nodes < 2 or nodes**2 > NODES_MAX:
            raise ValueError(
                f"size_m / resolution_m gives {nodes:.0f} x {nodes:.0f} nodes,"
                f" expected 2 x 2 to {NODES_MAX:.0e} nodes in all"
            )
        return self


def generate(
    recipe: TerrainRecipe,
    clear: tuple[float, float, float] | None = None,
    seed: int | None = None,
) -> Terrain:
    """Make the terrain of a recipe.

    Args:
        recipe: What to make.
        clear: Start pose (north, east, yaw in radians) to clear; replaces the recipe's.
        seed: Replaces the recipe's seed.

    Returns:
        A terrain centred on the SITE origin whose `recipe` makes it again.
    """
    if clear is not None:
        recipe = recipe.model_copy(
            update={"start_m": clear[:2], "start_yaw_deg": math.degrees(clear[2])}
        )
    if seed is not None:
        recipe = TerrainRecipe.model_validate({**dict(recipe), "seed": seed})
    count = round(recipe.size_m / recipe.resolution_m)
    axis_m = (np.arange(count, dtype=np.float64) - 0.5 * (count - 1)) * recipe.resolution_m
    ground = _base_z_m(recipe, axis_m)
    for index, layer in enumerate(_undulation_of(recipe)):
        rng = rng_for(recipe.seed, f"undulation.{index}")
        ground -= undulation_up_m(ground.shape, recipe.resolution_m, layer, rng)
    ground -= _slope_up_m(recipe, axis_m)
    rocks = no_rocks()
    if recipe.cfa:
        ground, rocks = _with_rocks(recipe, recipe.cfa, ground, float(axis_m[0]))
    return centred(
        ground.astype(np.float32), recipe.resolution_m, rocks, recipe.model_dump(mode="json")
    )


def recipe_of(terrain: Terrain) -> TerrainRecipe | None:
    """The recipe of a terrain that was generated, also after it was stored and read back."""
    if terrain.recipe is None:
        return None
    return parse_model(json.dumps(terrain.recipe), "recipe", TerrainRecipe)


def _undulation_of(recipe: TerrainRecipe) -> tuple[Undulation, ...]:
    if recipe.undulation is not None:
        return recipe.undulation
    return UNDULATION_DEFAULT if recipe.base_file is None else ()


def _base_z_m(recipe: TerrainRecipe, axis_m: Grid) -> Grid:
    """Base layer, z down, zero in its middle."""
    if recipe.base_file is not None:
        return _base_from_file(recipe, Path(recipe.base_file), axis_m)
    if recipe.landform is not None:
        rng = rng_for(recipe.seed, "landform")
        return -landform_up_m(recipe.landform, axis_m, axis_m, rng)
    return np.zeros((len(axis_m), len(axis_m)))


def _base_from_file(recipe: TerrainRecipe, path: Path, axis_m: Grid) -> Grid:
    """Window of a base terrain, resampled with a cubic spline."""
    base = read_terrain(path)
    middle_north = 0.5 * (base.north_min_m + base.north_max_m) + recipe.base_center_m[0]
    middle_east = 0.5 * (base.east_min_m + base.east_max_m) + recipe.base_center_m[1]
    half_m = float(axis_m[-1])
    if not (
        base.contains(middle_north - half_m, middle_east - half_m)
        and base.contains(middle_north + half_m, middle_east + half_m)
    ):
        raise TerrainError(
            f"{path}: {recipe.size_m} m around base_center_m {list(recipe.base_center_m)} is not"
            f" inside the base of {base.north_max_m - base.north_min_m:g} x"
            f" {base.east_max_m - base.east_min_m:g} m"
        )
    rows = _window(base.north_m, middle_north, half_m, base.resolution_m)
    cols = _window(base.east_m, middle_east, half_m, base.resolution_m)
    patch = base.z_site_m[rows, cols].astype(np.float64)
    if not np.all(np.isfinite(patch)):
        raise TerrainError(f"{path}: no-data nodes inside the wanted window, expected heights")
    degree = min(3, min(patch.shape) - 1)
    spline = RectBivariateSpline(base.north_m[rows], base.east_m[cols], patch, kx=degree, ky=degree)
    z_m: Grid = spline(middle_north + axis_m, middle_east + axis_m)
    z_m -= z_m[len(axis_m) // 2, len(axis_m) // 2]
    z_m *= recipe.base_scale
    return z_m


def _window(axis_m: Grid, middle_m: float, half_m: float, step_m: float) -> slice:
    """Nodes of an axis within half_m of the middle, and four more on either side."""
    first = math.floor((middle_m - half_m - axis_m[0]) / step_m) - 4
    last = math.ceil((middle_m + half_m - axis_m[0]) / step_m) + 4
    return slice(max(first, 0), min(last, len(axis_m) - 1) + 1)


def _slope_up_m(recipe: TerrainRecipe, axis_m: Grid) -> Grid:
    azimuth_deg = recipe.slope_azimuth_deg
    if azimuth_deg is None:
        azimuth_deg = rng_for(recipe.seed, "slope_azimuth").uniform(0.0, 360.0)
    azimuth_rad = math.radians(azimuth_deg)
    up_north = math.tan(math.radians(recipe.slope_deg)) * math.cos(azimuth_rad)
    up_east = math.tan(math.radians(recipe.slope_deg)) * math.sin(azimuth_rad)
    rise: Grid = up_north * axis_m[:, None] + up_east * axis_m[None, :]
    return rise


def _with_rocks(
    recipe: TerrainRecipe, cfa: float, ground: Grid, first_m: float
) -> tuple[Grid, npt.NDArray[np.void]]:
    size_m = ground.shape[0] * recipe.resolution_m
    field = draw_rocks(
        cfa,
        recipe.rock_diameter_min_m,
        recipe.rock_diameter_max_m,
        (size_m, size_m),
        rng_for(recipe.seed, "rocks"),
    )
    if recipe.start_m is not None:
        yaw_rad = math.radians(recipe.start_yaw_deg)
        field = field.subset(
            outside_strip(field, recipe.start_m, yaw_rad, CLEAR_STRIP_M, CLEAR_HEIGHT_MAX_M)
        )
    # +-2 sigma of the texture span four units: unit standard deviation
    layer = Undulation(horizontal_scale_m=TEXTURE_SCALE_M, height_span_m=4.0)
    texture = undulation_up_m(
        ground.shape, recipe.resolution_m, layer, rng_for(recipe.seed, "rock_texture")
    )
    stamped = stamp_rocks(ground, recipe.resolution_m, (first_m, first_m), field, texture)
    return stamped, field.rocks
