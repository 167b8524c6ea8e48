# SPDX-License-Identifier: Apache-2.0
"""`enav compare`: planners on the same terrains."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from pyharness.errors import OutputError

if TYPE_CHECKING:
    from pyharness.compare import Job


@click.command("compare")
@click.option("-o", "out", type=click.Path(path_type=Path), required=True, help="Folder.")
@click.option("--seeds", type=click.IntRange(1, 10000), default=10, help="Per kind of terrain.")
@click.option("--first-seed", type=click.IntRange(0), default=0, help="The lowest one.")
@click.option(
    "--planner",
    "planners",
    multiple=True,
    help="As in `enav drive`; may be repeated (all that come with the simulator).",
)
@click.option("--workers", type=click.IntRange(1, 1024), default=1, help="Drives at a time.")
def compare(out: Path, seeds: int, first_seed: int, planners: tuple[str, ...], workers: int) -> int:
    """Drive planners over the same terrains: CFA 7 and 10 %, slopes of 0 and 5 deg, 10 seeds each.

    Writes table.md and drives.csv into the folder. Finished drives are not run again.
    """
    from pyharness.compare import (
        VARIANTS,
        check_jobs,
        comparison_jobs,
        run_comparison,
        write_tables,
    )

    jobs = comparison_jobs(out, planners or list(VARIANTS), range(first_seed, first_seed + seeds))
    check_jobs(jobs)
    try:
        out.mkdir(parents=True, exist_ok=True)
        results = run_comparison(jobs, workers, _Progress(len(jobs)).show)
        click.echo(write_tables(out, results), nl=False)
    except OSError as error:
        raise OutputError(f"{error.filename or out}: {error.strerror}") from error
    return 0


class _Progress:
    """Tells of every drive that is done."""

    def __init__(self, total: int) -> None:
        self._total = total
        self._count = 0

    def show(self, job: "Job", is_new: bool) -> None:
        self._count += 1
        if is_new:
            click.echo(f"{self._count}/{self._total} {job.planner} {job.folder.name}", err=True)
