# SPDX-License-Identifier: Apache-2.0
"""Pictures of a terrain: relief, slope, rocks over a height, every layer, profiles (SIM Fig. 4)."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import numpy.typing as npt
from matplotlib import patheffects
from matplotlib.axes import Axes
from matplotlib.colors import (
    BoundaryNorm,
    Colormap,
    LinearSegmentedColormap,
    ListedColormap,
    Normalize,
)
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon

from pyharness.map_style import (
    Extent,
    Grid,
    draw_scale,
    hillshade,
    new_figure,
    relief,
    save_png,
    slope_deg,
    with_style,
)
from sim.errors import TerrainError
from sim.generate import CLEAR_STRIP_M, Layers, generate_layers, recipe_of
from sim.rocks import achieved_area_fraction
from sim.terrain import CLASS_NAMES, Terrain

LAYER_NAMES = ("surface", "ground", "base", "undulation", "slope", "rocks", "class")
MAP_IN, SIDE_IN = 8.6, 3.4
SLOPE_LIMIT_DEG = 30.0
SLOPE_COLORS = LinearSegmentedColormap.from_list(
    "slope", ["#f3efe4", "#f7dc9b", "#f2a65a", "#dd5a3f", "#a32a45", "#5e1747"]
)
HEIGHT_COLORS = LinearSegmentedColormap.from_list(
    "height", ["#4a2c2a", "#8a4b32", "#c07a4a", "#e0b384", "#f7ead7"]
)
ROCK_COLOR, PROFILE_COLOR, START_COLOR = "#0a63ff", "#00a37a", "#ffffff"
CLASS_COLORS = ("#b9b9b9", "#7d5ba6", "#c98f5a", "#f0dc82")
# heights at which a rock is a hazard to the belly pan, to a wheel, to the rocker (SIM Fig. 10)
HAZARD_HEIGHTS_M = (0.25, 0.35, 0.46)

PointM = tuple[float, float]


@dataclass(frozen=True, slots=True, eq=False)
class Shown:
    """A terrain with what can be known of its layers, heights up.

    Attributes:
        name: Title.
        terrain: What is shown.
        layers: Heights (up) of each layer there is.
    """

    name: str
    terrain: Terrain
    layers: dict[str, Grid]

    @property
    def extent(self) -> Extent:
        """West, east, south, north edge of the outermost nodes' cells."""
        t, half_m = self.terrain, 0.5 * self.terrain.resolution_m
        return (
            t.east_min_m - half_m, t.east_max_m + half_m,
            t.north_min_m - half_m, t.north_max_m + half_m,
        )  # fmt: skip

    @property
    def ground(self) -> Grid:
        """Ground-slope map; the surface itself where the layers are not known."""
        return self.layers.get("ground", self.layers["surface"])


def shown_terrain(terrain: Terrain, name: str) -> Shown:
    """A terrain with its layers, which are made again from its recipe where it has one.

    A file that no longer is what its recipe makes is shown without layers.
    """
    surface = -terrain.z_site_m.astype(np.float64)
    layers = {"surface": surface}
    if terrain.classes is not None:
        layers["class"] = terrain.classes.astype(np.float64)
    made = _layers_of(terrain)
    if made is not None:
        layers |= {
            "ground": -made.ground,
            "base": -made.base,
            "undulation": -made.undulation,
            "slope": -made.slope,
            "rocks": np.maximum(surface + made.ground, 0.0),
        }
    return Shown(name, terrain, layers)


def _layers_of(terrain: Terrain) -> Layers | None:
    recipe = recipe_of(terrain)
    if recipe is None:
        return None
    try:
        made = generate_layers(recipe)
    except TerrainError:  # a base that is no longer there
        return None
    z = terrain.z_site_m
    if made.terrain.z_site_m.shape != z.shape:
        return None
    # a PGM keeps heights to half a count
    allowed_m = 1e-4 + float(np.ptp(z)) / 65535
    same = np.abs(made.terrain.z_site_m - z).max() <= allowed_m
    return made if same else None


# ------------------------------------------------------------------ pictures


