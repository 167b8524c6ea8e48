# SPDX-License-Identifier: Apache-2.0
"""ACE's guarantee in bulk: `python -m pyharness.tests.verify_ace --poses 1000000`.

Random poses on random ground (rocks of CFA 5-20 %, slopes of 0-25 deg, real ground where
ENAV_TEST_DATA is set), half of them with position and yaw uncertainty. Every settled state must lie
inside the bounds that ACE certified. Also told: the share of truly safe poses that ACE refuses, and
for which bound. Writes build/verify_ace.json; exits with 1 when a promise was broken.
"""

import argparse
import json
import math
import os
import sys
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from pyharness.params import param_values
from pyharness.status import Reason
from pyharness.tests.ace_oracle import TOLERANCE, is_truly_safe, navlib_on, settler_on, try_poses
from sim.generate import TerrainRecipe, generate

MAP_M = 11.0  # poses this far from the middle see only known terrain
SIZE_M = 40.0
POSES_PER_TERRAIN = 1000
CFAS = (0.05, 0.07, 0.10, 0.12, 0.15, 0.20)
SLOPES_DEG = (0.0, 5.0, 10.0, 15.0, 20.0, 25.0)
POSITION_M = 0.10
YAW_RAD = 0.05
# file, half the width from which middles are drawn
REAL_GROUND = (("marias_pass_025m.pgm", 38.0), ("gale_hirise_1m.pgm", 140.0))


@dataclass
class Count:
    """What happened to the poses of one kind of ground."""

    poses: int = 0
    settled: int = 0
    certified: int = 0
    accepted: int = 0
    safe: int = 0
    safe_refused: Counter[str] = field(default_factory=Counter)

    def add(self, other: "Count") -> None:
        """Take in the poses of another count."""
        for name in ("poses", "settled", "certified", "accepted", "safe"):
            setattr(self, name, getattr(self, name) + getattr(other, name))
        self.safe_refused.update(other.safe_refused)


@dataclass(frozen=True, slots=True)
class Job:
    """One terrain and the poses on it."""

    label: str
    slope_deg: float
    recipe: dict[str, Any]
    poses: int


@dataclass(frozen=True, slots=True)
class Answer:
    """Counts without and with uncertainty, violations, and the largest overshoots."""

    job: Job
    exact: Count
    uncertain: Count
    violations: list[dict[str, Any]]
    worst: float
    across: list[float]  # overshoots of wheel drop across a neighbouring cell's plane


def jobs_of(poses: int, seed: int) -> Iterator[Job]:
    """Yield terrains, every CFA x slope in turn, and real ground with and without rocks."""
    data = os.environ.get("ENAV_TEST_DATA")
    cells: list[tuple[str, float, dict[str, Any]]] = [
        (f"cfa {cfa:.0%}", slope, {"cfa": cfa, "slope_deg": slope})
        for slope in SLOPES_DEG
        for cfa in CFAS
    ]
    for name, _ in REAL_GROUND if data else ():
        assert data
        path = str(Path(data) / name)
        cells += [
            ("real", 0.0, {"base_file": path}),
            ("real + 10%", 0.0, {"base_file": path, "cfa": 0.10}),
        ]
    for index in range(math.ceil(poses / POSES_PER_TERRAIN)):
        label, slope, recipe = cells[index % len(cells)]
        place = {}
        if "base_file" in recipe:
            half_m = dict(REAL_GROUND)[Path(recipe["base_file"]).name]
            rng = np.random.default_rng([seed, index])
            place = {"base_center_m": tuple(rng.uniform(-half_m, half_m, 2).round(2).tolist())}
        count = min(POSES_PER_TERRAIN, poses - index * POSES_PER_TERRAIN)
        yield Job(
            label,
            slope,
            {**recipe, **place, "size_m": SIZE_M, "seed": seed * 100_000 + index},
            count,
        )


