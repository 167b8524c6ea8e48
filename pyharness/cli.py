# SPDX-License-Identifier: Apache-2.0
"""The command line: `enav COMMAND`. Heavy modules are imported inside the commands.

Exit codes: 0 done or goal reached, 2 bad input, 3 the drive ended in a fault, 4 a re-run differs,
130 interrupted.
"""

import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pyharness.cli_modes import modes_command
from pyharness.cli_montecarlo import montecarlo
from pyharness.cli_records import evaluate_arc_command, replay_command
from pyharness.cli_sim import stereo_noise
from pyharness.cli_terrain import terrain
from pyharness.cli_types import Assignment, Numbers, as_options
from pyharness.errors import HarnessError
from sim.errors import SimError

if TYPE_CHECKING:
    from pyharness.command_server import CommandServer
    from pyharness.drive_folder import Progress

EXIT_BAD_INPUT = 2
EXIT_FAULT = 3
EXIT_INTERRUPTED = 130
MODES = ("unguarded", "guarded", "avoid_koz", "avoid_all")
TABLE_FORMATS = ("text", "yaml", "markdown")


@click.group()
@click.version_option(package_name="enav-sim", message="%(version)s")
def cli() -> None:
    """Simulate the Enhanced Navigation (ENav) of the Mars 2020 rover."""


def main() -> None:
    """Run the command line; every error a user can cause is one line and an exit code."""
    try:
        code = cli(standalone_mode=False)
    except click.ClickException as error:
        code = _fail(error.format_message())
    except (HarnessError, SimError) as error:
        code = _fail(str(error))
    except (KeyboardInterrupt, click.Abort):
        click.echo("enav: interrupted", err=True)
        code = EXIT_INTERRUPTED
    except BrokenPipeError:
        sys.stderr.close()
        code = 0
    sys.exit(code)


def _fail(message: str) -> int:
    for line in message.splitlines():
        click.echo(f"enav: {line}", err=True)
    return EXIT_BAD_INPUT


cli.add_command(terrain)
cli.add_command(modes_command)
cli.add_command(montecarlo)
terrain.add_command(stereo_noise)
cli.add_command(replay_command)
cli.add_command(evaluate_arc_command)


# ------------------------------------------------------------------ enav drive


@cli.command("drive")
@click.option("--terrain", "terrain_file", type=click.Path(), help="T.pgm, or a DEM.")
@click.option("--start", type=Numbers("N,E,YAW_DEG"), help="Where the rover starts (-40,0,0).")
@click.option("--goal", type=Numbers("N,E"), help="Where it goes (40,0).")
@click.option("--mode", type=click.Choice(MODES), help="How it goes there (avoid_all).")
@click.option("--planner", help="enav, gestalt, rrtsharp, file.py:Class, or an installed one.")
@click.option("--scenario", "scenario_file", type=click.Path(path_type=Path), help="YAML file.")
@click.option("--set", "settings", type=Assignment(), multiple=True, help="Scenario key = value.")
@click.option("--seed", type=int, help="Of terrain and noise.")
@click.option("--timeline", type=click.Path(path_type=Path), help="Draw who worked when, as PNG.")
@click.option("--port", type=click.IntRange(0, 65535), help="Serve the command socket; 0: any.")
@click.option("--force", is_flag=True, help="Replace a finished drive.")
@click.option("-o", "out", type=click.Path(path_type=Path), help="Folder (drives/NAME-SEED).")
def drive_command(
    scenario_file: Path | None,
    settings: tuple[tuple[str, str], ...],
    timeline: Path | None,
    port: int | None,
    force: bool,
    out: Path | None,
    **options: Any,
) -> int:
    """Run one drive; without arguments the demonstration drive."""
    from pyharness.drive_folder import check_folder, partial_folder, run_drive
    from pyharness.records import Outcome
    from pyharness.scenario import check_places, load_scenario, make_terrain
    from sim.errors import ConfigError

    overrides = {**_scenario_overrides(options), **dict(settings)}
    try:
        scenario = load_scenario(scenario_file, overrides)
        folder = out or Path("drives") / f"{scenario.name}-{scenario.seed}"
        check_folder(folder, force)
        ground = make_terrain(scenario)
        check_places(scenario, ground, scenario_file, overrides)
    except ConfigError as error:
        raise as_options(error, options) from None
    try:
        with _command_server(port) as server, _ProgressBar() as bar:
            summary = run_drive(scenario, ground, folder, force, bar.show, server)
    except KeyboardInterrupt:
        click.echo(f"enav: what was recorded so far is in {partial_folder(folder)}", err=True)
        raise
    if timeline is not None:
        from pyharness.timeline import draw_timeline_of

        draw_timeline_of(folder / "drive.dp", timeline)
    click.echo(_outcome_text(summary))
    click.echo(f"{folder}")
    return 0 if Outcome(summary["outcome"]).is_reached else EXIT_FAULT


@contextmanager
def _command_server(port: int | None) -> "Iterator[CommandServer | None]":
    """Listen while a drive runs, where a port is given."""
    if port is None:
        yield None
        return
    from pyharness.command_server import HOST, CommandServer

    server = CommandServer(port)
    click.echo(f"enav: {HOST}:{server.port} waits for a client to say run", err=True)
    try:
        yield server
    finally:
        server.close()


def _scenario_overrides(options: Mapping[str, Any]) -> dict[str, object]:
    """Return the keys of a scenario that the options stand for."""
    given = {key: value for key, value in options.items() if value is not None}
    if "terrain_file" in given:
        given["terrain"] = {"file": given.pop("terrain_file")}
    if "goal" in given:
        given["waypoints"] = None
    return given


def _outcome_text(summary: Mapping[str, Any]) -> str:
    rate = summary["drive_rate_m_per_h"] or 0.0
    text = (
        f"{summary['outcome']}: {summary['distance_driven_m']:.1f} m in"
        f" {summary['duration_sim_s']:.0f} s ({rate:.0f} m/h),"
        f" {summary['planning_cycles']} planning cycles"
    )
    detail = summary["fault_detail"]
    return f"{text}\n{detail}" if detail else text


class _ProgressBar:
    """Shows the distance still to go, where there is a terminal to show it on."""

    def __enter__(self) -> "_ProgressBar":
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

        console = Console(stderr=True)
        self._bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TimeElapsedColumn(),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
        self._task = self._bar.add_task("starting", total=None)
        self._start_m: float | None = None
        self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.stop()

    def show(self, progress: "Progress") -> None:
        if self._start_m is None:
            self._start_m = progress.distance_to_goal_m
        self._bar.update(
            self._task,
            total=self._start_m,
            completed=max(0.0, self._start_m - progress.distance_to_goal_m),
            description=f"{progress.distance_to_goal_m:6.1f} m to go, {progress.time_s:6.0f} s",
        )


# ------------------------------------------------------------------ enav params, evrs, dps


def _table_command(name: str, rows_name: str, about: str) -> None:
    @cli.command(name, help=about)
    @click.option("--format", "style", type=click.Choice(TABLE_FORMATS), default="text")
    def command(style: str) -> int:
        from pyharness import tables

        rows: Callable[[], Any] = getattr(tables, rows_name)
        click.echo(tables.FORMATS[style](rows()), nl=False)
        return 0


_table_command("params", "param_rows", "List Navlib's parameters.")
_table_command("evrs", "evr_rows", "List Navlib's event reports.")
_table_command("dps", "dp_rows", "List the kinds of data products.")
