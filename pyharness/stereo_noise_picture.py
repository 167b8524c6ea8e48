# SPDX-License-Identifier: Apache-2.0
"""What stereo error does to the heightmap (SIM Fig. 8): Navlib's map, noise by noise."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.patches import Polygon

from pyharness.clib import ffi
from pyharness.dp import Kind, new_message
from pyharness.map_style import Grid, hillshade, new_figure, relief, save_png, with_style
from pyharness.messages import Pose6, cloud_requests
from pyharness.navlib import Navlib
from pyharness.params import param_values
from sim.camera import CameraConfig, StereoCamera
from sim.errors import TerrainError
from sim.random_streams import rng_for
from sim.settle import SettledState, Settler
from sim.terrain import Terrain
from sim.vehicle import load_vehicle

PANEL_IN = 4.1
UNKNOWN_M = 1e8
ERROR_SHOWN_M = 0.5
ROVER_M = ((1.2, 0.0), (-1.0, -0.8), (-0.6, 0.0), (-1.0, 0.8))
BANDS_M = ((2.0, 5.0), (5.0, 10.0), (10.0, 15.0))
TEXT_BOX = {"facecolor": "white", "alpha": 0.85, "edgecolor": "none", "pad": 2.5}


@dataclass(frozen=True, slots=True, eq=False)
class Heightmap:
    """Heights (up) of the known cells, row 0 south, and the true ones, relative to the rover."""

    sigma_px: float
    up_m: Grid
    true_up_m: Grid
    range_m: Grid
    cell_m: float


def draw_stereo_noise(
    terrain: Terrain,
    place: tuple[float, float, float],
    config: CameraConfig,
    sigmas_px: Sequence[float],
    seed: int,
    path: Path,
) -> list[Heightmap]:
    """Draw the heightmap and its error for every sigma of the matching, in pixels.

    Args:
        terrain: The true ground.
        place: North, east and yaw of the rover.
        config: The cameras; their own disparity sigma is replaced.
        sigmas_px: Standard deviations of the disparity.
        seed: Of the noise.
        path: PNG to write.

    Raises:
        TerrainError: The rover cannot stand there, or the picture cannot be written.
    """
    vehicle = load_vehicle()
    state = Settler(terrain, vehicle).settle(*place)
    if not state.on_map:
        raise TerrainError(f"the rover cannot stand at {place[0]:g}, {place[1]:g}: no ground")
    maps = []
    for sigma_px in sigmas_px:
        noisy = config.model_copy(update={"disparity_sigma_px": sigma_px})
        camera = StereoCamera(terrain, vehicle, noisy)
        cloud = camera.image(state, rng_for(seed, "camera"))
        maps.append(_heightmap(terrain, state, cloud, sigma_px))
    with with_style():
        _draw(maps, state, path)
    return maps


def _heightmap(terrain: Terrain, state: SettledState, cloud: Any, sigma_px: float) -> Heightmap:
    """Navlib's heightmap after one imaging at a perfectly known pose."""
    navlib = Navlib(param_values({}))
    pose = Pose6(state.x_m, state.y_m, state.z_m, state.roll_rad, state.pitch_rad, state.yaw_rad)
    for chunk in cloud_requests(0.0, pose, 1, cloud):
        navlib.process_disparity(chunk)
        list(navlib.drain())
    request = new_message(Kind.ANALYZE_TERRAIN_IN)
    for name, value in (("x_site_m", pose.x_m), ("y_site_m", pose.y_m), ("z_site_m", pose.z_m)):
        request["pose"][name] = value
    navlib.analyze_terrain(request)
    list(navlib.drain())
    surface = navlib.context.surface
    z_m = np.frombuffer(ffi.buffer(surface.z_site_m), dtype=np.float32).astype(np.float64)
    size = math.isqrt(len(z_m))
    z_m = z_m.reshape(size, size)
    middle = np.arange(size) + 0.5
    north_m = (surface.origin_row + middle)[:, None] * surface.cell_m
    east_m = (surface.origin_col + middle)[None, :] * surface.cell_m
    return Heightmap(
        sigma_px,
        np.where(z_m > UNKNOWN_M, np.nan, state.z_m - z_m),
        state.z_m - terrain.height_at(*np.broadcast_arrays(north_m, east_m)),
        np.hypot(north_m - state.x_m, east_m - state.y_m),
        float(surface.cell_m),
    )


