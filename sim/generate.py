# SPDX-License-Identifier: Apache-2.0
"""Terrain from a recipe, in layers: base, undulation, slope, rocks (SIM section 3)."""

import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from pathlib import Path
from typing import Annotated, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator

from sim.base import BaseFile, base_z_m, read_cfa
from sim.classes import ClassLayer, class_map
from sim.config import ConfigModel, parse_model
from sim.landforms import Combination, Landform, landform_up_m
from sim.random_streams import SEED_MAX, rng_for
from sim.raster import NODES_MAX
from sim.rocks import CFA_MAX, RockField, draw_rocks, outside_strip, stamp_rocks, thinned
from sim.terrain import Terrain, centred, no_rocks
from sim.undulation import UNDULATION_DEFAULT, Undulation, undulation_up_m

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
        base_band: Band of the base's file, where it has several.
        base_true_scale: Correct the size of the base's pixels for where they are on the planet.
        bases: Several bases; the keys above are one.
        landform: A made base.
        landforms: Several, in the order in which they combine.
        slope_deg: Constant slope.
        slope_azimuth_deg: Up-slope direction clockwise from north; None draws it from the seed.
        cfa: Cumulative fractional area of rocks, a fraction; None or 0 is no rocks.
        cfa_file: Map of it, laid on the base by map coordinates.
        undulation: Layers; None is the default of two, or none with a base file.
        rock_diameter_min_m: Smallest rock made.
        rock_diameter_max_m: Largest rock made.
        classes: Patches of terrain classes, for slip.
        start_m: Where a drive starts; the strip of its first crawl is cleared of rocks.
        start_yaw_deg: Heading of that drive.
        seed: Of every random layer.
    """

    size_m: Annotated[float, Field(gt=0, le=10_000)] = 120.0
    resolution_m: Annotated[float, Field(ge=0.01, le=10)] = 0.1
    base_file: str | None = None
    base_center_m: tuple[float, float] = (0.0, 0.0)
    base_scale: Annotated[float, Field(ge=-1000, le=1000)] = 1.0
    base_band: Annotated[int, Field(ge=1)] | None = None
    base_true_scale: bool = False
    bases: tuple[BaseFile, ...] = ()
    landform: Landform | None = None
    landforms: tuple[Landform, ...] = ()
    slope_deg: Annotated[float, Field(ge=0, le=60)] = 0.0
    slope_azimuth_deg: Annotated[float, Field(ge=-360, le=360)] | None = None
    cfa: Annotated[float, Field(ge=0, le=CFA_MAX)] | None = None
    cfa_file: str | None = None
    undulation: tuple[Undulation, ...] | None = None
    rock_diameter_min_m: Annotated[float, Field(ge=0.02, le=10)] = 0.1
    rock_diameter_max_m: Annotated[float, Field(ge=0.02, le=20)] = 2.0
    classes: tuple[ClassLayer, ...] = ()
    start_m: tuple[float, float] | None = None
    start_yaw_deg: float = 0.0
    seed: Annotated[int, Field(ge=0, le=SEED_MAX)] = 0

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.rock_diameter_min_m >= self.rock_diameter_max_m:
            raise ValueError("rock_diameter_min_m must be less than rock_diameter_max_m")
        for one, several in (("base_file", "bases"), ("landform", "landforms")):
            if getattr(self, one) is not None and getattr(self, several):
                raise ValueError(f"give {one} or {several}, not both")
        if self.cfa is not None and self.cfa_file is not None:
            raise ValueError("give cfa or cfa_file, not both")
        for name in ("base_center_m", "base_scale", "base_band", "base_true_scale"):
            default = type(self).model_fields[name].default
            if self.base_file is None and getattr(self, name) != default:
                raise ValueError(f"{name} needs a base_file")
        nodes = self.size_m / self.resolution_m
        if nodes < 2 or nodes**2 > NODES_MAX:
            raise ValueError(
                f"size_m / resolution_m gives {nodes:.0f} x {nodes:.0f} nodes,"
                f" expected 2 x 2 to {NODES_MAX:.0e} nodes in all"
            )
        if self.start_m is not None and max(map(abs, self.start_m)) > 0.5 * self.size_m:
            raise ValueError(f"start_m {list(self.start_m)} is not on the terrain")
        return self

    def base_files(self) -> tuple[BaseFile, ...]:
        """All bases that come from files."""
        if self.base_file is None:
            return self.bases
        one = BaseFile(
            file=self.base_file,
            center_m=self.base_center_m,
            scale=self.base_scale,
            band=self.base_band,
            true_scale=self.base_true_scale,
        )
        return (one,)

    def with_files_in(self, folder: Path) -> Self:
        """The recipe with absolute names of files; a folder holds those that are relative."""

        def absolute(name: str) -> str:
            return str((folder / name).absolute())

        update: dict[str, object] = {
            name: absolute(value)
            for name in ("base_file", "cfa_file")
            if (value := getattr(self, name)) is not None
        }
        if self.bases:
            update["bases"] = tuple(
                base.model_copy(update={"file": absolute(base.file)}) for base in self.bases
            )
        return self.model_copy(update=update)


@dataclass(frozen=True, slots=True, eq=False)
class Layers:
    """A terrain and what it is made of, each layer's heights z down on the terrain's nodes.

    Attributes:
        base: Files and landforms.
        undulation: All scales together.
        slope: The constant slope.
        ground: Base, undulation and slope: the ground-slope map, without rocks.
        terrain: The ground with its rocks.
        datum_up_m: Elevation of SITE's z = 0 in the map of the first base file; None without one.
    """

    base: Grid
    undulation: Grid
    slope: Grid
    ground: Grid
    terrain: Terrain
    datum_up_m: float | None


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
    return generate_layers(recipe).terrain


def generate_layers(recipe: TerrainRecipe) -> Layers:
    """Make the terrain of a recipe and keep its layers."""
    count = round(recipe.size_m / recipe.resolution_m)
    axis_m = (np.arange(count, dtype=np.float64) - 0.5 * (count - 1)) * recipe.resolution_m
    base, datum_up_m = _base(recipe, axis_m)
    ground, undulation = base.copy(), np.zeros_like(base)
    for index, layer in enumerate(_undulation_of(recipe)):
        rng = rng_for(recipe.seed, f"undulation.{index}")
        heights = undulation_up_m(ground.shape, recipe.resolution_m, layer, rng)
        ground -= heights
        undulation -= heights
    slope = _slope_up_m(recipe, axis_m)
    ground -= slope
    surface, rocks = ground, no_rocks()
    if recipe.cfa or recipe.cfa_file is not None:
        surface, rocks = _with_rocks(recipe, ground, float(axis_m[0]))
    shape = (count, count)
    classes = class_map(recipe.classes, shape, recipe.resolution_m, recipe.seed)
    terrain = centred(
        surface.astype(np.float32),
        recipe.resolution_m,
        rocks,
        recipe.model_dump(mode="json"),
        classes,
    )
    return Layers(base, undulation, -slope, ground, terrain, datum_up_m)


def recipe_of(terrain: Terrain) -> TerrainRecipe | None:
    """The recipe of a terrain that was generated, also after it was stored and read back."""
    if terrain.recipe is None:
        return None
    return parse_model(json.dumps(terrain.recipe), "recipe", TerrainRecipe)


def _undulation_of(recipe: TerrainRecipe) -> tuple[Undulation, ...]:
    if recipe.undulation is not None:
        return recipe.undulation
    return () if recipe.base_files() else UNDULATION_DEFAULT


# z is down: the higher of two layers is the smaller
_COMBINED: dict[Combination, Callable[[Grid, Grid], Grid]] = {
    "add": np.add,
    "higher": np.minimum,
    "lower": np.maximum,
}


def _base(recipe: TerrainRecipe, axis_m: Grid) -> tuple[Grid, float | None]:
    """Base layer, z down, and the elevation of z = 0 in the first map."""
    parts: list[tuple[Combination, Grid]] = []
    datum_up_m: float | None = None
    for base in recipe.base_files():
        heights, middle_up_m = base_z_m(base, axis_m)
        datum_up_m = middle_up_m if datum_up_m is None else datum_up_m
        parts.append((base.combine, heights))
    forms = recipe.landforms if recipe.landform is None else (recipe.landform,)
    for index, form in enumerate(forms):
        rng = rng_for(recipe.seed, f"landform.{index}" if index else "landform")
        parts.append((form.combine, -landform_up_m(form, axis_m, axis_m, rng)))
    if not parts:
        return np.zeros((len(axis_m), len(axis_m))), None
    joined = reduce(lambda below, part: _COMBINED[part[0]](below, part[1]), parts[1:], parts[0][1])
    return joined, datum_up_m


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
    recipe: TerrainRecipe, ground: Grid, first_m: float
) -> tuple[Grid, npt.NDArray[np.void]]:
    field = _rock_field(recipe, ground.shape[0] * recipe.resolution_m)
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


def _rock_field(recipe: TerrainRecipe, size_m: float) -> RockField:
    local, cfa = None, recipe.cfa or 0.0
    if recipe.cfa_file is not None:
        bases = recipe.base_files()
        local = read_cfa(recipe.cfa_file, bases[0] if bases else None, 0.5 * size_m)
        cfa = float(local.values.max())
    limits_m = (recipe.rock_diameter_min_m, recipe.rock_diameter_max_m)
    rng = rng_for(recipe.seed, "rocks")
    # no rocks at all where the map says so: draw none rather than divide by nothing
    field = draw_rocks(max(cfa, 1e-9), *limits_m, (size_m, size_m), rng)
    if local is None:
        return field
    here = local.at(field.rocks["north_m"], field.rocks["east_m"])
    return thinned(field, max(cfa, 1e-9), here, rng_for(recipe.seed, "rocks.local_cfa"))
