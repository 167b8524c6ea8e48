# SPDX-License-Identifier: Apache-2.0
"""One scenario in each of the four Go To modes, and a picture of the four tracks."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch

from pyharness.dp_file import DpReader
from pyharness.drive_folder import run_drive
from pyharness.history import History
from pyharness.overhead import KEEP_IN_COLOR, KEEP_OUT_COLOR, draw_scale, draw_terrain, draw_zones
from pyharness.scenario import Scenario
from sim.terrain import Terrain

# mode, colour, and how far its line is drawn: those below show where tracks are the same
MODES = (
    ("unguarded", "#ff5252", 6.5),
    ("guarded", "#ffd740", 4.2),
    ("avoid_koz", "#40c4ff", 2.6),
    ("avoid_all", "#69f0ae", 1.6),
)
MARGIN_M = 5.0
HEIGHT_IN = 10.0


def drive_modes(
    scenario: Scenario,
    terrain: Terrain,
    folder: Path,
    force: bool,
    report: Callable[[str, Mapping[str, Any]], None],
) -> Path:
    """Drive a resolved scenario in every mode, a folder each; return the picture drawn of them."""
    for mode, _, _ in MODES:
        waypoints = tuple(
            item.model_copy(update={"mode": mode}) for item in scenario.waypoints or ()
        )
        driven = scenario.model_copy(update={"waypoints": waypoints})
        report(mode, run_drive(driven, terrain, folder / mode, force))
    picture = folder / "modes.png"
    histories = {mode: _read(folder / mode / "drive.dp") for mode, _, _ in MODES}
    draw_modes(histories, terrain, picture)
    return picture


def draw_modes(histories: Mapping[str, History], terrain: Terrain, path: Path) -> None:
    """Draw the tracks of drives that differ in their mode."""
    first = next(iter(histories.values()))
    window = _window(first, terrain)
    south_m, north_m, west_m, east_m = window
    width_in = HEIGHT_IN * (east_m - west_m) / (north_m - south_m)
    with mpl.rc_context({"font.family": "DejaVu Sans", "font.size": 9}):
        figure = Figure(figsize=(width_in + 3.6, HEIGHT_IN), dpi=110, layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.add_subplot()
        draw_terrain(figure, axes, terrain, window)
        draw_zones(axes, first)
        handles = [_draw_track(axes, histories[mode], color, width) for mode, color, width in MODES]
        _draw_places(axes, first)
        draw_scale(axes, window)
        axes.set(xlim=(west_m, east_m), ylim=(south_m, north_m), aspect="equal")
        axes.set(xlabel="east, m", ylabel="north, m")
        zones = [
            Patch(edgecolor=KEEP_OUT_COLOR, facecolor=(KEEP_OUT_COLOR, 0.15), label="KOZ"),
            Patch(edgecolor=KEEP_IN_COLOR, facecolor="none", label="KIZ"),
        ]
        figure.legend(
            handles=[*handles, *zones],
            loc="outside right upper",
            facecolor="#6b5b4f",
            labelcolor="white",
            labelspacing=1.0,
        )
        axes.set_title(f"{first.info.name}: the four Go To modes", loc="left", fontweight="bold")
        figure.savefig(path, format="png", metadata={"Software": None})


def _read(path: Path) -> History:
    with DpReader(path) as reader:
        history = History(reader.schema, reader.info)
        for record in reader.records():
            history.take(record)
    return history


def _window(history: History, terrain: Terrain) -> tuple[float, float, float, float]:
    """Return south, north, west, east of start, goals and zones, with a margin."""
    info = history.info
    north = [info.start_north_m, *(item.north_m for item in info.waypoints)]
    middle_m, half_m = 0.5 * (min(north) + max(north)), 0.5 * (max(north) - min(north)) + MARGIN_M
    east_middle_m = info.start_east_m
    return (
        max(middle_m - half_m, terrain.north_min_m),
        min(middle_m + half_m, terrain.north_max_m),
        max(east_middle_m - 0.62 * half_m, terrain.east_min_m),
        min(east_middle_m + 0.62 * half_m, terrain.east_max_m),
    )


def _draw_track(axes: Axes, history: History, color: str, width: float) -> Line2D:
    """Draw a true track with its end; return the handle that says how it ended."""
    pose, outcome = history.truth["pose"], history.outcome
    east_m, north_m = pose["y_site_m"], pose["x_site_m"]
    axes.plot(east_m, north_m, color=color, linewidth=width, zorder=4, solid_capstyle="butt")
    marker = "o" if outcome.is_reached else "X"
    axes.plot(
        east_m[-1],
        north_m[-1],
        marker,
        color=color,
        markersize=11,
        markeredgecolor="black",
        zorder=5,
    )
    text = outcome.outcome
    if outcome.fault_detail:
        text += f"\n{outcome.fault_detail.replace('; ', chr(10))}"
    mode = history.info.waypoints[-1].mode
    return Line2D([], [], color=color, linewidth=width, marker=marker, label=f"{mode}: {text}")


def _draw_places(axes: Axes, history: History) -> None:
    info = history.info
    axes.plot(info.start_east_m, info.start_north_m, "o", color="white", zorder=6)
    axes.annotate("start", (info.start_east_m, info.start_north_m), (6, -3),
                  textcoords="offset points", color="white")  # fmt: skip
    for waypoint in info.waypoints:
        place = (waypoint.east_m, waypoint.north_m)
        axes.add_patch(
            Circle(place, waypoint.radius_m, fill=False, edgecolor="white", linewidth=1.4)
        )
        axes.annotate("goal", place, (0, 2), textcoords="offset points", color="white", ha="center")
