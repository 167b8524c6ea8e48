# SPDX-License-Identifier: Apache-2.0
"""What pictures of terrain have in common: relief, slope, scale bar, north arrow."""

import math
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import Colormap, LightSource, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from scipy.ndimage import convolve1d

from sim.errors import TerrainError

STYLE: Any = {"font.family": "DejaVu Sans", "font.size": 9, "svg.hashsalt": "enav"}
DPI = 130

Grid = npt.NDArray[np.float64]
Extent = tuple[float, float, float, float]


def new_figure(size_in: tuple[float, float]) -> Figure:
    """Figure that needs no display."""
    figure = Figure(figsize=size_in, dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def save_png(figure: Figure, path: Path) -> None:
    """Write a PNG, the same bytes for the same picture."""
    try:
        with path.open("wb") as file:
            figure.savefig(file, format="png", metadata={"Software": None})
    except OSError as error:
        raise TerrainError(f"{path}: cannot be written: {error.strerror or error}") from None


def hillshade(up_m: Grid, cell_m: float, exaggeration: float = 1.0) -> Grid:
    """Brightness 0..1 of heights, row 0 south, with the sun in the north-west."""
    filled = np.where(np.isfinite(up_m), up_m, np.nanmean(up_m))
    light = LightSource(azdeg=315, altdeg=45)
    shade = light.hillshade(filled[::-1], vert_exag=exaggeration, dx=cell_m, dy=cell_m)
    result: Grid = np.asarray(shade, dtype=np.float64)[::-1]
    return result


def relief(values: Grid, colors: Colormap, norm: Normalize, shade: Grid) -> Grid:
    """Colours of values, darkened and lightened by the shade; holes are grey."""
    rgb = np.asarray(colors(norm(values)), dtype=np.float64)[..., :3]
    lit = np.clip(rgb * (0.25 + 1.05 * shade[..., None]), 0.0, 1.0)
    result: Grid = np.where(np.isfinite(values)[..., None], lit, 0.55)
    return result


def slope_deg(up_m: Grid, cell_m: float, window_m: float) -> Grid:
    """Slope of the least-squares plane through a square window around every node."""
    half = max(1, round(0.5 * window_m / cell_m))
    offset_m = np.arange(-half, half + 1) * cell_m
    ones = np.ones_like(offset_m) / len(offset_m)
    gains = offset_m[::-1] / float(offset_m @ offset_m)  # convolution turns the kernel round
    gradients = [
        convolve1d(convolve1d(up_m, gains, axis=axis, mode="nearest"), ones, axis=1 - axis)
        for axis in (0, 1)
    ]
    # beyond the edge there is no ground to fit: repeat the last full fit
    inner = [slice(half, size - half) if size > 2 * half else slice(None) for size in up_m.shape]
    steep = np.degrees(np.arctan(np.hypot(*gradients)))[inner[0], inner[1]]
    pads = [(half, half) if size > 2 * half else (0, 0) for size in up_m.shape]
    result: Grid = np.pad(steep, pads, mode="edge")
    return result


def draw_scale(axes: Axes, extent: Extent, color: str = "black") -> None:
    """Bar of a round length and an arrow to the north, below and outside the map."""
    west_m, east_m, _, _ = extent
    width_m = east_m - west_m
    length_m = 10.0 ** math.floor(math.log10(width_m / 4))
    length_m *= max(step for step in (1, 2, 5) if step * length_m <= width_m / 4)
    share = length_m / width_m
    for part, face in ((0, color), (1, "white")):
        axes.add_patch(
            Rectangle(
                (part * share / 2, 1.012), share / 2, 0.009, transform=axes.transAxes,
                facecolor=face, edgecolor=color, linewidth=0.7, clip_on=False,
            )
        )  # fmt: skip
    axes.text(share + 0.01, 1.016, f"{length_m:g} m", transform=axes.transAxes, va="center")
    axes.annotate(
        "N", (0.985, 1.055), (0.985, 1.005), xycoords="axes fraction", ha="center", va="bottom",
        fontsize=8, annotation_clip=False,
        arrowprops={"arrowstyle": "-|>", "color": color, "shrinkA": 0, "shrinkB": 0},
    )  # fmt: skip


def with_style() -> Any:
    """Context in which pictures are drawn."""
    return mpl.rc_context(STYLE)