def draw_overview(
    shown: Shown, path: Path, rocks_above_m: float, window_m: float, profile: list[PointM] | None
) -> None:
    """Slope of the ground as colours, relief of the surface, rocks over a height, a profile."""
    _check_profile(shown, profile)
    with with_style():
        figure, axes, below = _page(profile is not None)
        steep = slope_deg(shown.ground, shown.terrain.resolution_m, window_m)
        limit = min(SLOPE_LIMIT_DEG, max(10.0, 5.0 * math.ceil(np.nanpercentile(steep, 99.5) / 5)))
        norm = Normalize(0.0, limit)
        shade = hillshade(shown.layers["surface"], shown.terrain.resolution_m)
        picture = relief(steep, SLOPE_COLORS, norm, shade)
        high = rock_mask(shown, rocks_above_m)
        _paint(picture, high, ROCK_COLOR, shade)
        axes.imshow(picture, origin="lower", extent=shown.extent, interpolation="antialiased")
        what = "ground without rocks" if "ground" in shown.layers else "surface"
        _bar(figure, axes, SLOPE_COLORS, norm, f"slope of the {what} over {window_m:g} m, deg",
             "max" if float(np.nanmax(steep)) > limit else "neither")  # fmt: skip
        count = int(np.count_nonzero(shown.terrain.rocks["height_m"] > rocks_above_m))
        label = f"rock higher than {100 * rocks_above_m:g} cm ({count})"
        handles = [Patch(facecolor=ROCK_COLOR, label=label)]
        _finish(shown, axes, handles, profile, "slope and rocks")
        if profile is not None and below is not None:
            _draw_profile(shown, below, profile, rocks_above_m)
        save_png(figure, path)


def draw_layer(shown: Shown, layer: str, path: Path, profile: list[PointM] | None = None) -> None:
    """One layer on its own."""
    _check_profile(shown, profile)
    _check_layer(shown, layer)
    with with_style():
        figure, axes, below = _page(profile is not None)
        _draw_layer(figure, axes, shown, layer, location="bottom")
        _finish(shown, axes, [], profile, _TITLES[layer])
        if profile is not None and below is not None:
            _draw_profile(shown, below, profile, None)
        save_png(figure, path)


def draw_all_layers(shown: Shown, path: Path) -> None:
    """Every layer there is, side by side."""
    names = [name for name in LAYER_NAMES if name in shown.layers and _says_something(shown, name)]
    with with_style():
        columns = min(3, len(names))
        rows = math.ceil(len(names) / columns)
        figure = new_figure((5.2 * columns, 4.9 * rows))
        figure.suptitle(shown.name, fontweight="bold")
        for index, name in enumerate(names):
            axes = figure.add_subplot(rows, columns, index + 1)
            _draw_layer(figure, axes, shown, name, location="right")
            axes.set(xlabel="east, m", ylabel="north, m", aspect="equal")
            axes.set_title(_TITLES[name])
        save_png(figure, path)


# ------------------------------------------------------------------ parts

_TITLES = {
    "surface": "surface: ground and rocks",
    "ground": "ground-slope: base + undulation + slope",
    "base": "base heightmap",
    "undulation": "undulation",
    "slope": "constant slope",
    "rocks": "rocks",
    "class": "terrain class",
}


def _says_something(shown: Shown, layer: str) -> bool:
    """Return whether a layer is more than a level plane; the surface is always shown."""
    return layer == "surface" or bool(np.ptp(shown.layers[layer]) > 0)


def _check_layer(shown: Shown, layer: str) -> None:
    if layer in shown.layers:
        return
    if layer == "class":
        raise TerrainError(f"{shown.name}: has no terrain classes")
    raise TerrainError(
        f"{shown.name}: its layers are not known (no recipe, or the heights are not those of the"
        " recipe), expected --layer surface"
    )


