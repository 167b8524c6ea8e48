# SPDX-License-Identifier: Apache-2.0
"""The overhead view of a drive: terrain, rocks, track, arcs, goals, as one picture."""

import math
import textwrap
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.colors import LightSource, ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Patch, Polygon, Rectangle

from pyharness.dp import Message
from pyharness.history import History
from pyharness.messages import Arc, Pose6, pose_after
from pyharness.status import Status, ZoneKind, ZoneShape
from sim.terrain import Terrain

# heights at which a rock is a hazard to the belly pan, to a wheel, to the rocker (SIM Fig. 10)
ROCK_CLASSES = ((0.25, 0.35, "#f2c14e"), (0.35, 0.46, "#e4572e"), (0.46, math.inf, "#8b1e3f"))
TRACK_COLOR, ARC_COLOR, GOAL_COLOR = "#00c2ff", "#ffffff", "#39ff14"
WHEEL_COLOR = "#8c8c8c"
MAP_COLOR, START_COLOR, KEEP_OUT_COLOR, KEEP_IN_COLOR = "#ffd400", "#ff00c8", "#ff3b30", "#34c759"
MARGIN_M = 8.0
CELLS_MAX = 1500
PICTURE_HEIGHT_IN, LEGEND_WIDTH_IN = 9.0, 2.4
LEGEND: dict[str, Any] = {
    "loc": "upper left",
    "bbox_to_anchor": (1.02, 1.0),
    "borderaxespad": 0.0,
    "facecolor": "#6b5b4f",
    "labelcolor": "white",
}


