# SPDX-License-Identifier: Apache-2.0
"""The highway chart: where routes to the regions of interest run (SIM Fig. 5)."""

from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, LogNorm
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch, Rectangle
from scipy.ndimage import maximum_filter

from pyharness.map_style import draw_scale, hillshade, new_figure, save_png, with_style
from sim.orbital import OrbitalPlan

HEIGHT_IN = 8.8
CLOSED_COLOR, LANDING_COLOR, REGION_COLOR, PATCH_COLOR = "#7a1f1f", "#00c2ff", "#2bd94f", "#ffffff"
PATCHES_NUMBERED = 60
# a route one cell wide would vanish on a large map
LINE_CELLS = 200


def draw_highways(plan: OrbitalPlan, path: Path) -> None:
    """Write the chart as PNG."""
    ground, config = plan.ground, plan.config
    rows, cols = ground.up_m.shape
    half = [0.5 * cell_m for cell_m in ground.cell_m]
    extent = (
        float(ground.offset_m(0, 1)) - half[1], float(ground.offset_m(cols - 1, 1)) + half[1],
        float(ground.offset_m(0, 0)) - half[0], float(ground.offset_m(rows - 1, 0)) + half[0],
    )  # fmt: skip
    width_in = np.clip(HEIGHT_IN * (extent[1] - extent[0]) / (extent[3] - extent[2]), 5.0, 15.0)
    with with_style():
        figure = new_figure((float(width_in) + 3.6, HEIGHT_IN + 1.2))
        axes = figure.add_subplot()
        shade = hillshade(ground.up_m, ground.cell_m[0], 1.5)
        picture = np.repeat((0.30 + 0.55 * shade)[..., None], 3, axis=2)
        closed = ~np.isfinite(config.cost.per_m(ground.slope_rad, ground.cfa))
        picture[closed] = 0.55 * picture[closed] + 0.45 * np.array([0.48, 0.12, 0.12])
        picture[~np.isfinite(ground.up_m)] = 0.95
        axes.imshow(picture, origin="lower", extent=extent, interpolation="nearest")
        colors = ListedColormap(colormaps["inferno"](np.linspace(0.3, 1.0, 256)))
        share = plan.highways.likelihood
        width = max(1, round(max(rows, cols) / LINE_CELLS))
        thick = maximum_filter(share, size=width) if width > 1 else share
        norm = LogNorm(1.0 / len(plan.highways.routes), 1.0)
        lines = np.ma.masked_less_equal(thick, 0.0)
        axes.imshow(
            lines, origin="lower", extent=extent, cmap=colors, norm=norm, interpolation="nearest"
        )
        bar = figure.colorbar(
            ScalarMappable(norm, colors), ax=axes, location="bottom", shrink=0.7, pad=0.015,
            aspect=45,
        )  # fmt: skip
        bar.set_label(f"share of {len(plan.highways.routes)} routes that cross a place")
        north, east = np.array(config.landing_points_m).T
        axes.plot(east, north, "v", color=LANDING_COLOR, markersize=5, markeredgecolor="black",
                  markeredgewidth=0.4)  # fmt: skip
        for region in config.regions:
            n, e = region.center_m
            radius_m = max(region.radius_m, 0.006 * (extent[1] - extent[0]))
            axes.add_patch(Circle((e, n), radius_m, fill=False, edgecolor="black", linewidth=2.8))
            axes.add_patch(
                Circle((e, n), radius_m, fill=False, edgecolor=REGION_COLOR, linewidth=1.6)
            )
        half_m = 0.5 * config.size_m
        for index, cell in enumerate(plan.cells):
            n, e = float(ground.offset_m(cell[0], 0)), float(ground.offset_m(cell[1], 1))
            corner = (e - half_m, n - half_m)
            axes.add_patch(
                Rectangle(corner, config.size_m, config.size_m, fill=False,
                          edgecolor=PATCH_COLOR, linewidth=1.1, alpha=0.9)
            )  # fmt: skip
            if len(plan.cells) <= PATCHES_NUMBERED:
                axes.annotate(
                    str(index), (e, n), ha="center", va="center", fontsize=7, color="black",
                    bbox={"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 0.8},
                )  # fmt: skip
        axes.set(xlim=extent[:2], ylim=extent[2:], aspect="equal")
        axes.set(xlabel="east of the middle of the map, m", ylabel="north, m")
        draw_scale(axes, extent)
        axes.set_title(f"highway chart of {Path(config.dem).name}", fontweight="bold", pad=16)
        closed_label = (
            f"not driven on: over {config.cost.slope_max_deg:g} deg,\n"
            f"or CFA over {100 * config.cost.cfa_max:g} %"
        )
        handles = [
            Line2D([], [], color=LANDING_COLOR, marker="v", linestyle="", markeredgecolor="black",
                   label=f"landing point ({len(config.landing_points_m)})"),
            Line2D([], [], color=REGION_COLOR, marker="o", fillstyle="none", linestyle="",
                   label=f"region of interest ({len(config.regions)})"),
            Patch(facecolor="0.6", edgecolor="white",
                  label=f"patch of {config.size_m:g} m ({len(plan.cells)})"),
            Patch(facecolor=CLOSED_COLOR, alpha=0.7, label=closed_label),
        ]  # fmt: skip
        axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.02, 1.0),
                    borderaxespad=0.0, facecolor="0.85")  # fmt: skip
        save_png(figure, path)
