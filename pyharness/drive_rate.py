# SPDX-License-Identifier: Apache-2.0
"""Thinking while driving against stopping to think, on the same terrains: `make drive-rate`.

Both with flight-like compute times. Writes build/drive_rate.json and prints a Markdown table.
"""

import json
import sys
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path

import click

from pyharness.dp import native_schema
from pyharness.drive import drive
from pyharness.history import History
from pyharness.metrics import summarize
from pyharness.planners.enav import Enav
from pyharness.records import RecordStream
from pyharness.scenario import drive_info, load_scenario, make_terrain
from pyharness.status import Activity

# mean speeds of autonomous drives, by JPL's page on the mobility of Mars 2020
PUBLISHED = {"while_driving": "about 110 (Perseverance)", "standing": "15-18 (Curiosity)"}


@dataclass(frozen=True, slots=True)
class Rate:
    """One drive."""

    thinking: str
    seed: int
    outcome: str
    distance_m: float
    duration_s: float
    driving_s: float
    steering_s: float
    standing_s: float
    arcs: int


def measure(thinking: str, seed: int, cfa: float) -> Rate:
    """Run one drive of 80 m on level ground and add up what the wheels did."""
    overrides = {"seed": seed, "terrain.cfa": cfa, "executive.thinking": thinking}
    scenario = load_scenario(None, overrides)
    history = History(native_schema(), drive_info(scenario))
    drive(scenario, make_terrain(scenario), Enav, RecordStream([history.take]))
    summary = summarize(history)

    def lane_s(activity: int) -> float:
        bars = (item for item in history.timeline if int(item["activity"]) == activity)
        return sum(float(item["end_s"] - item["start_s"]) for item in bars)

    return Rate(
        thinking,
        seed,
        str(summary["outcome"]),
        float(summary["distance_driven_m"]),
        float(summary["duration_sim_s"]),
        lane_s(Activity.DRIVING),
        lane_s(Activity.STEERING),
        lane_s(Activity.WAITING),
        int(summary["planning_cycles"]),
    )


def table(rates: Iterable[Rate]) -> str:
    """Return the figures of both ways side by side; all drives count, also those that fail."""
    lines = [
        "| thinking | goal reached | drive rate, m/h (least to most) | driving | steering"
        " | standing | standing per arc, s | published, m/h |",
        "|---|---|---|---|---|---|---|---|",
    ]
    rates = list(rates)
    for thinking, published in PUBLISHED.items():
        some = [rate for rate in rates if rate.thinking == thinking]
        all_s = sum(rate.duration_s for rate in some)
        per_h = sorted(3600.0 * rate.distance_m / rate.duration_s for rate in some)
        mean = 3600.0 * sum(rate.distance_m for rate in some) / all_s
        shares = [
            sum(getattr(rate, name) for rate in some) / all_s
            for name in ("driving_s", "steering_s", "standing_s")
        ]
        standing_s = sum(rate.standing_s for rate in some) / sum(rate.arcs for rate in some)
        cells = [
            thinking.replace("_", " "),
            f"{sum(rate.outcome == 'goal_reached' for rate in some)} of {len(some)}",
            f"{mean:.0f} ({per_h[0]:.0f} to {per_h[-1]:.0f})",
            *(f"{100 * share:.0f} %" for share in shares),
            f"{standing_s:.1f}",
            published,
        ]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


@click.command()
@click.option("--terrains", "count", type=click.IntRange(1), default=20, show_default=True)
@click.option("--cfa", type=click.FloatRange(0, 0.4), default=0.07, show_default=True)
@click.option("--workers", type=click.IntRange(1), default=2, show_default=True)
@click.option("-o", "out", type=click.Path(path_type=Path), default=Path("build/drive_rate.json"))
def main(count: int, cfa: float, workers: int, out: Path) -> None:
    """Measure the drive rate with both ways of thinking on the same terrains."""
    tasks = [(thinking, seed, cfa) for seed in range(count) for thinking in PUBLISHED]
    rates = []
    with ProcessPoolExecutor(workers) as pool:
        for number, rate in enumerate(pool.map(measure, *zip(*tasks, strict=True)), start=1):
            rates.append(rate)
            click.echo(f"{number} of {len(tasks)}: {rate.thinking}, seed {rate.seed}", err=True)
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(json.dumps([asdict(rate) for rate in rates], indent=1) + "\n", "utf-8")
    click.echo(table(rates))


if __name__ == "__main__":
    sys.exit(main())
