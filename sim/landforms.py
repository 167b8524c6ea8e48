# SPDX-License-Identifier: Apache-2.0
"""Made base terrains: crater, cliff, valley, maze, corridor, slope transition and rock pile.

Each is a building block: placed, turned and combined with the others as a recipe says.
"""

import math
from typing import Annotated, Literal

import numpy as np
import numpy.typing as npt
from pydantic import Field

from sim.config import ConfigModel

LandformKind = Literal[
    "crater", "cliff", "valley", "maze", "corridor", "slope_transition", "rock_pile"
]
# how a layer joins those before it: their sum, or the higher or lower of the two
Combination = Literal["add", "higher", "lower"]
Grid = npt.NDArray[np.float64]


class Landform(ConfigModel):
    """One landform.

    Attributes:
        kind: crater: a bowl `height_m` deep and `width_m` across with a raised rim. cliff: a step
            up to the east. valley: a trough along north. maze: walls of a random maze. corridor: a
            level lane along north between walls. slope_transition: level in the south, rising
            over `width_m` to a plane that climbs `height_m` up to the northern edge. rock_pile: a
            mound of boulders.
        height_m: Depth or height of the feature.
        width_m: Diameter, run of the slope, or free width between walls.
        center_m: North and east of its middle.
        azimuth_deg: Turned clockwise by this; what is said of north above is then this direction.
        combine: How it joins the landforms before it.
    """

    kind: LandformKind
    height_m: Annotated[float, Field(gt=0, le=500)] = 1.0
    width_m: Annotated[float, Field(gt=0, le=500)] = 10.0
    center_m: tuple[float, float] = (0.0, 0.0)
    azimuth_deg: Annotated[float, Field(ge=-360, le=360)] = 0.0
    combine: Combination = "add"


def landform_up_m(form: Landform, north_m: Grid, east_m: Grid, rng: np.random.Generator) -> Grid:
    """Heights (up) on the grid of north_m [n] and east_m [m], shape [n, m]."""
    n, e = north_m[:, None] - form.center_m[0], east_m[None, :] - form.center_m[1]
    extent_m = float(north_m[-1] - north_m[0]), float(east_m[-1] - east_m[0])
    if form.azimuth_deg:
        azimuth_rad = math.radians(form.azimuth_deg)
        along, across = math.cos(azimuth_rad), math.sin(azimuth_rad)
        n, e = along * n + across * e, along * e - across * n
    shape = np.zeros((len(north_m), len(east_m)))
    if form.kind == "maze":
        relative = _maze(n, e, extent_m, form.width_m, rng)
    elif form.kind == "rock_pile":
        relative = _rock_pile(n, e, form.width_m, rng)
    else:
        relative = shape + {
            "crater": _crater,
            "cliff": _cliff,
            "valley": _valley,
            "corridor": _corridor,
            "slope_transition": _slope_transition,
        }[form.kind](n, e, form.width_m)
    return form.height_m * relative


def _crater(n: Grid, e: Grid, width_m: float) -> Grid:
    """Parabolic bowl, rim a fifth of the depth high, ejecta falling off with the cube."""
    r = np.hypot(n, e) / (0.5 * width_m)
    rim = 0.2
    bowl = rim + (1.0 + rim) * (r**2 - 1.0)
    result: Grid = np.where(r < 1.0, np.maximum(bowl, -1.0), rim / np.maximum(r, 1.0) ** 3)
    return result


def _cliff(n: Grid, e: Grid, width_m: float) -> Grid:
    """Wavy step up to the east; a twentieth of the width from foot to edge."""
    foot = 0.1 * width_m * np.sin(2.0 * math.pi * n / (3.0 * width_m))
    return _ramp((e - foot) / (0.05 * width_m))


def _valley(n: Grid, e: Grid, width_m: float) -> Grid:
    axis = 0.3 * width_m * np.sin(2.0 * math.pi * n / (6.0 * width_m))
    result: Grid = -np.exp(-0.5 * ((e - axis) / (0.25 * width_m)) ** 2)
    return result


