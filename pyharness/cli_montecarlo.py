# SPDX-License-Identifier: Apache-2.0
"""`enav montecarlo`: campaigns of many drives."""

import time
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pyharness.errors import HarnessError
from sim.errors import SimError

if TYPE_CHECKING:
    from pyharness.workers import Workers

FOLDER = click.Path(path_type=Path)


@click.group("montecarlo")
def montecarlo() -> None:
    """Run many drives, and see what they say together."""


@montecarlo.command("run")
@click.argument("name", metavar="CAMPAIGN")
@click.option("-o", "out", type=FOLDER, required=True, help="Folder of the campaign.")
@click.option("--workers", type=click.IntRange(1, 1024), help="Drives at a time (one a core).")
@click.option("--scheduler", metavar="ADDRESS", help="Of a Dask cluster, to run them there.")
def run_command(name: str, out: Path, workers: int | None, scheduler: str | None) -> int:
    """Run a campaign: a YAML file, or `standard` or `planners`, which come along.

    Every drive runs in a process of its own. Finished drives are not run again: the same command
    goes on where it was stopped.
    """
    from pyharness.campaign import load_campaign
    from pyharness.drive_table import is_success
    from pyharness.montecarlo import run_campaign

    if workers is not None and scheduler is not None:
        raise click.UsageError("give --workers or --scheduler, not both")
    campaign = load_campaign(name)
    with _chosen(workers, scheduler) as pool, _Progress(campaign.drive_count) as progress:
        try:
            table, has_parquet = run_campaign(campaign, out, pool, progress.show)
        except KeyboardInterrupt:
            progress.stop()
            click.echo(f"enav: {progress.text}; the same command goes on from there", err=True)
            raise
        except (HarnessError, SimError) as error:
            if not progress.has_run:
                raise
            raise HarnessError(f"{error}; {progress.text}, the same command goes on") from error
    if not has_parquet:
        click.echo("enav: no drives.parquet: it needs the extra `export`", err=True)
    reached = sum(map(is_success, table.rows))
    click.echo(f"{reached} of {len(table.rows)} drives reached their goal")
    click.echo(f"{out}")
    return 0


@montecarlo.command("status")
@click.argument("folder", type=FOLDER)
def status_command(folder: Path) -> int:
    """Show how far a campaign is, and how its drives ended, cell by cell."""
    from pyharness import drive_table, tables
    from pyharness.montecarlo import status_rows

    click.echo(tables.to_text(status_rows(drive_table.load(folder))), nl=False)
    return 0


@montecarlo.command("report")
@click.argument("folder", type=FOLDER)
@click.option("-o", "out", type=FOLDER, required=True, help="PDF file.")
@click.option("--compare", "reference", type=FOLDER, help="Folder of a campaign to judge it by.")
def report_command(folder: Path, out: Path, reference: Path | None) -> int:
    """Write the report of a campaign; with --compare, whether it is better than another one."""
    from pyharness.report import write_report

    write_report(folder, out, reference)
    click.echo(f"{out}")
    return 0


def _chosen(workers: int | None, scheduler: str | None) -> "AbstractContextManager[Workers]":
    from pyharness.terrain_set import workers_default
    from pyharness.workers import dask_workers, local_workers

    if scheduler is not None:
        return dask_workers(scheduler)
    return local_workers(workers or workers_default())


class _Progress:
    """Shows drives done, rate, time left and successes, where there is a terminal to show it on."""

    def __init__(self, total: int) -> None:
        self._total = total
        self._done = self._reached = self._new = 0

    def __enter__(self) -> "_Progress":
        from rich.console import Console
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            Progress,
            TextColumn,
            TimeElapsedColumn,
        )

        console = Console(stderr=True)
        self._bar = Progress(
            TextColumn("drives"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TextColumn("{task.description}"),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
        self._task = self._bar.add_task("", total=self._total)
        self._start_s = time.monotonic()
        self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def stop(self) -> None:
        """Take the bar away."""
        self._bar.stop()

    @property
    def text(self) -> str:
        """How many are done."""
        return f"{self._done} of {self._total} drives are done"

    @property
    def has_run(self) -> bool:
        """Whether a drive was run now."""
        return self._new > 0

    def show(self, outcome: str, is_new: bool) -> None:
        """Count one drive."""
        from pyharness.records import Outcome

        self._done += 1
        self._new += is_new
        self._reached += Outcome(outcome).is_reached
        self._bar.update(self._task, completed=self._done, description=self._description())

    def _description(self) -> str:
        reached = f"{self._reached} reached"
        if not self._new:
            return reached
        seconds = (time.monotonic() - self._start_s) / self._new
        left_min = seconds * (self._total - self._done) / 60.0
        return f"{reached}, {60.0 / seconds:.1f} a minute, {left_min:.0f} min left"
