# SPDX-License-Identifier: Apache-2.0
"""Figures of a report as SVG, the same bytes for the same numbers."""

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import matplotlib as mpl
import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

WIDTH_IN = 6.5
MARGIN_AXES = (0.08, 0.21, 0.84, 0.68)
STYLE: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 7.5,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "hatch.linewidth": 0.5,
    "svg.hashsalt": "enav",
    "svg.fonttype": "path",
}

# Okabe and Ito's colours, which the colour-blind can tell apart
BLUE, SKY, GREEN, ORANGE, VERMILION, PURPLE, YELLOW = (
    "#0072b2", "#56b4e9", "#009e73", "#e69f00", "#d55e00", "#cc79a7", "#f0e442",
)  # fmt: skip
GREY, DARK = "#c9d1d8", "#37424d"
REACHED_COLOR = "#dbe6ee"
OUTCOME_COLORS: Mapping[str, str] = {
    "goal_reached": REACHED_COLOR,
    "arcs_driven": REACHED_COLOR,
    "no_path": BLUE,
    "unsafe_arc": SKY,
    "limit_violation": VERMILION,
    "kioz_violation": PURPLE,
    "stuck": ORANGE,
    "time_limit": YELLOW,
    "left_map": GREEN,
    "planner_error": "#7f7f7f",
    "crashed": "#000000",
    "timed_out": "#5a3e85",
    "killed": "#8c510a",
}


def _svg(figure: Figure) -> bytes:
    file = io.BytesIO()
    figure.savefig(file, format="svg", metadata={"Date": None, "Creator": None})
    return file.getvalue()


# ------------------------------------------------------------------ margins


@dataclass(frozen=True, slots=True)
class LimitLine:
    """A vertical line: what it is called, where it stands, and whether it is the true limit."""

    name: str
    value: float
    is_true: bool


@dataclass(frozen=True, slots=True)
class Distribution:
    """Time steps by the value of a quantity, in the unit that is shown.

    Attributes:
        title: Of the axis, with the unit.
        unit: Of the extreme value.
        edges: Of the bins [n + 1].
        counts: Steps in each bin [n].
        below: Steps under the first edge.
        above: Steps over the last one.
        extreme: The worst value.
        extreme_name: What it is called.
        limits: Lines.
    """

    title: str
    unit: str
    edges: npt.NDArray[np.float64]
    counts: npt.NDArray[np.int64]
    below: int
    above: int
    extreme: float
    extreme_name: str
    limits: Sequence[LimitLine]