def _corridor(n: Grid, e: Grid, width_m: float) -> Grid:
    axis = 0.5 * width_m * np.sin(2.0 * math.pi * n / (8.0 * width_m))
    return _ramp((np.abs(e - axis) - 0.5 * width_m) / 0.3)


def _slope_transition(n: Grid, e: Grid, width_m: float) -> Grid:
    """Level, a parabola over the width, then the plane: heights and slopes are continuous."""
    run = n + 0.5 * width_m
    rise = np.where(
        run < width_m, 0.5 * np.clip(run, 0.0, None) ** 2 / width_m, run - 0.5 * width_m
    )
    top = float(rise.max())
    result: Grid = (rise / top if top > 0 else rise) + 0.0 * e
    return result


def _ramp(x: Grid) -> Grid:
    """Smooth step from 0 at x <= 0 to 1 at x >= 1."""
    x = np.clip(x, 0.0, 1.0)
    result: Grid = x * x * (3.0 - 2.0 * x)
    return result


def _maze(
    n: Grid, e: Grid, extent_m: tuple[float, float], width_m: float, rng: np.random.Generator
) -> Grid:
    """Walls of a perfect maze (depth-first), passages `width_m` wide, walls a tenth of it."""
    rows = max(1, int(extent_m[0] // width_m))
    cols = max(1, int(extent_m[1] // width_m))
    wall_north = np.ones((rows + 1, cols), dtype=bool)
    wall_east = np.ones((rows, cols + 1), dtype=bool)
    seen = np.zeros((rows, cols), dtype=bool)
    stack = [(0, 0)]
    seen[0, 0] = True
    while stack:
        row, col = stack[-1]
        steps = [
            (row + dr, col + dc)
            for dr, dc in ((1, 0), (-1, 0), (0, 1), (0, -1))
            if 0 <= row + dr < rows and 0 <= col + dc < cols and not seen[row + dr, col + dc]
        ]
        if not steps:
            stack.pop()
            continue
        next_row, next_col = steps[int(rng.integers(len(steps)))]
        if next_col == col:
            wall_north[max(row, next_row), col] = False
        else:
            wall_east[row, max(col, next_col)] = False
        seen[next_row, next_col] = True
        stack.append((next_row, next_col))
    return _maze_walls(n, e, width_m, wall_north, wall_east)


def _maze_walls(
    n: Grid,
    e: Grid,
    width_m: float,
    wall_north: npt.NDArray[np.bool_],
    wall_east: npt.NDArray[np.bool_],
) -> Grid:
    rows, cols = wall_north.shape[0] - 1, wall_east.shape[1] - 1
    u = n / width_m + 0.5 * rows
    v = e / width_m + 0.5 * cols
    row, col = np.floor(u).astype(int), np.floor(v).astype(int)
    inside = ((row >= 0) & (row < rows)) & ((col >= 0) & (col < cols))
    i, j = np.clip(row, 0, rows - 1), np.clip(col, 0, cols - 1)
    half = 0.05
    wall = (
        ((u - row < half) & wall_north[i, j])
        | ((u - row > 1 - half) & wall_north[i + 1, j])
        | ((v - col < half) & wall_east[i, j])
        | ((v - col > 1 - half) & wall_east[i, j + 1])
    )
    walls: Grid = (wall & inside).astype(np.float64)
    return walls


def _rock_pile(n: Grid, e: Grid, width_m: float, rng: np.random.Generator) -> Grid:
    """Half-ellipsoid boulders, larger and denser in the middle."""
    pile = np.zeros(np.broadcast_shapes(n.shape, e.shape))
    for _ in range(80):
        bearing, distance = rng.uniform(0, 2 * math.pi), 0.2 * width_m * abs(rng.normal())
        radius = width_m * rng.uniform(0.04, 0.12)
        top = max(0.0, 1.0 - 2.0 * distance / width_m) * rng.uniform(0.5, 1.0)
        r2 = (n - distance * math.cos(bearing)) ** 2 + (e - distance * math.sin(bearing)) ** 2
        pile = np.maximum(pile, top * np.sqrt(np.clip(1.0 - r2 / radius**2, 0.0, None)))
    return pile
