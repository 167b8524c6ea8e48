# SPDX-License-Identifier: Apache-2.0
"""Ground on which a settled rover leaves ACE's bounds: `python -m pyharness.tests.search_ace`.

Hill climbing with restarts over slope, waves, blocks, cones and steps near wheels and belly, over
pose and uncertainty: each climb has one quantity as its target; each step changes the ground a
little and keeps the change when that quantity comes nearer to its bound, or further beyond it.
Exits with 1 when a settled state left its bounds.
"""

import argparse
import json
import math
import os
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass

import numpy as np
import numpy.typing as npt

from pyharness.tests.ace_oracle import (
    INTERVALS,
    TOLERANCE,
    Trial,
    navlib_on,
    settler_on,
    try_poses,
)
from sim.terrain import Terrain, centred

SIDE_NODES = 100
RESOLUTION_M = 0.1
FEATURES = 6
POSES = 60
POSES_FOR_STEPS = 40
WAVES = 3
QUANTITIES = (*INTERVALS, "clearance_m", "wheel_drop_m", "tilt_rad")
# slope north and east; waves: amplitude, wave numbers, phase;
# features: shape, place, half sizes, height
GENES = 2 + 4 * WAVES + 6 * FEATURES
Genes = npt.NDArray[np.float64]


@dataclass(slots=True)
class Find:
    """The worst of one climb: of its target, and of all quantities with how to make it again."""

    seed: int
    target: str
    nearest: float = -math.inf
    worst: float = -math.inf
    what: str = ""
    tried: int = 0
    genes: Sequence[float] = ()
    stated: Sequence[float] = ()
    uncertainty: Sequence[float] = ()
    actual: Sequence[float] = ()

    def take(self, trial: Trial, genes: Genes) -> None:
        """Remember what is worse than anything before."""
        worst, names = trial.worst()
        k = int(np.argmax(worst))
        self.tried += int(np.sum(trial.is_bound))
        self.nearest = max(self.nearest, float(np.max(trial.excess()[self.target])))
        if worst[k] > self.worst:
            self.worst, self.what, self.genes = float(worst[k]), names[k], genes.tolist()
            self.stated, self.actual = trial.stated[k].tolist(), trial.actual[k].tolist()
            self.uncertainty = trial.uncertainty[k].tolist()


def first_genes(rng: np.random.Generator) -> Genes:
    """Draw ground that has a bit of everything."""
    slope = rng.uniform(-0.45, 0.45, 2) * rng.uniform(0.0, 1.0)
    waves = np.column_stack(
        [
            rng.uniform(0.0, 0.06, WAVES),
            rng.uniform(-3.0, 3.0, (WAVES, 2)),
            rng.uniform(-math.pi, math.pi, WAVES),
        ]
    )
    features = np.column_stack(
        [
            rng.uniform(0.0, 3.0, FEATURES),
            rng.uniform(-1.8, 1.8, (FEATURES, 2)),
            rng.uniform(0.05, 0.6, (FEATURES, 2)),
            rng.uniform(-0.3, 0.4, FEATURES),
        ]
    )
    return np.concatenate([slope, waves.ravel(), features.ravel()])


def mutated(genes: Genes, rng: np.random.Generator, scale: float) -> Genes:
    """Change some genes a little; now and then one a lot."""
    touched = rng.random(GENES) < 0.2
    touched[rng.integers(GENES)] = True
    fresh = first_genes(rng)
    if rng.random() < 0.15:
        return np.where(touched, fresh, genes)
    return np.asarray(genes + touched * scale * (fresh - first_genes(rng)))


def ground_of(genes: Genes) -> Terrain:
    """Make the ground."""
    axis_m = (np.arange(SIDE_NODES) - 0.5 * (SIDE_NODES - 1)) * RESOLUTION_M
    north, east = np.meshgrid(axis_m, axis_m, indexing="ij")
    up = genes[0] * north + genes[1] * east
    for amplitude, k_north, k_east, phase in genes[2 : 2 + 4 * WAVES].reshape(WAVES, 4):
        up += amplitude * np.sin(k_north * north + k_east * east + phase)
    for shape, x_m, y_m, half_x, half_y, height in genes[2 + 4 * WAVES :].reshape(FEATURES, 6):
        far = np.maximum(
            np.abs(north - x_m) / max(half_x, 0.02), np.abs(east - y_m) / max(half_y, 0.02)
        )
        kind = int(shape) % 3
        if kind == 0:
            up += np.where(far <= 1.0, height, 0.0)
        elif kind == 1:
            up += height * np.clip(1.0 - 0.5 * far, 0.0, 1.0)
        else:
            up += np.where(north > x_m, 0.5 * height, 0.0)
    return centred((-up).astype(np.float32), RESOLUTION_M)


def trial_of(genes: Genes, seed: int) -> Trial:
    """Settle around the middle of the ground; the same poses for the same seed."""
    rng = np.random.default_rng(seed)
    stated = np.column_stack(
        [rng.uniform(-0.25, 0.25, (POSES, 2)), rng.uniform(-math.pi, math.pi, POSES)]
    )
    stated[: POSES // 2, 2] = rng.normal(0.0, 0.1, POSES // 2)
    uncertainty = rng.uniform(0.0, 1.0, (POSES, 2)) * (0.1, 0.05)
    uncertainty[::2] = 0.0
    terrain = ground_of(genes)
    return try_poses(navlib_on(terrain), settler_on(terrain), stated, uncertainty, rng)


def climb(seed: int, steps: int) -> Find:
    """Climb from one start towards one quantity."""
    rng = np.random.default_rng(seed)
    genes = first_genes(rng)
    find = Find(seed, QUANTITIES[seed % len(QUANTITIES)])
    best = -math.inf
    for step in range(steps):
        if step % POSES_FOR_STEPS == 0:
            best = -math.inf  # other poses: start over from the ground that is reached
        candidate = mutated(genes, rng, 0.3 * 0.99**step + 0.01) if step else genes
        trial = trial_of(candidate, seed * steps + step // POSES_FOR_STEPS)
        reached = float(np.max(trial.excess()[find.target]))
        if reached > best:
            best, genes = reached, candidate
        find.take(trial, candidate)
    return find


def main() -> int:
    """Climb from many starts for a given time."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=120.0)
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    finds: list[Find] = []
    end_s = time.monotonic() + options.seconds
    seed = options.seed * 1_000_000
    with ProcessPoolExecutor(options.workers) as pool:
        while time.monotonic() < end_s:
            batch = range(seed, seed + len(QUANTITIES))
            finds += pool.map(climb, batch, [options.steps] * len(batch))
            seed = batch.stop
    finds.sort(key=lambda find: -find.worst)
    broken = [find for find in finds if find.worst > TOLERANCE]
    sys.stdout.write(
        f"{len(finds)} climbs, {sum(find.tried for find in finds)} certified poses:"
        f" {len(broken)} climbs found a state outside its bounds"
        f" (tolerance {TOLERANCE:g} m or rad)\n"
    )
    for name in QUANTITIES:
        nearest = max((find.nearest for find in finds if find.target == name), default=-math.inf)
        sys.stdout.write(f"  {name:16} nearest to its bound {nearest:10.2e}\n")
    for find in broken[:5]:
        sys.stdout.write(f"  {json.dumps(asdict(find))}\n")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
