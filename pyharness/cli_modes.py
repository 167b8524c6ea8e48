# SPDX-License-Identifier: Apache-2.0
"""`enav modes`: one scenario in each of the four Go To modes."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click

from pyharness.cli_types import Assignment


@click.command("modes")
@click.option(
    "--scenario",
    "scenario_file",
    type=click.Path(path_type=Path),
    help="YAML file; without it, rocks and a keep-out zone on the straight line.",
)
@click.option("--set", "settings", type=Assignment(), multiple=True, help="Scenario key = value.")
@click.option("--seed", type=int, help="Of terrain and noise.")
@click.option("--force", is_flag=True, help="Replace finished drives.")
@click.option("-o", "out", type=click.Path(path_type=Path), help="Folder (drives/NAME-SEED).")
def modes_command(
    scenario_file: Path | None,
    settings: tuple[tuple[str, str], ...],
    seed: int | None,
    force: bool,
    out: Path | None,
) -> int:
    """Drive one scenario in all four modes and draw the four tracks.

    The folder holds a drive for every mode, and modes.png.
    """
    from pyharness.examples import example
    from pyharness.modes import drive_modes
    from pyharness.scenario import check_places, load_scenario, make_terrain

    overrides: dict[str, object] = dict(settings)
    if seed is not None:
        overrides["seed"] = seed
    path = scenario_file or example("four_modes")
    scenario = load_scenario(path, overrides)
    terrain = make_terrain(scenario)
    check_places(scenario, terrain, path, overrides)
    folder = out or Path("drives") / f"{scenario.name}-{scenario.seed}"

    def report(mode: str, summary: Mapping[str, Any]) -> None:
        detail = summary["fault_detail"]
        text = f"{mode:9}  {summary['outcome']}: {summary['distance_driven_m']:.1f} m"
        click.echo(f"{text}  {detail}".rstrip())

    click.echo(str(drive_modes(scenario, terrain, folder, force, report)))
    return 0
