# SPDX-License-Identifier: Apache-2.0
"""The standard set of terrains: slopes x rock densities x seeds (SIM, Monte Carlo)."""

import os
from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, model_validator

from pyharness.terrain_batch import Done, Job, make_terrains
from sim.config import ConfigModel, dump_model, load_model
from sim.errors import TerrainError
from sim.generate import TerrainRecipe
from sim.random_streams import SEED_MAX
from sim.rocks import CFA_MAX
from sim.terrain_io import write_atomic

SET_FILE, INDEX_FILE = "set.yaml", "terrains.csv"
INDEX_HEADER = "file,slope_deg,cfa,seed"
START_M = (-40.0, 0.0)
COUNT_MAX = 1_000_000


class TerrainSet(ConfigModel):
    """A grid of terrains.

    Attributes:
        slopes_deg: Constant slopes; their azimuth is drawn per seed.
        cfas: Rock densities.
        count: Terrains in all; every cell of the grid gets the same seeds, one after the other.
        first_seed: The lowest one.
        recipe: What all have in common.
    """

    slopes_deg: tuple[float, ...] = (0.0, 5.0, 10.0, 15.0, 20.0)
    cfas: tuple[Annotated[float, Field(ge=0, le=CFA_MAX)], ...] = (0.07, 0.10, 0.12, 0.15)
    count: Annotated[int, Field(ge=1, le=COUNT_MAX)] = 1200
    first_seed: Annotated[int, Field(ge=0, le=SEED_MAX - COUNT_MAX)] = 0
    recipe: TerrainRecipe = TerrainRecipe()

    @model_validator(mode="after")
    def _check(self) -> Self:
        for name, values in (("slopes_deg", self.slopes_deg), ("cfas", self.cfas)):
            if not values:
                raise ValueError(f"{name}: expected at least one value")
            if len(set(values)) != len(values):
                raise ValueError(f"{name}: a value is given twice")
        return self


def set_jobs(wanted: TerrainSet, folder: Path) -> list[Job]:
    """The terrains of a set, seed by seed: a larger count only adds to a smaller one."""
    cells = [(slope, cfa) for slope in wanted.slopes_deg for cfa in wanted.cfas]
    base = wanted.recipe
    if base.start_m is None and max(map(abs, START_M)) < 0.5 * base.size_m:
        base = base.model_copy(update={"start_m": START_M})
    jobs = []
    for index in range(wanted.count):
        slope_deg, cfa = cells[index % len(cells)]
        seed = wanted.first_seed + index // len(cells)
        update = {"slope_deg": slope_deg, "cfa": cfa, "seed": seed}
        recipe = TerrainRecipe.model_validate({**dict(base), **update})
        name = f"slope{slope_deg:02g}-cfa{round(100 * cfa, 6):02g}-seed{seed:04d}.pgm"
        jobs.append(Job(folder / name, recipe))
    return jobs


def make_set(wanted: TerrainSet, folder: Path, workers: int, on_done: Done) -> list[Job]:
    """Make a set, or what is missing of it."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise TerrainError(f"{folder}: cannot be made: {error.strerror}") from None
    _check_same(wanted, folder)
    jobs = set_jobs(wanted, folder)
    write_atomic(folder / SET_FILE, dump_model(wanted).encode())
    make_terrains(jobs, workers, on_done)
    rows = [
        f"{job.path.name},{job.recipe.slope_deg:g},{job.recipe.cfa:g},{job.recipe.seed}"
        for job in jobs
    ]
    write_atomic(folder / INDEX_FILE, "\n".join([INDEX_HEADER, *rows, ""]).encode())
    return jobs


def _check_same(wanted: TerrainSet, folder: Path) -> None:
    path = folder / SET_FILE
    if not path.exists():
        if any(folder.glob("*.pgm")):
            raise TerrainError(f"{folder}: holds other terrains, expected an empty folder or a set")
        return
    before = load_model(path, TerrainSet)
    if before.model_copy(update={"count": wanted.count}) != wanted:
        raise TerrainError(f"{path}: another set, expected the same one or an empty folder")
    if wanted.count < before.count:
        raise TerrainError(f"{path}: a set of {before.count}, expected a count of at least that")


def workers_default() -> int:
    """One process for every processor this one may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