def _page(has_profile: bool) -> tuple[Figure, Axes, Axes | None]:
    if not has_profile:
        figure = new_figure((MAP_IN + SIDE_IN, MAP_IN + 0.7))
        return figure, figure.add_subplot(), None
    figure = new_figure((MAP_IN + SIDE_IN, MAP_IN + 3.2))
    grid = figure.add_gridspec(2, 1, height_ratios=[MAP_IN + 0.4, 2.4])
    return figure, figure.add_subplot(grid[0]), figure.add_subplot(grid[1])


def _draw_layer(figure: Figure, axes: Axes, shown: Shown, layer: str, location: str) -> None:
    values, cell_m = shown.layers[layer], shown.terrain.resolution_m
    colors: Colormap
    norm: Normalize
    if layer == "class":
        colors = ListedColormap(CLASS_COLORS)
        norm = BoundaryNorm(np.arange(len(CLASS_NAMES) + 1) - 0.5, len(CLASS_NAMES))
        shade = hillshade(shown.layers["surface"], cell_m)
        picture = relief(values, colors, norm, shade)
        axes.imshow(picture, origin="lower", extent=shown.extent)
        found = [int(number) for number in np.unique(values)]
        axes.legend(
            handles=[Patch(facecolor=CLASS_COLORS[n], label=CLASS_NAMES[n]) for n in found],
            loc="upper right",
        )
        return
    scale: Callable[[Grid], Grid] = np.asarray
    if layer == "rocks":
        colors, label = mpl.colormaps["YlOrBr"], "height above the ground, cm"
        norm = Normalize(0.0, max(1.0, 100 * float(values.max())))
        scale = _to_cm
    elif layer == "undulation":
        reach = max(float(np.abs(values).max()), 1e-3)
        colors, norm, label = mpl.colormaps["RdBu_r"], Normalize(-reach, reach), "height, m"
    else:
        low, high = float(np.nanmin(values)), float(np.nanmax(values))
        colors, label = HEIGHT_COLORS, "elevation above SITE origin, m"
        norm = Normalize(low, max(high, low + 1e-3))
    shade = hillshade(values, cell_m, _exaggeration(values, cell_m))
    axes.imshow(
        relief(scale(values), colors, norm, shade),
        origin="lower", extent=shown.extent, interpolation="antialiased",
    )  # fmt: skip
    _bar(figure, axes, colors, norm, label, location=location)


def _to_cm(values: Grid) -> Grid:
    return 100.0 * values


def _exaggeration(up_m: Grid, cell_m: float) -> float:
    """Makes gentle layers visible: steep ones as they are, others up to ten times steeper."""
    steep = float(np.nanpercentile(np.abs(np.diff(up_m, axis=0)), 95)) / cell_m
    return float(np.clip(0.35 / max(steep, 1e-6), 1.0, 10.0))


def _bar(
    figure: Figure, axes: Axes, colors: Colormap, norm: Normalize, label: str,
    extend: str = "neither", location: str = "bottom",
) -> None:  # fmt: skip
    shown = mpl.cm.ScalarMappable(norm, colors)
    aspect = 45 if location == "bottom" else 25
    bar = figure.colorbar(
        shown, ax=axes, location=location, extend=extend, shrink=0.75, pad=0.015, aspect=aspect
    )
    bar.set_label(label)


def rock_mask(shown: Shown, above_m: float) -> npt.NDArray[np.bool_]:
    """Nodes that belong to a listed rock higher than this above the ground around it."""
    terrain = shown.terrain
    mask = np.zeros(terrain.z_site_m.shape, dtype=bool)
    height_m = shown.layers.get("rocks")
    for rock in terrain.rocks[terrain.rocks["height_m"] > above_m]:
        # outlines wave by up to a quarter; a disc of equal area where the layers are not known
        radius_m = (0.5 if height_m is None else 0.65) * float(rock["diameter_m"])
        rows = _near(terrain.north_min_m, terrain.resolution_m, rock["north_m"], radius_m)
        cols = _near(terrain.east_min_m, terrain.resolution_m, rock["east_m"], radius_m)
        north_m = terrain.north_m[rows, None] - rock["north_m"]
        east_m = terrain.east_m[None, cols] - rock["east_m"]
        inside = np.hypot(north_m, east_m) <= radius_m
        if height_m is not None:
            inside &= height_m[rows, cols] > 0.1 * float(rock["height_m"])
        mask[rows, cols] |= inside
    return mask