def _draw(maps: Sequence[Heightmap], state: SettledState, path: Path) -> None:
    """Heights above, errors below, one column for each sigma."""
    figure = new_figure((PANEL_IN * len(maps) + 1.2, 2 * PANEL_IN + 0.9))
    axes: Any = figure.subplots(2, len(maps), sharex=True, sharey=True, squeeze=False)
    known = np.concatenate([one.true_up_m[np.isfinite(one.up_m)] for one in maps])
    low, high = np.percentile(known, (0.5, 99.5)) if len(known) else (-1.0, 1.0)
    height_norm = Normalize(float(low) - 0.05, float(high) + 0.05)
    error_norm = Normalize(-ERROR_SHOWN_M, ERROR_SHOWN_M)
    height_colors, error_colors = mpl.colormaps["viridis"], mpl.colormaps["RdBu_r"]
    for column, one in enumerate(maps):
        shade = hillshade(one.up_m, one.cell_m) if np.isfinite(one.up_m).any() else None
        shade = np.full_like(one.up_m, 0.7) if shade is None else shade
        _panel(axes[0, column], relief(one.up_m, height_colors, height_norm, shade), one, state)
        error = relief(
            one.up_m - one.true_up_m, error_colors, error_norm, np.full_like(one.up_m, 0.714)
        )
        _panel(axes[1, column], error, one, state)
        name = "no noise" if one.sigma_px == 0.0 else f"{one.sigma_px:g} px"
        axes[0, column].set_title(rf"Disparity $\sigma$: {name}", fontsize=11)
        axes[1, column].text(
            0.03, 0.03, _error_text(one), transform=axes[1, column].transAxes, fontsize=8,
            family="DejaVu Sans Mono", va="bottom", bbox=TEXT_BOX,
        )  # fmt: skip
        axes[1, column].set_xlabel("east of the rover (m)")
    for row, label in ((0, "north of the rover (m)"), (1, "north of the rover (m)")):
        axes[row, 0].set_ylabel(label)
    figure.colorbar(
        ScalarMappable(height_norm, height_colors), ax=axes[0], label="height above the rover (m)"
    )
    figure.colorbar(
        ScalarMappable(error_norm, error_colors), ax=axes[1], extend="both",
        label="error of the height (m)",
    )  # fmt: skip
    figure.suptitle("Navlib's heightmap after one look around; grey is unknown", fontsize=12)
    save_png(figure, path)


def _panel(axes: Axes, picture: Grid, one: Heightmap, state: SettledState) -> None:
    half_m = 0.5 * len(one.up_m) * one.cell_m
    axes.imshow(
        picture, origin="lower", extent=(-half_m, half_m, -half_m, half_m), interpolation="nearest"
    )
    cosine, sine = math.cos(state.yaw_rad), math.sin(state.yaw_rad)
    corners = [(sine * x + cosine * y, cosine * x - sine * y) for x, y in ROVER_M]
    axes.add_patch(Polygon(corners, facecolor="#ff2fd0", edgecolor="black", linewidth=0.8))


def _error_text(one: Heightmap) -> str:
    """Root mean square of the errors by distance."""
    error_m = one.up_m - one.true_up_m
    lines = ["RMS error of a cell"]
    for near_m, far_m in BANDS_M:
        chosen = np.isfinite(error_m) & (one.range_m >= near_m) & (one.range_m < far_m)
        rms = f"{math.sqrt(np.mean(error_m[chosen] ** 2)):6.3f} m" if chosen.any() else "     -"
        lines.append(f"{near_m:2g} to {far_m:2g} m: {rms}")
    return "\n".join(lines)
