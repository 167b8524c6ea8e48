# SPDX-License-Identifier: Apache-2.0
"""Who worked when: the executive's activities as lanes over time (SIM Fig. 9, of a real drive)."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch, Patch

from pyharness.evr import evr_table
from pyharness.faults import FAULT_PREFIX
from pyharness.history import History
from pyharness.replay import read_history
from pyharness.status import Activity

WINDOW_S = 150.0  # five or six planning cycles: short enough to read
WINDOW_CYCLE = 3  # where it begins: by then thinking has come into step with driving
LANES = (
    (Activity.DRIVING, "driving", "#2b6cb0"),
    (Activity.STEERING, "steering", "#dd6b20"),
    (Activity.WAITING, "standing", "#e53e3e"),
    (Activity.IMAGING, "imaging", "#2f855a"),
    (Activity.VISUAL_ODOMETRY, "visual odometry", "#319795"),
    (Activity.PROCESS_DISPARITY, "process disparity", "#6b46c1"),
    (Activity.ANALYZE_TERRAIN, "analyze terrain", "#b7791f"),
    (Activity.SELECT_ARC, "select arc", "#c53080"),
    (Activity.EVALUATE_ARC, "evaluate arc", "#4a5568"),
)
GROUPS = (("wheels", 0, 3), ("cameras", 3, 4), ("computer", 4, 9))
BAR_HEIGHT = 0.66


@dataclass(frozen=True, slots=True)
class Bar:
    """One activity."""

    start_s: float
    end_s: float
    cycle: int
    length_m: float
    heading_change_rad: float


Bars = dict[int, list[Bar]]


def draw_timeline_of(drive: Path, path: Path) -> None:
    """Write the timeline of a recorded drive as PNG."""
    history, _ = read_history(drive)
    draw_timeline(history, path)


def draw_timeline(history: History, path: Path) -> None:
    """Write the timeline as PNG: the whole drive, and a stretch of it large enough to read."""
    bars = _bars(history)
    wheels = [bar for activity, _, _ in LANES[:3] for bar in bars[activity]]
    end_s = max((bar.end_s for bar in wheels), default=1.0)
    window = _window(bars, end_s)
    with mpl.rc_context({"font.family": "DejaVu Sans", "font.size": 9}):
        figure = Figure(figsize=(14.0, 8.4), dpi=120, layout="constrained")
        FigureCanvasAgg(figure)
        whole, part = figure.subplots(2, 1, height_ratios=(1.0, 1.5))
        _draw_lanes(whole, bars, (0.0, end_s), 1 / 60)
        _draw_events(whole, history)
        whole.axvspan(window[0] / 60, window[1] / 60, color="#f6e05e", alpha=0.35, zorder=0)
        whole.set_xlabel("simulated time, min (the yellow stretch is shown below)")
        _draw_shares(whole, bars, end_s)
        _draw_lanes(part, bars, window, 1.0)
        _draw_cycles(part, bars, window)
        _draw_links(part, bars, window)
        part.set_xlabel("simulated time, s")
        info, outcome = history.info, history.outcome
        title = f"{info.name}, seed {info.seed}, {info.waypoints[-1].mode}: {outcome.outcome}"
        driven_m = sum(abs(bar.length_m) for bar in bars[Activity.DRIVING])
        rate = f"{driven_m:.0f} m commanded in {end_s:.0f} s"
        figure.suptitle(f"{title}. {rate}", x=0.01, ha="left", fontweight="bold")
        handles = [Patch(color=color, label=name) for _, name, color in LANES]
        figure.legend(handles=handles, loc="outside lower center", ncols=len(LANES))
        figure.savefig(path, format="png", metadata={"Software": None})


def _bars(history: History) -> Bars:
    bars: Bars = {activity: [] for activity, _, _ in LANES}
    for item in history.timeline:
        bars[int(item["activity"])].append(
            Bar(
                float(item["start_s"]),
                float(item["end_s"]),
                int(item["cycle"]),
                float(item["arc"]["length_m"]),
                float(item["arc"]["heading_change_rad"]),
            )
        )
    return bars


def _window(bars: Bars, end_s: float) -> tuple[float, float]:
    """Return the stretch to show: planning cycles, where the rover also steers if it ever does."""
    planned = [bar.start_s for bar in bars[Activity.DRIVING] if bar.cycle >= WINDOW_CYCLE]
    steering = [bar.end_s for bar in bars[Activity.STEERING]]
    start_s = next(
        (
            start_s
            for start_s in planned
            if any(start_s < time_s < start_s + 0.9 * WINDOW_S for time_s in steering)
        ),
        planned[0] if planned else 0.0,
    )
    start_s = max(0.0, min(start_s, end_s - WINDOW_S))
    return start_s, min(start_s + WINDOW_S, end_s)


def _draw_lanes(axes: Axes, bars: Bars, window: tuple[float, float], per_s: float) -> None:
    start_s, end_s = window
    for row, (activity, _, color) in enumerate(LANES):
        spans = [
            (bar.start_s * per_s, (bar.end_s - bar.start_s) * per_s)
            for bar in bars[activity]
            if bar.end_s >= start_s and bar.start_s <= end_s
        ]
        axes.broken_barh(
            spans, (row - 0.5 * BAR_HEIGHT, BAR_HEIGHT), color=color, linewidth=0.4, zorder=2
        )
    axes.set_yticks(range(len(LANES)), [name for _, name, _ in LANES])
    axes.set(xlim=(start_s * per_s, end_s * per_s), ylim=(len(LANES) - 0.5, -0.9))
    axes.grid(axis="x", alpha=0.4)
    for name, first, beyond in GROUPS:
        axes.axhline(beyond - 0.5, color="#a0aec0", linewidth=0.8)
        axes.text(
            -0.115,
            0.5 * (first + beyond - 1),
            name,
            transform=axes.get_yaxis_transform(),
            rotation=90 if beyond - first > 1 else 0,
            va="center",
            ha="center",
            color="#4a5568",
            fontweight="bold",
        )


def _draw_shares(axes: Axes, bars: Bars, end_s: float) -> None:
    """Say at the right end of each lane how much of the drive it took."""
    for row, (activity, _, color) in enumerate(LANES):
        share = sum(bar.end_s - bar.start_s for bar in bars[activity]) / end_s
        text = f"{100 * share:.0f} %" if share >= 0.01 or share == 0 else "< 1 %"
        axes.text(1.005, row, text, transform=axes.get_yaxis_transform(), va="center", color=color)
    axes.text(1.005, -0.9, "of time", transform=axes.get_yaxis_transform(), va="bottom")


def _draw_events(axes: Axes, history: History) -> None:
    """Mark where a Go To or a directed arc begins, and faults."""
    for evr in history.evrs:
        row = evr_table().get(int(evr["id"]))
        if row is None:
            continue
        minute = float(evr["time_s"]) / 60
        if row.name in ("GO_TO", "CRAWL", "DIRECTED_ARC", "WAYPOINT_REACHED", "STOPPED"):
            color, label = "black", row.name.lower().replace("_", " ")
        elif row.name.startswith(FAULT_PREFIX):
            color, label = "#e53e3e", row.name.removeprefix(FAULT_PREFIX).lower()
        else:
            continue
        axes.plot([minute], [-0.75], "v", color=color, markersize=5, clip_on=False, zorder=3)
        is_late = minute > 0.5 * axes.get_xlim()[1]
        offset = (-5, 3) if is_late else (5, 3)
        if row.name != "GO_TO":
            axes.annotate(
                label,
                (minute, -0.75),
                offset,
                textcoords="offset points",
                ha="right" if is_late else "left",
                color=color,
                fontsize=8,
            )


def _draw_cycles(axes: Axes, bars: Bars, window: tuple[float, float]) -> None:
    """Name the arcs, and shade every other planning cycle."""
    driving = [bar for bar in bars[Activity.DRIVING] if _is_inside(bar, window)]
    starts_s = [bar.start_s for bar in driving] + [window[1]]
    for index, bar in enumerate(driving):
        if index % 2 == 0:
            axes.axvspan(starts_s[index], starts_s[index + 1], color="#edf2f7", zorder=0)
        middle_s = 0.5 * (max(bar.start_s, window[0]) + min(bar.end_s, window[1]))
        text = f"arc {bar.cycle}: " if bar.cycle else ""  # not planned: a crawl, a directed arc
        text += f"{bar.length_m:.2f} m" if bar.length_m else "turn"
        if bar.heading_change_rad:
            text += f", {math.degrees(bar.heading_change_rad):+.0f}°"
        if bar.end_s - bar.start_s > 0.1 * WINDOW_S:
            axes.text(middle_s, 0, text, ha="center", va="center", color="white", fontsize=8)


def _draw_links(axes: Axes, bars: Bars, window: tuple[float, float]) -> None:
    """Lead from each image to where it is merged, and from each selection to its arc."""
    rows = {activity: row for row, (activity, _, _) in enumerate(LANES)}
    colors = {activity: color for activity, _, color in LANES}
    arcs = {bar.cycle: bar for bar in reversed(bars[Activity.DRIVING])}
    selected = [
        (bar, arcs[bar.cycle + 1]) for bar in bars[Activity.SELECT_ARC] if bar.cycle + 1 in arcs
    ]
    # every image is merged once, in order
    merged = zip(bars[Activity.IMAGING], bars[Activity.PROCESS_DISPARITY], strict=False)
    _arrows(axes, merged, window, rows[Activity.IMAGING], rows[Activity.PROCESS_DISPARITY],
            colors[Activity.IMAGING])  # fmt: skip
    _arrows(axes, selected, window, rows[Activity.SELECT_ARC], rows[Activity.DRIVING],
            colors[Activity.SELECT_ARC])  # fmt: skip
    axes.set_title(
        "green arrows: an image is merged one arc later; pink: a selection becomes the next arc",
        loc="left",
        fontsize=9,
        color="#4a5568",
    )


def _arrows(
    axes: Axes,
    pairs: Iterable[tuple[Bar, Bar]],
    window: tuple[float, float],
    row_from: int,
    row_to: int,
    color: str,
) -> None:
    down = math.copysign(0.5 * BAR_HEIGHT, row_to - row_from)
    for source, target in pairs:
        if source.end_s > target.start_s + 1e-9 or not (
            _is_inside(source, window) and _is_inside(target, window)
        ):
            continue
        arrow = FancyArrowPatch(
            (source.end_s, row_from + down),
            (target.start_s, row_to - down),
            arrowstyle="-|>",
            mutation_scale=9,
            linewidth=0.9,
            color=color,
            alpha=0.8,
            zorder=3,
        )
        axes.add_patch(arrow)


def _is_inside(bar: Bar, window: Sequence[float]) -> bool:
    return bar.end_s > window[0] and bar.start_s < window[1]
