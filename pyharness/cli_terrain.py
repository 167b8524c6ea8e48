# SPDX-License-Identifier: Apache-2.0
"""`enav terrain`: make terrains, sets of them, patches of orbital maps, and pictures."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pyharness.cli_types import Numbers, as_options
from pyharness.errors import HarnessError

if TYPE_CHECKING:
    from pyharness.terrain_batch import Done, Job

FILE = click.Path(path_type=Path)
LAYERS = ("surface", "ground", "base", "undulation", "slope", "rocks", "class", "all")
CFAS = (0.07, 0.10, 0.12, 0.15)


@click.group()
def terrain() -> None:
    """Make terrains, and look at them."""


# ------------------------------------------------------------------ generate


@terrain.command("generate")
@click.option("-o", "out", type=FILE, required=True, help="T.pgm to write.")
@click.option("--recipe", type=FILE, help="Recipe, or the YAML of a terrain.")
@click.option("--size-m", type=float, help="Edge of the square (120).")
@click.option("--resolution-m", type=float, help="Distance between nodes (0.1).")
@click.option("--base", type=FILE, help="Terrain or DEM to start from.")
@click.option("--base-center-m", type=Numbers("N,E"), help="Middle, from the middle of the base.")
@click.option("--base-scale", type=float, help="Factor on the heights of the base.")
@click.option(
    "--base-true-scale", is_flag=True, default=None,
    help="Correct the size of the base's pixels for the latitude.",
)  # fmt: skip
@click.option("--base-band", type=int, help="Band of a base with several, from 1.")
@click.option(
    "--landform",
    metavar="KIND[,HEIGHT_M[,WIDTH_M[,N,E[,AZIMUTH_DEG]]]]",
    multiple=True,
    help="Made base: crater, cliff, valley, maze, corridor, slope_transition, rock_pile."
    " May be repeated.",
)
@click.option("--slope-deg", type=float, help="Constant slope.")
@click.option("--slope-azimuth-deg", type=float, help="Up-slope direction; drawn if not given.")
@click.option("--cfa", type=float, help="Cumulative fractional area of rocks, e.g. 0.07.")
@click.option("--cfa-map", type=FILE, help="Map of it, instead.")
@click.option(
    "--undulation",
    type=Numbers("SCALE_M,SPAN_M"),
    multiple=True,
    help="A layer: horizontal scale, height span. May be repeated.",
)
@click.option("--rock-diameter-m", type=Numbers("MIN,MAX"), help="Smallest and largest rock.")
@click.option("--start", type=Numbers("N,E,YAW_DEG"), help="Start of a drive, to clear of rocks.")
@click.option("--seed", type=int, help="Of everything random.")
def terrain_generate(out: Path, recipe: Path | None, **options: Any) -> int:
    """Make one terrain: T.pgm, T.yaml beside it to remake it, T.rocks.csv."""
    from pyharness.terrain_files import generate_terrain
    from sim.errors import ConfigError

    try:
        made = generate_terrain(out, recipe, _recipe_overrides(options))
    except ConfigError as error:
        raise as_options(error, options) from None
    size_m = made.north_max_m - made.north_min_m + made.resolution_m
    click.echo(f"{out}: {size_m:g} x {size_m:g} m, {len(made.rocks)} rocks")
    return 0


def _recipe_overrides(options: Mapping[str, Any]) -> dict[str, object]:
    """Return the keys of a recipe that the options stand for."""
    given = {key: value for key, value in options.items() if value not in (None, ())}
    if "base" in given:
        given["base_file"] = str(given.pop("base").absolute())
    if "cfa_map" in given:
        given["cfa_file"] = str(given.pop("cfa_map").absolute())
    if "landform" in given:
        forms = [_landform(text) for text in given.pop("landform")]
        given |= {"landform": forms[0]} if len(forms) == 1 else {"landforms": forms}
    if "undulation" in given:
        given["undulation"] = [
            {"horizontal_scale_m": scale_m, "height_span_m": span_m}
            for scale_m, span_m in given["undulation"]
        ]
    if "rock_diameter_m" in given:
        low_m, high_m = given.pop("rock_diameter_m")
        given["rock_diameter_min_m"], given["rock_diameter_max_m"] = low_m, high_m
    if "start" in given:
        north_m, east_m, yaw_deg = given.pop("start")
        given["start_m"], given["start_yaw_deg"] = [north_m, east_m], yaw_deg
    return given


def _landform(text: str) -> dict[str, object]:
    kind, *parts = text.split(",")
    try:
        numbers = [float(part) for part in parts]
    except ValueError:
        numbers = []
    if len(numbers) != len(parts) or len(parts) not in (0, 1, 2, 4, 5):
        raise click.BadParameter(
            f"expected KIND[,HEIGHT_M[,WIDTH_M[,N,E[,AZIMUTH_DEG]]]], got {text!r}",
            param_hint="'--landform'",
        )
    form: dict[str, object] = {"kind": kind}
    form |= dict(zip(("height_m", "width_m"), numbers, strict=False))
    if len(numbers) >= 4:
        form["center_m"] = numbers[2:4]
    if len(numbers) == 5:
        form["azimuth_deg"] = numbers[4]
    return form


# ------------------------------------------------------------------ set


@terrain.command("set")
@click.argument("folder", type=FILE)
@click.option("--count", type=int, help="Terrains in all (1200).")
@click.option("--slopes-deg", metavar="LIST", help="Slopes of the grid (0,5,10,15,20).")
@click.option("--cfas", metavar="LIST", help="Rock densities of the grid (0.07,0.10,0.12,0.15).")
@click.option("--first-seed", type=int, help="Lowest seed (0).")
@click.option("--recipe", type=FILE, help="Recipe with what all have in common.")
@click.option("--workers", type=click.IntRange(1, 1024), help="Processes (all processors).")
def terrain_set(folder: Path, workers: int | None, recipe: Path | None, **options: Any) -> int:
    """Make the standard set: slopes x rock densities x seeds. Run again, it goes on."""
    from pyharness.terrain_files import load_recipe
    from pyharness.terrain_set import TerrainSet, make_set, set_jobs, workers_default
    from sim.config import parse_model
    from sim.errors import ConfigError

    given: dict[str, object] = {k: v for k, v in options.items() if v is not None}
    for key in ("slopes_deg", "cfas"):
        if key in given:
            given[key] = _list_of_numbers(str(given[key]), f"--{key.replace('_', '-')}")
    if recipe is not None:
        given["recipe"] = load_recipe(recipe, {}).model_dump(mode="json")
    try:
        wanted = parse_model("", "set", TerrainSet, given)
        total = len(set_jobs(wanted, folder))
    except ConfigError as error:
        raise as_options(error, options) from None
    with _batch_bar(total) as counted:
        make_set(wanted, folder, workers or workers_default(), counted.done)
    click.echo(f"{folder}: {counted.text()}")
    return 0


def _list_of_numbers(text: str, name: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise HarnessError(f"{name}: expected numbers separated by commas, got {text!r}") from None


# ------------------------------------------------------------------ orbital


@terrain.command("orbital")
@click.option("-o", "folder", type=FILE, required=True, help="Folder for chart and patches.")
@click.option("--dem", type=FILE, help="Elevation map: GeoTIFF, PDS3, PDS4, ISIS3, JP2, PGM.")
@click.option("--config", "config_file", type=FILE, help="YAML with any of these and more keys.")
@click.option("--band", type=int, help="Band of the map, where it has several.")
@click.option("--cfa", type=float, help="Cumulative fractional area of rocks, e.g. 0.07.")
@click.option("--cfa-map", type=FILE, help="Map of it, in the same projection.")
@click.option("--count", type=int, help="Patches to draw (10).")
@click.option(
    "--landing", type=Numbers("N,E"), multiple=True,
    help="Landing point, metres from the middle of the map. May be repeated.",
)  # fmt: skip
@click.option(
    "--region", type=Numbers("N,E,RADIUS_M"), multiple=True,
    help="Region of interest. May be repeated.",
)  # fmt: skip
@click.option("--landing-count", type=int, help="Landing points to draw when none is given (64).")
@click.option("--region-count", type=int, help="Regions to draw when none is given (8).")
@click.option("--size-m", type=float, help="Edge of a patch (120).")
@click.option("--resolution-m", type=float, help="Distance between its nodes (0.1).")
@click.option(
    "--true-scale/--stated-scale", default=None,
    help="Correct the size of pixels for the latitude (default), or take it as the file states it.",
)  # fmt: skip
@click.option("--seed", type=int, help="Of everything drawn.")
@click.option("--workers", type=click.IntRange(1, 1024), help="Processes (all processors).")
def terrain_orbital(
    folder: Path, config_file: Path | None, workers: int | None, **options: Any
) -> int:
    """Draw patches along the highways of an orbital map, and the highway chart."""
    from pyharness.terrain_orbital import make_orbital, with_absolute_files
    from pyharness.terrain_set import workers_default
    from sim.config import load_model, parse_model
    from sim.errors import ConfigError
    from sim.orbital import OrbitalConfig

    given = {key: value for key, value in options.items() if value not in (None, ())}
    for option, key in (("dem", "dem"), ("cfa_map", "cfa_file")):
        if option in given:
            given[key] = str(given.pop(option).absolute())
    if "landing" in given:
        given["landing_points_m"] = [list(point) for point in given.pop("landing")]
    if "region" in given:
        given["regions"] = [
            {"center_m": [n, e], "radius_m": radius_m} for n, e, radius_m in given.pop("region")
        ]
    if config_file is None and "dem" not in given:
        raise click.UsageError("Missing option '--dem'.")
    try:
        if config_file is None:
            config = parse_model("", "orbital", OrbitalConfig, given)
        else:
            config = load_model(config_file, OrbitalConfig, given)
            config = with_absolute_files(config, config_file.parent)
    except ConfigError as error:
        raise as_options(error, options) from None
    with _batch_bar(config.count) as counted:
        plan = make_orbital(config, folder, workers or workers_default(), counted.done)
    click.echo(
        f"{folder}: {counted.text()} along {len(plan.highways.routes)} routes,"
        " chart in highways.png and highways.tif"
    )
    return 0


# ------------------------------------------------------------------ show, cfa


@terrain.command("show")
@click.argument("file", type=FILE)
@click.option("--rocks-above-m", type=float, help="Highlight rocks higher than this (0.25).")
@click.option("--layer", type=click.Choice(LAYERS), help="One layer on its own, or all.")
@click.option("--profile", metavar="N,E:N,E", help="Heights between two points.")
@click.option("--slope-over-m", type=float, default=2.5, help="Size of the planes fitted (2.5).")
@click.option("-o", "out", type=FILE, help="PNG to write (beside the terrain).")
def terrain_show(
    file: Path,
    rocks_above_m: float | None,
    layer: str | None,
    profile: str | None,
    slope_over_m: float,
    out: Path | None,
) -> int:
    """Draw a terrain: slope and relief, rocks over a height, layers, a profile."""
    from pyharness.terrain_picture import draw_all_layers, draw_layer, draw_overview, shown_terrain
    from sim.terrain_io import read_terrain

    points = None if profile is None else _points(profile)
    if not 0 < slope_over_m <= 1000:
        raise HarnessError(f"--slope-over-m: expected more than 0, got {slope_over_m:g}")
    if rocks_above_m is not None and not 0 <= rocks_above_m <= 100:
        raise HarnessError(f"--rocks-above-m: expected 0 to 100, got {rocks_above_m:g}")
    if layer is not None and rocks_above_m is not None:
        raise HarnessError("--rocks-above-m: belongs to the picture without --layer")
    if layer == "all" and points is not None:
        raise HarnessError("--profile: belongs to one picture, not to --layer all")
    out = out or file.with_suffix(".png")
    if out.suffix.lower() != ".png":
        raise HarnessError(f"{out}: expected a name ending in .png")
    shown = shown_terrain(read_terrain(file), file.name)
    if layer is None:
        above_m = 0.25 if rocks_above_m is None else rocks_above_m
        draw_overview(shown, out, above_m, slope_over_m, points)
    elif layer == "all":
        draw_all_layers(shown, out)
    else:
        draw_layer(shown, layer, out, points)
    click.echo(f"{out}")
    return 0


def _points(text: str) -> list[tuple[float, float]]:
    try:
        points = [tuple(float(part) for part in point.split(",")) for point in text.split(":")]
    except ValueError:
        points = []
    if [len(point) for point in points] != [2, 2]:
        raise HarnessError(f"--profile: expected N,E:N,E, got {text!r}")
    return [(point[0], point[1]) for point in points]


@terrain.command("cfa")
@click.argument("files", type=FILE, nargs=-1)
@click.option("--seeds", type=click.IntRange(1, 10_000), default=50, help="Terrains drawn (50).")
@click.option("-o", "out", type=FILE, default=Path("cfa.png"), help="PNG to write (cfa.png).")
def terrain_cfa(files: tuple[Path, ...], seeds: int, out: Path) -> int:
    """Draw rock cover by diameter against the law: of terrains, or of freshly drawn rocks."""
    from pyharness.cfa_picture import cover_of_terrain, covers_of_draws, draw_cfa
    from sim.terrain_io import read_terrain

    if files:
        covers = [cover_of_terrain(read_terrain(file), file.name) for file in files]
    else:
        covers = covers_of_draws(CFAS, seeds)
    draw_cfa(covers, out)
    click.echo(f"{out}")
    return 0


# ------------------------------------------------------------------ progress


class _Counted:
    """Counts terrains; shows them where there is a terminal."""

    def __init__(self, advance: "Done") -> None:
        self._advance = advance
        self._made = self._kept = 0

    def done(self, job: "Job", is_new: bool) -> None:
        if is_new:
            self._made += 1
        else:
            self._kept += 1
        self._advance(job, is_new)

    def text(self) -> str:
        kept = f", {self._kept} were there" if self._kept else ""
        return f"{self._made} terrains made{kept}"


@contextmanager
def _batch_bar(total: int) -> Iterator[_Counted]:
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    console = Console(stderr=True)
    columns = (
        TextColumn("terrains"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    off = not console.is_terminal
    with Progress(*columns, console=console, transient=True, disable=off) as bar:
        task = bar.add_task("", total=total)
        yield _Counted(lambda _job, _is_new: bar.update(task, advance=1))