def margin_figure(shown: Distribution) -> bytes:
    """Draw a histogram with its cumulative curve, limits and the extreme value."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH_IN, 1.75))
        axes = figure.add_axes(MARGIN_AXES)
        axes.set_yscale("log")
        used = shown.counts > 0
        axes.bar(
            shown.edges[:-1][used], shown.counts[used], np.diff(shown.edges)[used], align="edge",
            color=GREY, edgecolor="none",
        )  # fmt: skip
        largest = max(int(shown.counts.max(initial=1)), 1)
        axes.set_ylim(0.7, largest * 2.0)
        axes.set_xlim(*window(shown))
        axes.set_xlabel(shown.title)
        axes.set_ylabel("steps of 1/8 s")
        _draw_cumulative(axes, shown)
        _draw_lines(axes, shown)
        return _svg(figure)


def window(shown: Distribution) -> tuple[float, float]:
    """Return what is shown: all that occurred, and the limits."""
    used = np.nonzero(shown.counts)[0]
    values = [line.value for line in shown.limits] + [shown.extreme]
    if len(used):
        values += [float(shown.edges[used[0]]), float(shown.edges[used[-1] + 1])]
    low, high = min(values), max(values)
    room = 0.06 * (high - low or 1.0)
    return max(low - room, min(float(shown.edges[0]), low)), high + room


def _draw_cumulative(axes: Axes, shown: Distribution) -> None:
    total = int(shown.counts.sum()) + shown.below + shown.above
    right = axes.twinx()
    right.spines["top"].set_visible(False)
    right.set_ylim(0.0, 105.0)
    right.set_yticks([0, 25, 50, 75, 100])
    right.set_ylabel("cumulative, %", color=DARK)
    if total:
        share = 100.0 * (shown.below + np.concatenate([[0], np.cumsum(shown.counts)])) / total
        right.plot(shown.edges, share, color=DARK, linewidth=1.1)


def _draw_lines(axes: Axes, shown: Distribution) -> None:
    low, high = axes.get_xlim()
    places = sorted({line.value for line in shown.limits})
    crowded = any(after - before < 0.12 * (high - low) for before, after in pairwise(places))
    for line in shown.limits:
        color = VERMILION if line.is_true else BLUE
        axes.axvline(
            line.value, color=color, linewidth=1.1, linestyle="-" if line.is_true else "--"
        )
        is_first = line.value == places[0]
        axes.annotate(
            f"{line.name} {line.value:.3g}", (line.value, 1.0), xycoords=("data", "axes fraction"),
            xytext=(0, 2), textcoords="offset points", va="bottom", color=color, fontsize=6.5,
            ha="center" if not crowded else "right" if is_first else "left",
        )  # fmt: skip
    axes.plot([shown.extreme], [1.0], marker="v", markersize=5, color="black", clip_on=False)
    is_right = shown.extreme > (low + high) / 2
    axes.annotate(
        f"{shown.extreme_name} {shown.extreme:.3g} {shown.unit}", (shown.extreme, 1.0),
        xytext=(-5 if is_right else 5, 5), textcoords="offset points",
        ha="right" if is_right else "left", va="bottom", fontsize=6.5,
        bbox={"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 0.8},
    )  # fmt: skip


# ------------------------------------------------------------------ outcomes


def outcome_figure(cells: Sequence[tuple[str, Mapping[str, int]]]) -> bytes:
    """Draw one bar per cell, its drives by outcome."""
    names = list(dict.fromkeys(name for name in OUTCOME_COLORS for _, own in cells if name in own))
    names += sorted({name for _, own in cells for name in own} - set(names))
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH_IN, 0.75 + 0.165 * len(cells)), layout="constrained")
        axes = figure.add_subplot()
        places = np.arange(len(cells))
        start = np.zeros(len(cells))
        for name in names:
            counts = np.array([own.get(name, 0) for _, own in cells])
            axes.barh(
                places, counts, 0.78, left=start, label=name.replace("_", " "),
                edgecolor="white", linewidth=0.4, color=OUTCOME_COLORS.get(name, DARK),
            )  # fmt: skip
            start += counts
        axes.set_yticks(places, [title for title, _ in cells])
        axes.set_ylim(len(cells) - 0.4, -0.6)
        axes.set_xlim(0, max(float(start.max()), 1.0))
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
        axes.spines["right"].set_visible(False)
        axes.tick_params(axis="y", length=0)
        axes.set_xlabel("drives")
        figure.legend(
            loc="outside upper left", ncols=6, frameon=False, handlelength=1.0, columnspacing=1.2
        )
        return _svg(figure)


# ------------------------------------------------------------------ rejections


def cause_figure(causes: Sequence[tuple[str, int, int]]) -> bytes:
    """Draw, for every reason, the drives that it kept without a path at the end and overall."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH_IN, 0.7 + 0.3 * len(causes)), layout="constrained")
        axes = figure.add_subplot()
        places = np.arange(len(causes))
        for shift, index, color, name in (
            (-0.19, 1, BLUE, "most frequent in the last refusal"),
            (0.19, 2, GREY, "most frequent in the whole drive"),
        ):
            counts = [row[index] for row in causes]
            bars = axes.barh(places + shift, counts, 0.36, color=color, label=name)
            axes.bar_label(bars, padding=2, fontsize=6.5)
        axes.set_yticks(places, [row[0] for row in causes])
        axes.set_ylim(len(causes) - 0.45, -0.55)
        axes.margins(x=0.06)
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
        axes.spines["right"].set_visible(False)
        axes.tick_params(axis="y", length=0)
        axes.set_xlabel("drives without a path")
        figure.legend(loc="outside upper left", ncols=2, frameon=False, handlelength=1.0)
        return _svg(figure)
