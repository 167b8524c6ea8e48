# SPDX-License-Identifier: Apache-2.0
"""`enav terrain stereo-noise`: what the errors of the cameras do to the heightmap."""

import math
from pathlib import Path

import click

from pyharness.cli_types import Numbers
from pyharness.errors import HarnessError

FILE = click.Path(path_type=Path)
AZIMUTHS_DEG = (-75.0, 0.0, 75.0)
SIGMAS_PX = (0.0, 1.0, 10.0)


@click.command("stereo-noise")
@click.argument("file", type=FILE, required=False)
@click.option("--at", type=Numbers("N,E,YAW_DEG"), help="Where the rover stands (0,0,0).")
@click.option(
    "--sigma-px", type=float, multiple=True, help="Disparity sigma; may be repeated (0, 1 and 10)."
)
@click.option("--camera", type=click.Choice(["navcam", "pinhole"]), default="navcam")
@click.option("--seed", type=int, default=0, help="Of the noise, and of the terrain made.")
@click.option("-o", "out", type=FILE, default=Path("stereo_noise.png"), help="PNG to write.")
def stereo_noise(
    file: Path | None,
    at: list[float] | None,
    sigma_px: tuple[float, ...],
    camera: str,
    seed: int,
    out: Path,
) -> int:
    """Draw the heightmap that the rover would make without and with stereo error (SIM Fig. 8).

    On the terrain FILE, or on a made one with CFA 7 %. The top row shows heights, the bottom row
    what is wrong with them.
    """
    from pyharness.stereo_noise_picture import draw_stereo_noise
    from sim.camera import CameraConfig
    from sim.generate import TerrainRecipe, generate
    from sim.random_streams import SEED_MAX
    from sim.terrain_io import read_terrain

    if out.suffix.lower() != ".png":
        raise HarnessError(f"{out}: expected a name ending in .png")
    for sigma in sigma_px:
        if not 0 <= sigma <= 100:
            raise HarnessError(f"--sigma-px: expected 0 to 100, got {sigma:g}")
    if not 0 <= seed <= SEED_MAX:
        raise HarnessError(f"--seed: expected >= 0, got {seed}")
    north_m, east_m, yaw_deg = at or (0.0, 0.0, 0.0)
    if not all(math.isfinite(number) for number in (north_m, east_m, yaw_deg)):
        raise HarnessError("--at: expected finite numbers")
    if file is None:
        terrain = generate(TerrainRecipe(size_m=60, cfa=0.07, seed=seed), clear=(0.0, 0.0, 0.0))
    else:
        terrain = read_terrain(file)
    config = CameraConfig.model_validate({"model": camera, "azimuths_deg": AZIMUTHS_DEG})
    place = (north_m, east_m, math.radians(yaw_deg))
    draw_stereo_noise(terrain, place, config, sigma_px or SIGMAS_PX, seed, out)
    click.echo(f"{out}")
    return 0
