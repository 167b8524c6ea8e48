# SPDX-License-Identifier: Apache-2.0
"""Many terrains, made by several processes; one that is there already is not made again."""

import multiprocessing
import signal
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pyharness.errors import HarnessError
from sim.config import load_model
from sim.errors import SimError, TerrainError
from sim.generate import TerrainRecipe, generate_layers
from sim.terrain_io import SideCar, rocks_path, write_terrain


@dataclass(frozen=True, slots=True)
class Job:
    """A terrain to make, and where on a planet it comes from."""

    path: Path
    recipe: TerrainRecipe
    origin: dict[str, Any] | None = None


Done = Callable[[Job, bool], None]


def make_terrains(jobs: Sequence[Job], workers: int, on_done: Done) -> None:
    """Make what is missing.

    Every file is written whole or not at all and the side-car last, so that a run that was stopped
    at any moment goes on where it was.

    Args:
        jobs: What is wanted.
        workers: Processes.
        on_done: Called with each terrain, and whether it was made now.

    Raises:
        SimError: A recipe is unusable, or another terrain lies where one should go.
        HarnessError: A process died.
    """
    missing = []
    for job in jobs:
        if is_finished(job):
            on_done(job, False)
        else:
            missing.append(job)
    if workers <= 1 or len(missing) <= 1:
        for job in missing:
            make_terrain_of(job)
            on_done(job, True)
        return
    pool = ProcessPoolExecutor(
        min(workers, len(missing)), multiprocessing.get_context("spawn"), _ignore_interrupt
    )
    try:
        futures = {pool.submit(make_terrain_of, job): job for job in missing}
        for future in as_completed(futures):
            future.result()
            on_done(futures[future], True)
    except BrokenProcessPool:
        raise HarnessError(
            "a process that makes terrains died (out of memory?); what was finished is kept:"
            " the same command goes on"
        ) from None
    finally:
        pool.shutdown(cancel_futures=True)


def make_terrain_of(job: Job) -> None:
    """Make and write one terrain."""
    layers = generate_layers(job.recipe)
    origin = job.origin
    if origin is not None and layers.datum_up_m is not None:
        origin = {**origin, "elevation_m": round(layers.datum_up_m, 4)}
    write_terrain(layers.terrain, job.path, origin)


def is_finished(job: Job) -> bool:
    """Whether the terrain is there, whole and of this recipe."""
    side_car_path = job.path.with_suffix(".yaml")
    if not side_car_path.exists():
        return False
    try:
        side_car = load_model(side_car_path, SideCar)
    except SimError as error:
        raise TerrainError(str(error).splitlines()[0]) from None
    if side_car.recipe != job.recipe.model_dump(mode="json"):
        raise TerrainError(
            f"{side_car_path}: made from another recipe, expected an empty folder or the same set"
        )
    size = 2 * side_car.rows * side_car.cols
    is_whole = job.path.is_file() and job.path.stat().st_size > size
    return is_whole and rocks_path(job.path).is_file()


def _ignore_interrupt() -> None:
    """Leave Ctrl-C to the parent, which lets the terrains in hand be finished."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