def draw_overhead(history: History, terrain: Terrain, path: Path) -> None:
    """Write the overhead view as PNG, the same bytes for the same drive."""
    with mpl.rc_context({"font.family": "DejaVu Sans", "font.size": 9, "svg.hashsalt": "enav"}):
        window = _window(history, terrain)
        south_m, north_m, west_m, east_m = window
        width_in = min(PICTURE_HEIGHT_IN * (east_m - west_m) / (north_m - south_m), 14.0)
        size_in = (width_in + LEGEND_WIDTH_IN, PICTURE_HEIGHT_IN)
        figure = Figure(figsize=size_in, dpi=130, layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.add_subplot()
        draw_terrain(figure, axes, terrain, window)
        rock_handles = _draw_rocks(axes, terrain, window)
        draw_zones(axes, history)
        _draw_map(axes, history)
        _draw_arcs(axes, history)
        _draw_track(axes, history)
        _draw_places(axes, history)
        _finish(axes, history, window, rock_handles)
        figure.savefig(path, format="png", metadata={"Software": None})


Window = tuple[float, float, float, float]


def _window(history: History, terrain: Terrain) -> Window:
    """Return south, north, west, east of what is shown: the whole drive, and as square as it is."""
    info = history.info
    north = [info.start_north_m, *(item.north_m for item in info.waypoints)]
    east = [info.start_east_m, *(item.east_m for item in info.waypoints)]
    pose = history.truth["pose"]
    north += pose["x_site_m"].tolist()
    east += pose["y_site_m"].tolist()
    south_m, north_m = min(north) - MARGIN_M, max(north) + MARGIN_M
    west_m, east_m = min(east) - MARGIN_M, max(east) + MARGIN_M
    grow_m = max(0.0, 0.7 * (north_m - south_m) - (east_m - west_m)) / 2
    rise_m = max(0.0, 0.7 * (east_m - west_m) - (north_m - south_m)) / 2
    return (
        max(south_m - rise_m, terrain.north_min_m),
        min(north_m + rise_m, terrain.north_max_m),
        max(west_m - grow_m, terrain.east_min_m),
        min(east_m + grow_m, terrain.east_max_m),
    )


def draw_terrain(figure: Figure, axes: Axes, terrain: Terrain, window: Window) -> None:
    """Shade the heights, sun from the north-west, and colour them."""
    south_m, north_m, west_m, east_m = window
    rows = _span(terrain.north_min_m, terrain.resolution_m, south_m, north_m)
    cols = _span(terrain.east_min_m, terrain.resolution_m, west_m, east_m)
    step = max(1, math.ceil(max(rows.stop - rows.start, cols.stop - cols.start) / CELLS_MAX))
    up_m = -terrain.z_site_m[rows, cols][::step, ::step].astype(np.float64)
    up_m = np.where(np.isfinite(up_m), up_m, np.nanmin(up_m))
    cell_m = step * terrain.resolution_m
    light = LightSource(azdeg=315, altdeg=40)
    exaggeration = 1.5
    shade = light.hillshade(up_m[::-1], vert_exag=exaggeration, dx=cell_m, dy=cell_m)[::-1]
    extent = (
        terrain.east_min_m + (cols.start - 0.5) * terrain.resolution_m,
        terrain.east_min_m + (cols.stop - 0.5) * terrain.resolution_m,
        terrain.north_min_m + (rows.start - 0.5) * terrain.resolution_m,
        terrain.north_min_m + (rows.stop - 0.5) * terrain.resolution_m,
    )
    colors = ListedColormap(mpl.colormaps["copper"](np.linspace(0.25, 0.85, 256)))
    image = axes.imshow(up_m, cmap=colors, origin="lower", extent=extent, alpha=0.0)
    span_m = max(float(np.ptp(up_m)), 1e-6)
    rgb = colors((up_m - up_m.min()) / span_m)[..., :3]
    shaded = np.clip(rgb * (0.35 + 1.1 * shade[..., None]), 0.0, 1.0)
    axes.imshow(shaded, origin="lower", extent=extent, interpolation="nearest")
    bar = figure.colorbar(image, ax=axes, location="bottom", shrink=0.6, pad=0.02, aspect=40)
    if bar.solids is not None:
        bar.solids.set_alpha(1.0)
    bar.set_label("elevation above SITE origin, m")


def _span(first_m: float, step_m: float, low_m: float, high_m: float) -> slice:
    return slice(round((low_m - first_m) / step_m), round((high_m - first_m) / step_m) + 1)


def _draw_rocks(axes: Axes, terrain: Terrain, window: Window) -> list[Patch]:
    rocks = terrain.rocks
    south_m, north_m, west_m, east_m = window
    inside = (rocks["north_m"] >= south_m) & (rocks["north_m"] <= north_m)
    inside &= (rocks["east_m"] >= west_m) & (rocks["east_m"] <= east_m)
    handles = []
    for low_m, high_m, color in ROCK_CLASSES:
        chosen = rocks[inside & (rocks["height_m"] > low_m) & (rocks["height_m"] <= high_m)]
        circles = [
            Circle((rock["east_m"], rock["north_m"]), 0.5 * rock["diameter_m"]) for rock in chosen
        ]
        axes.add_collection(
            PatchCollection(circles, facecolor=color, edgecolor="black", linewidth=0.3, alpha=0.85)
        )
        label = f"rock over {100 * low_m:.0f} cm ({len(chosen)})"
        handles.append(Patch(facecolor=color, edgecolor="black", linewidth=0.3, label=label))
    return handles


def draw_zones(axes: Axes, history: History) -> None:
    """Draw the keep-in and keep-out zones as they were set."""
    if history.zones is None:
        return
    for zone in history.zones["zones"][: int(history.zones["zone_count"])]:
        is_out = int(zone["kind"]) == ZoneKind.KEEP_OUT
        color = KEEP_OUT_COLOR if is_out else KEEP_IN_COLOR
        patch = _zone_patch(zone)
        patch.set(edgecolor=color, facecolor=(color, 0.15) if is_out else "none", linewidth=1.4)
        axes.add_patch(patch)


def _zone_patch(zone: Message) -> Patch:
    center = (float(zone["center_y_site_m"]), float(zone["center_x_site_m"]))
    shape = int(zone["shape"])
    if shape == ZoneShape.CIRCLE:
        return Circle(center, float(zone["radius_m"]))
    if shape == ZoneShape.TRIANGLE:
        return Polygon(np.column_stack([zone["vertex_y_site_m"], zone["vertex_x_site_m"]]))
    heading_rad = float(zone["heading_rad"])
    along = np.array([math.sin(heading_rad), math.cos(heading_rad)]) * zone["length_m"] / 2
    across = np.array([math.cos(heading_rad), -math.sin(heading_rad)]) * zone["width_m"] / 2
    signs = ((1, 1), (1, -1), (-1, -1), (-1, 1))
    return Polygon([center + a * along + b * across for a, b in signs])


def _draw_map(axes: Axes, history: History) -> None:
    """Outline the heightmap as it was at the end."""
    if history.analysis is None:
        return
    corner = (
        float(history.analysis["heightmap_min_y_site_m"]),
        float(history.analysis["heightmap_min_x_site_m"]),
    )
    size_m = history.heightmap_size_m
    axes.add_patch(
        Rectangle(
            corner,
            size_m,
            size_m,
            fill=False,
            edgecolor=MAP_COLOR,
            linestyle="--",
            linewidth=1.2,
        )
    )


def _draw_arcs(axes: Axes, history: History) -> None:
    """Draw every selected arc from the pose it was selected for, its end marked."""
    lines = [
        _arc_line(request, answer)
        for request, answer in history.selections
        if int(answer["status"]) == Status.OK
    ]
    axes.add_collection(LineCollection(lines, colors=ARC_COLOR, linewidths=3.0, zorder=3))
    ends = np.array([line[-1] for line in lines]).reshape(-1, 2)
    axes.plot(ends[:, 0], ends[:, 1], ".", color=ARC_COLOR, markersize=5, zorder=3)


def _arc_line(request: Message, answer: Message) -> npt.NDArray[np.float64]:
    start = request["pose"]
    pose = Pose6(*(float(start[name]) for name in start.dtype.names or ()))
    arc = Arc(float(answer["arc"]["length_m"]), float(answer["arc"]["heading_change_rad"]))
    poses = [pose_after(pose, arc.part(fraction)) for fraction in np.linspace(0.0, 1.0, 9)]
    return np.array([(item.y_m, item.x_m) for item in poses])


def wheel_tracks_m(history: History) -> npt.NDArray[np.float64]:
    """Where the wheels touched the ground, [6, steps, 2] of east and north; NaN off the map."""
    contacts = history.truth["contacts"]
    return np.stack([contacts["y_m"].T, contacts["x_m"].T], axis=-1)


def _draw_track(axes: Axes, history: History) -> None:
    wheels = LineCollection(list(wheel_tracks_m(history)), colors=WHEEL_COLOR, linewidths=0.5)
    axes.add_collection(wheels, autolim=False)
    pose = history.truth["pose"]
    axes.plot(pose["y_site_m"], pose["x_site_m"], "-", color=TRACK_COLOR, linewidth=1.0, zorder=4)


def _draw_places(axes: Axes, history: History) -> None:
    info = history.info
    for index, waypoint in enumerate(info.waypoints, start=1):
        place = (waypoint.east_m, waypoint.north_m)
        disc = Circle(place, waypoint.radius_m, fill=False, edgecolor=GOAL_COLOR, linewidth=1.6)
        axes.add_patch(disc)
        axes.plot(*place, "+", color=GOAL_COLOR, markersize=7)
        name = "goal" if len(info.waypoints) == 1 else f"waypoint {index}"
        offset = (0, 5 + 5 * waypoint.radius_m)
        axes.annotate(
            name, place, offset, textcoords="offset points", color=GOAL_COLOR, ha="center"
        )
    yaw_rad = info.start_yaw_rad
    place = (info.start_east_m, info.start_north_m)
    axes.plot(*place, "o", color=START_COLOR, markersize=6, zorder=5)
    axes.quiver(
        *place,
        math.sin(yaw_rad),
        math.cos(yaw_rad),
        color=START_COLOR,
        scale=25,
        width=0.004,
        zorder=5,
    )
    pose = history.truth["pose"]
    if len(pose):
        axes.plot(pose["y_site_m"][-1], pose["x_site_m"][-1], "s", color=TRACK_COLOR, zorder=5)


def _finish(axes: Axes, history: History, window: Window, rocks: Iterable[Patch]) -> None:
    """Set axes, scale, north, legend and title."""
    south_m, north_m, west_m, east_m = window
    axes.set(xlim=(west_m, east_m), ylim=(south_m, north_m), aspect="equal")
    axes.set(xlabel="east, m", ylabel="north, m")
    axes.grid(color="white", alpha=0.18, linewidth=0.5)
    draw_scale(axes, window)
    axes.legend(handles=[*_line_handles(history), *rocks], **LEGEND)
    info, outcome = history.info, history.outcome
    title = f"{info.name}, seed {info.seed}, {info.planner}, {info.waypoints[-1].mode}"
    axes.set_title(f"{title}: {outcome.outcome}", loc="left", fontweight="bold")
    if outcome.fault_detail:
        detail = "\n".join(textwrap.wrap(outcome.fault_detail, 78, max_lines=3))
        axes.text(
            0.5,
            0.985,
            detail,
            transform=axes.transAxes,
            fontsize=7,
            ha="center",
            va="top",
            bbox={"facecolor": "white", "alpha": 0.8, "edgecolor": "none"},
            zorder=6,
        )


def draw_scale(axes: Axes, window: Window) -> None:
    """Draw a bar of a round length and an arrow to the north."""
    south_m, north_m, west_m, east_m = window
    width_m, height_m = east_m - west_m, north_m - south_m
    length_m = max(step for step in (1, 2, 5, 10, 20, 50, 100, 200) if step <= max(1, width_m / 4))
    left_m, low_m = west_m + 0.04 * width_m, south_m + 0.045 * height_m
    for offset_m, color in ((0, "white"), (length_m / 2, "black")):
        axes.add_patch(
            Rectangle(
                (left_m + offset_m, low_m),
                length_m / 2,
                0.008 * height_m,
                facecolor=color,
                edgecolor="white",
                linewidth=0.8,
            )
        )
    axes.text(
        left_m + length_m / 2, low_m + 0.014 * height_m, f"{length_m} m", color="white", ha="center"
    )
    axes.annotate(
        "N",
        (west_m + 0.06 * width_m, north_m - 0.03 * height_m),
        (west_m + 0.06 * width_m, north_m - 0.11 * height_m),
        arrowprops={"arrowstyle": "-|>", "color": "white", "linewidth": 1.6},
        color="white",
        ha="center",
        fontsize=11,
    )


def _line_handles(history: History) -> list[Any]:
    handles: list[Any] = [
        Line2D([], [], color=TRACK_COLOR, marker="s", markersize=5, label="true track, end"),
        Line2D([], [], color=WHEEL_COLOR, label="wheel tracks"),
        Line2D([], [], color=ARC_COLOR, marker=".", label="selected arcs, as believed"),
        Line2D([], [], color=START_COLOR, marker="o", linestyle="", label="start, heading"),
        Line2D([], [], color=GOAL_COLOR, marker="+", label="goal waydisc"),
        Line2D([], [], color=MAP_COLOR, linestyle="--", label="heightmap at the end"),
    ]
    if history.zones is not None and int(history.zones["zone_count"]):
        handles.append(
            Patch(edgecolor=KEEP_OUT_COLOR, facecolor=(KEEP_OUT_COLOR, 0.15), label="KOZ")
        )
        handles.append(Patch(edgecolor=KEEP_IN_COLOR, facecolor="none", label="KIZ"))
    return handles