def _near(first_m: float, step_m: float, place_m: float, radius_m: float) -> slice:
    low = math.ceil((place_m - radius_m - first_m) / step_m)
    return slice(max(0, low), max(0, math.floor((place_m + radius_m - first_m) / step_m) + 1))


def _paint(picture: Grid, mask: npt.NDArray[np.bool_], color: str, shade: Grid) -> None:
    rgb = np.array(mpl.colors.to_rgb(color))
    picture[mask] = np.clip(rgb * (0.45 + 0.8 * shade[mask][:, None]), 0.0, 1.0)


def _finish(
    shown: Shown, axes: Axes, handles: list[Patch], profile: list[PointM] | None, what: str
) -> None:
    """Set axes, scale, north, start strip, legend and the facts beside the map."""
    west_m, east_m, south_m, north_m = shown.extent
    axes.set(xlim=(west_m, east_m), ylim=(south_m, north_m), aspect="equal")
    axes.set(xlabel="east, m", ylabel="north, m")
    draw_scale(axes, shown.extent)
    axes.set_title(f"{shown.name}: {what}", fontweight="bold", pad=16)
    lines: list[Patch | Line2D] = [*handles]
    start = _start_strip(shown)
    if start is not None:
        outlined: list[Any] = [patheffects.withStroke(linewidth=3.0, foreground="black")]
        strip = Polygon(start, fill=False, edgecolor=START_COLOR, linewidth=1.4)
        strip.set_path_effects(outlined)
        axes.add_patch(strip)
        label = "strip cleared for the start"
        lines.append(Patch(fill=False, edgecolor=START_COLOR, label=label, path_effects=outlined))
    if profile is not None:
        (n0, e0), (n1, e1) = profile
        axes.plot([e0, e1], [n0, n1], "-", color=PROFILE_COLOR, linewidth=1.8)
        box = {"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 1.0}
        for letter, (n, e) in zip("AB", profile, strict=True):
            axes.plot(e, n, "o", color=PROFILE_COLOR, markersize=5)
            axes.annotate(
                letter, (e, n), (5, 5), textcoords="offset points", fontweight="bold", bbox=box
            )
        lines.append(Line2D([], [], color=PROFILE_COLOR, label="profile from A to B"))
    if lines:
        axes.legend(handles=lines, loc="lower left", bbox_to_anchor=(1.02, 0.0), borderaxespad=0.0)
    axes.text(
        1.02, 1.0, _facts(shown), transform=axes.transAxes, va="top", linespacing=1.5, fontsize=8.5
    )


def _start_strip(shown: Shown) -> list[PointM] | None:
    recipe = recipe_of(shown.terrain)
    if recipe is None or recipe.start_m is None or not len(shown.terrain.rocks):
        return None
    behind_m, ahead_m, half_m = CLEAR_STRIP_M
    yaw = math.radians(recipe.start_yaw_deg)
    north, east = recipe.start_m
    corners = [(-behind_m, -half_m), (ahead_m, -half_m), (ahead_m, half_m), (-behind_m, half_m)]
    return [
        (
            east + x * math.sin(yaw) + y * math.cos(yaw),
            north + x * math.cos(yaw) - y * math.sin(yaw),
        )
        for x, y in corners
    ]


def _facts(shown: Shown) -> str:
    terrain = shown.terrain
    rows, cols = terrain.z_site_m.shape
    size_m = (rows * terrain.resolution_m, cols * terrain.resolution_m)
    lines = [
        f"{size_m[0]:g} x {size_m[1]:g} m, nodes every {terrain.resolution_m:g} m",
        f"relief {float(np.nanmax(terrain.z_site_m) - np.nanmin(terrain.z_site_m)):.2f} m",
    ]
    recipe = recipe_of(terrain)
    if recipe is not None:
        bases = [Path(base.file).name for base in recipe.base_files()]
        lines += [f"base: {name}" for name in bases]
        if recipe.slope_deg or not bases:
            lines.append(f"slope asked for: {recipe.slope_deg:g} deg")
        lines.append(f"seed {recipe.seed}")
    holes = int(np.count_nonzero(~np.isfinite(terrain.z_site_m)))
    if holes:
        lines.append(f"{holes} nodes without ground")
    rocks = terrain.rocks
    if len(rocks):
        cover = float(achieved_area_fraction(rocks["diameter_m"], size_m[0] * size_m[1], [0.0])[0])
        smallest_m = float(rocks["diameter_m"].min())
        asked = f"CFA asked for: {100 * recipe.cfa:g} %\n" if recipe and recipe.cfa else ""
        lines += [
            "",
            f"{asked}{len(rocks)} rocks of {100 * smallest_m:.0f} cm and more",
            f"cover {100 * cover:.2f} % of the ground",
            *(
                f"  {int((rocks['height_m'] > h).sum()):5d} higher than {100 * h:.0f} cm"
                for h in HAZARD_HEIGHTS_M
            ),
        ]
    if "ground" not in shown.layers:
        lines += ["", "layers not known:", "slope is of the surface"]
    return "\n".join(lines)


# ------------------------------------------------------------------ profile


def _check_profile(shown: Shown, profile: list[PointM] | None) -> None:
    if profile is None:
        return
    for north_m, east_m in profile:
        if not shown.terrain.contains(north_m, east_m):
            raise TerrainError(f"--profile: {north_m:g}, {east_m:g} is not on the terrain")
    if profile[0] == profile[1]:
        raise TerrainError("--profile: both points are the same, expected two")


def _draw_profile(
    shown: Shown, axes: Axes, profile: list[PointM], rocks_above_m: float | None
) -> None:
    """Draw heights of surface and ground along a line, rocks over a height marked."""
    (n0, e0), (n1, e1) = profile
    length_m = math.hypot(n1 - n0, e1 - e0)
    count = max(2, math.ceil(2 * length_m / shown.terrain.resolution_m) + 1)
    share = np.linspace(0.0, 1.0, count)
    north, east = n0 + share * (n1 - n0), e0 + share * (e1 - e0)
    along_m = share * length_m

    def along(up_m: Grid) -> Grid:
        grid = Terrain(
            up_m.astype(np.float32), shown.terrain.resolution_m, shown.terrain.north_min_m,
            shown.terrain.east_min_m,
        )  # fmt: skip
        return grid.height_at(north, east)

    surface, ground = along(shown.layers["surface"]), along(shown.ground)
    low, high = float(np.nanmin(surface)), float(np.nanmax(surface))
    pad = 0.08 * max(high - low, 0.1)
    axes.fill_between(along_m, low - pad, surface, color="#d8c3a5", linewidth=0)
    axes.plot(along_m, surface, color="#4b3621", linewidth=0.9, label="surface")
    if "ground" in shown.layers:
        axes.plot(along_m, ground, color=PROFILE_COLOR, linewidth=1.0, label="ground")
    if rocks_above_m is not None:
        mask = rock_mask(shown, rocks_above_m).astype(np.float64)
        on_rock = along(mask) > 0.5
        axes.fill_between(
            along_m, ground, surface, where=on_rock, color=ROCK_COLOR, linewidth=0,
            label=f"rock higher than {100 * rocks_above_m:g} cm",
        )  # fmt: skip
    axes.set(xlim=(0, length_m), ylim=(low - pad, high + pad))
    axes.set(xlabel="distance from A, m", ylabel="elevation, m")
    axes.grid(color="0.85", linewidth=0.5)
    axes.set_axisbelow(True)
    axes.legend(loc="lower left", bbox_to_anchor=(1.02, 0.0), borderaxespad=0.0)
    axes.figure.draw_without_rendering()  # type: ignore[union-attr]
    box = axes.get_window_extent()
    stretch = (box.height / (high - low + 2 * pad)) / (box.width / length_m)
    axes.set_title(
        f"A ({n0:g} N, {e0:g} E) to B ({n1:g} N, {e1:g} E), vertical exaggeration {stretch:.2g}",
        loc="left",
    )
