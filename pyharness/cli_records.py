# SPDX-License-Identifier: Apache-2.0
"""`enav replay` and `enav evaluate-arc`: recorded drives shown, run again, exported, questioned."""

import math
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pyharness.cli_types import Assignment, Numbers
from pyharness.errors import HarnessError, OutputError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pyharness.dp_file import Damage, DpReader
    from pyharness.history import History
    from pyharness.records import Record

EXIT_DAMAGED = 2
EXIT_DIFFERS = 4
FORMATS = ("csv", "parquet", "mcap")
FILE = click.Path(path_type=Path)


@click.command("replay")
@click.argument("file", type=FILE)
@click.option("--speed", type=float, help="Times simulated time (as fast as it goes).")
@click.option(
    "--from-cycle",
    type=click.IntRange(min=1),
    default=1,
    help="Show from this planning cycle on (1).",
)
@click.option("--rerun", is_flag=True, help="Feed the inputs to the planner again and compare.")
@click.option(
    "--set", "settings", type=Assignment(), multiple=True,
    help="With --rerun: navlib.NAME=VALUE, what if?",
)  # fmt: skip
@click.option("--planner", help="With --rerun: another planner, what if?")
@click.option("--export", "style", type=click.Choice(FORMATS), help="Write the records to -o.")
@click.option("-o", "out", type=FILE, help="Folder for summary and metrics, or for the export.")
@click.option("--force", is_flag=True, help="Write into a folder that is not empty.")
def replay_command(
    file: Path,
    speed: float | None,
    from_cycle: int,
    rerun: bool,
    settings: tuple[tuple[str, str], ...],
    planner: str | None,
    style: str | None,
    out: Path | None,
    force: bool,
) -> int:
    """Publish a recorded drive again, one line for each planning cycle.

    Exits with 2 when the file is damaged, after all that is intact was used, and with 4 when a
    re-run differs from what was recorded.
    """
    if speed is not None and not 0.0 < speed <= 1e6:
        raise HarnessError(f"--speed: expected more than 0, at most 1e6, got {speed:g}")
    if (settings or planner) and not rerun:
        raise HarnessError("--set and --planner change a re-run: give --rerun too")
    if style is not None and out is None:
        raise HarnessError("--export: expected -o FOLDER as well")
    if style is not None and rerun:
        raise HarnessError("--export: give it without --rerun, for the file that -o of that wrote")
    if (speed is not None or from_cycle > 1) and (rerun or style is not None):
        raise HarnessError("--speed and --from-cycle: give them without --rerun and --export")
    if out is not None:
        _check_out(out, file, force)
    from pyharness.replay import makes_sense

    try:
        with makes_sense(file, "its records make no sense"):
            if style is not None and out is not None:
                return _export(file, style, out)
            if settings or planner:
                return _what_if(file, settings, planner, out)
            if rerun:
                return _rerun(file, out)
            return _replay(file, speed, from_cycle, out)
    except OSError as error:
        raise OutputError(f"{error.filename or out}: {error.strerror or error}") from error


def _check_out(out: Path, file: Path, force: bool) -> None:
    if out.exists() and not out.is_dir():
        raise OutputError(f"{out}: exists and is no folder")
    if out.resolve() == file.resolve().parent:
        raise OutputError(f"{out}: {file.name} lies there, expected another folder")
    if out.is_dir() and any(out.iterdir()) and not force:
        raise OutputError(f"{out}: is not empty (--force writes into it all the same)")


def _replay(file: Path, speed: float | None, from_cycle: int, out: Path | None) -> int:
    from pyharness.dp import Kind
    from pyharness.dp_file import DpReader
    from pyharness.history import History
    from pyharness.records import Record, RecordStream
    from pyharness.replay import Player, take

    with DpReader(file) as reader:
        if out is not None:
            out.mkdir(parents=True, exist_ok=True)
        history = History(reader.schema, reader.info)

        def show(record: Record) -> None:
            take(history, record, file)
            cycle = len(history.selections)
            if record.kind == Kind.SELECT_ARC_OUT and cycle >= from_cycle:
                click.echo(_cycle_line(cycle, history))

        player = Player(reader, RecordStream([show]))
        player.seek(from_cycle)
        player.play(speed)
        if out is not None:
            _write_metrics(history, out)
        click.echo(_outcome_line(history))
        return _report(file, reader.damage)


def _rerun(file: Path, out: Path | None) -> int:
    from contextlib import closing

    from pyharness.dp_file import DpReader
    from pyharness.planners import load_planner
    from pyharness.rerun import compare, planner_of, unbroken

    if out is not None:
        raise HarnessError("-o: a re-run that changes nothing has nothing to write")
    with DpReader(file) as reader:
        planner_class = planner_of(load_planner(reader.info.planner), reader.info)
        with closing(unbroken(_with_progress(reader))) as records:
            comparison = compare(records, reader.schema, planner_class)
        done = f"{comparison.call_count} calls, {comparison.record_count} records"
        if comparison.difference is not None:
            click.echo(f"{done} identical, then differs: {comparison.difference}")
            _report(file, reader.damage)
            return EXIT_DIFFERS
        click.echo(f"identical: {done}")
        return _report(file, reader.damage)


