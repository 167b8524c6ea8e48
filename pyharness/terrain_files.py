# SPDX-License-Identifier: Apache-2.0
"""Terrains made from recipes, as files."""

from collections.abc import Mapping
from pathlib import Path

from sim.config import load_model, parse_model
from sim.errors import TerrainError
from sim.generate import TerrainRecipe, generate
from sim.strict_yaml import write_tree
from sim.terrain import Terrain
from sim.terrain_io import SideCar, write_terrain


def generate_terrain(out: Path, recipe: Path | None, overrides: Mapping[str, object]) -> Terrain:
    """Make a terrain from a recipe file and overrides, and write it.

    Raises:
        SimError: The recipe is unusable, or the files cannot be written.
    """
    if out.suffix.lower() != ".pgm":
        raise TerrainError(f"{out}: expected a name ending in .pgm")
    terrain = generate(load_recipe(recipe, overrides))
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        write_terrain(terrain, out)
    except OSError as error:
        raise TerrainError(f"{error.filename or out}: {error.strerror}") from error
    return terrain


def load_recipe(path: Path | None, overrides: Mapping[str, object]) -> TerrainRecipe:
    """Read a recipe; the YAML file of a terrain holds one too.

    Files that a recipe names are looked for beside it.
    """
    if path is None:
        return parse_model("", "recipe", TerrainRecipe, overrides).with_files_in(Path())
    if not path.with_suffix(".pgm").is_file():
        return load_model(path, TerrainRecipe, overrides).with_files_in(path.parent)
    recipe = load_model(path, SideCar).recipe
    if recipe is None:
        raise TerrainError(f"{path}: the terrain was not made from a recipe")
    source = f"{path} (recipe)"
    return parse_model(write_tree(recipe), source, TerrainRecipe, overrides).with_files_in(
        path.parent
    )
