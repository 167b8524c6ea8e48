# SPDX-License-Identifier: Apache-2.0
"""Achieved rock cover against the Golombek-Rapp law."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.ticker import PercentFormatter, ScalarFormatter

from pyharness.map_style import Grid, new_figure, save_png, with_style
from sim.errors import TerrainError
from sim.random_streams import rng_for
from sim.rocks import achieved_area_fraction, area_fraction, draw_rocks
from sim.terrain import Terrain

DIAMETERS_M = np.array([0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.85, 0.92, 1.1, 1.3, 1.6])
COLORS = ("#1b6ca8", "#e07a1f", "#2e8b57", "#b5338a", "#6b4fa0", "#8a6d3b")
LIMITS_M = (0.1, 2.0)
SIZE_M = 120.0
TOLERANCE, TOLERANCE_TO_M = 0.05, 0.7


@dataclass(frozen=True, slots=True, eq=False)
class Cover:
    """Cover achieved by the rocks of one or more terrains of one CFA.

    Attributes:
        label: What they are.
        cfa: Asked for.
        limits_m: Smallest and largest diameter.
        area_m2: Of all terrains together.
        diameters_m: Of all their rocks.
        terrains: How many.
    """

    label: str
    cfa: float
    limits_m: tuple[float, float]
    area_m2: float
    diameters_m: npt.NDArray[np.float64]
    terrains: int

    @property
    def achieved(self) -> Grid:
        """Share of the ground under rocks of at least each of DIAMETERS_M."""
        return achieved_area_fraction(self.diameters_m, self.area_m2, DIAMETERS_M)

    @property
    def law(self) -> Grid:
        """What the law gives rocks between each diameter and the largest one made."""
        law = area_fraction(self.cfa, DIAMETERS_M) - area_fraction(self.cfa, self.limits_m[1])
        return np.maximum(law, 0.0)

    @property
    def sigma(self) -> Grid:
        """Standard deviation of the achieved share by the chance of counting rocks."""
        ordered = np.sort(self.diameters_m)
        fourth = np.concatenate([[0.0], np.cumsum((0.25 * math.pi * ordered**2)[::-1] ** 2)])
        count = len(ordered) - np.searchsorted(ordered, DIAMETERS_M)
        result: Grid = np.sqrt(fourth[count]) / self.area_m2
        return result


def covers_of_draws(cfas: Sequence[float], seeds: int) -> list[Cover]:
    """Rocks of standard terrains, drawn without making the terrains."""
    covers = []
    for cfa in cfas:
        drawn = [
            draw_rocks(cfa, *LIMITS_M, (SIZE_M, SIZE_M), rng_for(seed, "rocks")).rocks["diameter_m"]
            for seed in range(seeds)
        ]
        label = f"{100 * cfa:g} %, {seeds} seeds"
        area_m2 = seeds * SIZE_M**2
        covers.append(Cover(label, cfa, LIMITS_M, area_m2, np.concatenate(drawn), seeds))
    return covers


def cover_of_terrain(terrain: Terrain, name: str) -> Cover:
    """Rocks of a terrain that was made with one CFA."""
    recipe = terrain.recipe or {}
    cfa = recipe.get("cfa")
    if not cfa:
        raise TerrainError(f"{name}: not made with a CFA, expected a terrain with a recipe and cfa")
    limits_m = (recipe["rock_diameter_min_m"], recipe["rock_diameter_max_m"])
    area_m2 = terrain.z_site_m.size * terrain.resolution_m**2
    label = f"{name}, {100 * cfa:g} %"
    return Cover(label, cfa, limits_m, area_m2, terrain.rocks["diameter_m"].copy(), 1)


def draw_cfa(covers: Sequence[Cover], path: Path) -> None:
    """Cumulative fractional area by diameter with the law, and their ratio."""
    with with_style():
        figure = new_figure((9.0, 9.0))
        top, low = figure.subplots(2, 1, sharex=True, height_ratios=[3, 2])
        for index, cover in enumerate(covers):
            _draw_cover(top, low, cover, COLORS[index % len(COLORS)])
        top.plot([], [], "-", color="0.3", label="law: k exp(-q D), q = 1.79 + 0.152 / k")
        top.plot([], [], "--", color="0.3", label="law less the rocks over the largest made")
        top.set(yscale="log", ylabel="share of the ground under rocks of at least D")
        top.yaxis.set_major_formatter(PercentFormatter(1.0, decimals=3))
        top.set_title("rock cover by diameter (Golombek and Rapp)", loc="left", fontweight="bold")
        top.legend()
        low.fill_between([LIMITS_M[0], TOLERANCE_TO_M], 1 - TOLERANCE, 1 + TOLERANCE,
                         color="0.88", label="5 %, 0.1 to 0.7 m", zorder=0)  # fmt: skip
        low.axhline(1.0, color="0.3", linewidth=0.8)
        low.set(xscale="log", xlabel="diameter D, m", ylabel="achieved / law", ylim=(0.6, 1.4))
        low.legend(loc="upper left")
        low.set_xticks([0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0])
        low.xaxis.set_major_formatter(ScalarFormatter())
        low.xaxis.set_minor_formatter(lambda *_: "")
        for axes in (top, low):
            axes.grid(which="both", color="0.9", linewidth=0.5)
            axes.set_axisbelow(True)
        low.set_title("bars: 3 sigma of counting", loc="right", fontsize=8)
        save_png(figure, path)


def _draw_cover(top: Axes, low: Axes, cover: Cover, color: str) -> None:
    fine_m = np.geomspace(*cover.limits_m, 200)
    law = area_fraction(cover.cfa, fine_m)
    top.plot(fine_m, law, "-", color=color, linewidth=1.0)
    cut = law - area_fraction(cover.cfa, cover.limits_m[1])
    top.plot(fine_m[:-1], cut[:-1], "--", color=color, linewidth=0.9)
    seen = (cover.achieved > 0) & (cover.limits_m[0] <= DIAMETERS_M)
    diameter, achieved, sigma = DIAMETERS_M[seen], cover.achieved[seen], 3 * cover.sigma[seen]
    bars: dict[str, Any] = {
        "fmt": "o",
        "color": color,
        "markersize": 4,
        "capsize": 2,
        "linewidth": 0.9,
    }
    top.errorbar(diameter, achieved, np.minimum(sigma, 0.99 * achieved), label=cover.label, **bars)
    ratio = cover.law[seen]
    low.errorbar(diameter, achieved / ratio, sigma / ratio, **bars)