def _what_if(
    file: Path, settings: tuple[tuple[str, str], ...], planner: str | None, out: Path | None
) -> int:
    from contextlib import nullcontext
    from dataclasses import replace

    from pyharness.dp import native_schema
    from pyharness.dp_file import DpReader, DpWriter
    from pyharness.history import History
    from pyharness.planners import load_planner
    from pyharness.records import RecordStream
    from pyharness.replay import taken
    from pyharness.rerun import planner_of, rerun_into, unbroken
    from pyharness.whatif import changed_params, comparison_text

    changes = changed_params(settings)
    with DpReader(file) as reader:
        name = planner or reader.info.planner
        info = replace(reader.info, planner=Path(name).name)
        if info.planner != reader.info.planner:
            info = replace(info, planner_params={})
        planner_class = planner_of(load_planner(name), info)
        recorded, again = History(reader.schema, reader.info), History(native_schema(), info)
        records = taken(recorded, unbroken(_with_progress(reader)), file)
        with nullcontext() if out is None else DpWriter(_fresh(out / "drive.dp"), info) as writer:
            stream = RecordStream([again.take])
            if writer is not None:
                stream.subscribers.append(writer.write)
            rerun_into(stream, records, reader.schema, planner_class, changes)
        if out is not None:
            _write_metrics(again, out)
        click.echo(comparison_text(recorded, again), nl=False)
        return _report(file, reader.damage)


def _export(file: Path, style: str, out: Path) -> int:
    from pyharness.dp_file import DpReader
    from pyharness.export_mcap import write_mcap
    from pyharness.export_tables import write_csv, write_parquet

    write = {"csv": write_csv, "parquet": write_parquet, "mcap": write_mcap}[style]
    with DpReader(file) as reader:
        out.mkdir(parents=True, exist_ok=True)
        for path, count in write(reader.schema, _with_progress(reader), out):
            click.echo(f"{path}: {count} records")
        return _report(file, reader.damage)


def _with_progress(reader: "DpReader") -> "Iterator[Record]":
    """Yield all records; show how far it is, where there is a terminal to show it on."""
    from rich.console import Console
    from rich.progress import Progress

    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(reader.path.name, total=reader.path.stat().st_size)
        for record in reader.records():
            bar.advance(task, len(record.payload))
            yield record


def _fresh(path: Path) -> Path:
    """Make room for a file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.unlink(missing_ok=True)
    return path


def _write_metrics(history: "History", out: Path) -> None:
    from pyharness import metrics

    metrics.write(history, metrics.summarize(history), out)
    click.echo(f"{out}")


def _report(file: Path, damage: "Damage | None") -> int:
    """Say what is wrong with the file, if anything; return the exit code."""
    if damage is None:
        return 0
    click.echo(f"enav: {file}: {damage}", err=True)
    return EXIT_DAMAGED


def _cycle_line(cycle: int, history: "History") -> str:
    from pyharness.whatif import arc_text

    request, answer = history.selections[-1]
    pose = request["pose"]
    return (
        f"cycle {cycle:4d}  {float(request['time_s']):9.3f} s"
        f"  north {float(pose['x_site_m']):8.2f} m  east {float(pose['y_site_m']):8.2f} m"
        f"  {arc_text(answer):20s}  {int(answer['ace_evaluations']):4d} ACE evaluations"
    )


def _outcome_line(history: "History") -> str:
    from pyharness.metrics import summarize

    summary = summarize(history)
    detail = summary["fault_detail"]
    return (
        f"{summary['outcome']}: {summary['distance_driven_m']:.1f} m in"
        f" {summary['duration_sim_s']:.0f} s, {summary['planning_cycles']} planning cycles"
        + (f"\n{detail}" if detail else "")
    )


# ------------------------------------------------------------------ enav evaluate-arc


@click.command("evaluate-arc")
@click.argument("file", type=FILE)
@click.option("--time", "time_s", type=float, help="Of a drive, in s (its end).")
@click.option("--pose", type=Numbers("N,E,YAW_DEG"), help="Of a drive: the estimate of then.")
@click.option("--arc", type=Numbers("LENGTH_M,HEADING_DEG"), required=True, help="Arc to check.")
def evaluate_arc_command(
    file: Path, time_s: float | None, pose: list[float] | None, arc: list[float]
) -> int:
    """Ask whether an arc is safe, with reason and margins.

    FILE is the drive.dp of a drive, judged by what the rover had seen, or a terrain T.pgm, known
    perfectly; for a terrain the pose is required.
    """
    from pyharness.arc_check import check_on_drive, check_on_terrain, check_text
    from pyharness.messages import Arc
    from sim.terrain_io import read_terrain

    for name, values in (("time", [time_s or 0.0]), ("pose", pose or []), ("arc", arc)):
        if not all(math.isfinite(value) for value in values):
            raise HarnessError(f"--{name}: expected finite numbers")
    place = None if pose is None else (pose[0], pose[1], math.radians(pose[2]))
    asked = Arc(arc[0], math.radians(arc[1]))
    if file.suffix.lower() == ".dp":
        check = check_on_drive(file, asked, time_s, place)
    elif time_s is not None:
        raise HarnessError("--time: a terrain has none, only a drive (drive.dp) has")
    elif place is None:
        raise HarnessError("--pose: required for a terrain")
    else:
        check = check_on_terrain(read_terrain(file), asked, place)
    click.echo(check_text(check), nl=False)
    return _report(file, check.damage)
