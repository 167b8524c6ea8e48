# SPDX-License-Identifier: Apache-2.0
"""Patches along the highways of an orbital map, as files."""

from pathlib import Path

import numpy as np

from pyharness.highway_picture import draw_highways
from pyharness.terrain_batch import Done, Job, make_terrains
from sim.config import dump_model, load_model
from sim.errors import TerrainError
from sim.orbital import OrbitalConfig, OrbitalPlan, plan_orbital
from sim.raster import geotiff
from sim.terrain_io import write_atomic

CONFIG_FILE, INDEX_FILE = "orbital.yaml", "patches.csv"
CHART_PNG, CHART_TIFF = "highways.png", "highways.tif"
CHART_BANDS = ["share of routes", "slope, deg", "CFA"]
INDEX_KEYS = (
    "pixel_line", "pixel_sample", "map_x", "map_y", "longitude_deg", "latitude_deg",
    "slope_mean_deg", "cfa_mean",
)  # fmt: skip


def make_orbital(config: OrbitalConfig, folder: Path, workers: int, on_done: Done) -> OrbitalPlan:
    """Write the highway chart and the patches; what is there already is not made again.

    The configuration is written with the landing points and regions that were drawn: run again
    from it, the same files come.
    """
    config = with_absolute_files(config, Path())
    plan = plan_orbital(config)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise TerrainError(f"{folder}: cannot be made: {error.strerror}") from None
    path = folder / CONFIG_FILE
    if path.exists():
        same = load_model(path, OrbitalConfig).model_copy(update={"count": config.count})
        if same != plan.config:
            raise TerrainError(f"{path}: of another run, expected the same or an empty folder")
    jobs = [
        Job(folder / f"patch-{index:04d}.pgm", recipe, origin)
        for index, (recipe, origin) in enumerate(zip(plan.recipes, plan.origins, strict=True))
    ]
    write_atomic(path, dump_model(plan.config).encode())
    write_atomic(folder / CHART_TIFF, chart_geotiff(plan))
    draw_highways(plan, folder / CHART_PNG)
    make_terrains(jobs, workers, on_done)
    write_atomic(folder / INDEX_FILE, _index(jobs).encode())
    return plan


def with_absolute_files(config: OrbitalConfig, folder: Path) -> OrbitalConfig:
    """The configuration with absolute names of files; a folder holds those that are relative."""
    update = {
        name: str((folder / value).absolute())
        for name in ("dem", "cfa_file")
        if (value := getattr(config, name)) is not None
    }
    return config.model_copy(update=update)


def chart_geotiff(plan: OrbitalPlan) -> bytes:
    """Share of routes, slope and CFA of every cell; where there is no ground, no data."""
    ground = plan.ground
    holes = ~np.isfinite(ground.up_m)
    bands = [plan.highways.likelihood, np.degrees(ground.slope_rad), ground.cfa]
    values = np.stack([np.where(holes, np.nan, band) for band in bands]).astype(np.float32)
    return geotiff(values, ground.place, CHART_BANDS)


def _index(jobs: list[Job]) -> str:
    lines = [",".join(("file", "seed", *INDEX_KEYS))]
    for job in jobs:
        origin = job.origin or {}
        values = [str(origin.get(key, "")) for key in INDEX_KEYS]
        lines.append(",".join((job.path.name, str(job.recipe.seed), *values)))
    return "\n".join([*lines, ""])