def run(job: Job) -> Answer:
    """Try the poses of one terrain."""
    terrain = generate(TerrainRecipe(**job.recipe))
    rng = np.random.default_rng(job.recipe["seed"])
    count = job.poses
    stated = np.column_stack(
        [rng.uniform(-MAP_M, MAP_M, (count, 2)), rng.uniform(-math.pi, math.pi, count)]
    )
    uncertainty = rng.uniform(0.0, 1.0, (count, 2)) * (POSITION_M, YAW_RAD)
    uncertainty[::2] = 0.0
    trial = try_poses(navlib_on(terrain), settler_on(terrain), stated, uncertainty, rng)
    worst, names = trial.worst()
    violations = [
        {
            "what": names[k],
            "by": float(worst[k]),
            "recipe": job.recipe,
            "stated": trial.stated[k].tolist(),
            "uncertainty": trial.uncertainty[k].tolist(),
            "actual": trial.actual[k].tolist(),
            "accepted": bool(trial.bounds["reason"][k] == Reason.NONE),
        }
        for k in np.flatnonzero(worst > TOLERANCE)
    ]
    safe = is_truly_safe(trial.states, param_values({})) & (trial.states["converged"] == 1)
    accepted = trial.bounds["reason"] == Reason.NONE
    counts = []
    for part in (slice(0, None, 2), slice(1, None, 2)):
        refused = trial.bounds["reason"][part][safe[part] & ~accepted[part]]
        counts.append(
            Count(
                poses=len(safe[part]),
                settled=int(np.sum(trial.states["converged"][part] == 1)),
                certified=int(np.sum(trial.bounds["is_certified"][part])),
                accepted=int(np.sum(accepted[part])),
                safe=int(np.sum(safe[part])),
                safe_refused=Counter(Reason(int(reason)).name for reason in refused),
            )
        )
    across = trial.drop_across_planes()
    return Answer(
        job,
        counts[0],
        counts[1],
        violations,
        float(np.max(worst)),
        across[across > TOLERANCE].tolist(),
    )


HEADINGS = ("poses", "certified", "truly safe", "accepted", "safe but refused")


def table(title: str, counts: dict[str, Count]) -> str:
    """Return one table of counts."""
    reasons = sorted({reason for count in counts.values() for reason in count.safe_refused})
    lines = [title, f"{'':12}" + "".join(f"{name:>18}" for name in HEADINGS + tuple(reasons))]
    for label, count in counts.items():
        safe = max(count.safe, 1)
        cells = [
            f"{count.poses}",
            f"{count.certified / max(count.poses, 1):.3%}",
            f"{count.safe / max(count.poses, 1):.1%}",
            f"{count.accepted / max(count.poses, 1):.1%}",
            f"{sum(count.safe_refused.values()) / safe:.1%}",
            *(f"{count.safe_refused[reason] / safe:.2%}" for reason in reasons),
        ]
        lines.append(f"{label:12}" + "".join(f"{cell:>18}" for cell in cells))
    return "\n".join(lines) + "\n\n"


def grouped(answers: list[Answer], key: str, kind: str) -> dict[str, Count]:
    """Add up the counts of equal labels or slopes, and of all."""
    groups: dict[str, Count] = {}
    for answer in answers:
        for label in (f"{getattr(answer.job, key)}", "all"):
            groups.setdefault(label, Count()).add(getattr(answer, kind))
    groups["all"] = groups.pop("all")
    return groups


def main() -> int:
    """Run all jobs, print the tables, write the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--poses", type=int, default=1_000_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("-o", "--out", type=Path, default=Path("build/verify_ace.json"))
    options = parser.parse_args()
    jobs = list(jobs_of(options.poses, options.seed))
    with ProcessPoolExecutor(options.workers) as pool:
        answers = list(pool.map(run, jobs, chunksize=1))
    violations = [violation for answer in answers for violation in answer.violations]
    show = sys.stdout.write
    show(table("without uncertainty", grouped(answers, "label", "exact")))
    show(table("with uncertainty", grouped(answers, "label", "uncertain")))
    show(table("without uncertainty, by slope in deg", grouped(answers, "slope_deg", "exact")))
    tried = sum(answer.exact.certified + answer.uncertain.certified for answer in answers)
    show(
        f"{options.poses} poses on {len(jobs)} terrains, {tried} with certified bounds:"
        f" {len(violations)} states outside their bounds"
        f" (95 % upper bound of the rate {3.0 / max(tried, 1):.1e} when none);"
        f" nearest approach {max(answer.worst for answer in answers):.2e}"
        f" (tolerance {TOLERANCE:g} m or rad)\n"
    )
    across = [excess for answer in answers for excess in answer.across]
    show(
        f"wheel drop across the plane of a neighbouring cell, where the rover stood there:"
        f" {len(across)} beyond the bound, by at most {max(across, default=0.0):.3f} m\n"
    )
    for violation in violations[:20]:
        show(f"  {json.dumps(violation)}\n")
    everything = Count()
    for answer in answers:
        everything.add(answer.exact)
        everything.add(answer.uncertain)
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(
        json.dumps(
            {
                "poses": everything.poses,
                "certified": everything.certified,
                "violations": violations,
                "tables": {
                    kind: {
                        label: {**vars(count), "safe_refused": dict(count.safe_refused)}
                        for label, count in grouped(answers, "label", kind).items()
                    }
                    for kind in ("exact", "uncertain")
                },
            },
            indent=1,
        )
    )
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())
