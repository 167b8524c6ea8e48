# SPDX-License-Identifier: Apache-2.0
"""Drives on the same terrains with the same seeds, pair by pair: what got better, what worse.

The test over all pairs decides whether drives reach their goal more or less often: McNemar's,
exact, on the pairs of which one drive reached it. Those of single cells, and those of the metrics,
are many: their p values are Holm's, so that all of a table together err as seldom as one does.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import stats

from pyharness.campaign_statistics import CONFIDENCE, Cell, Row, cell_of
from pyharness.drive_table import is_success

ALPHA = 0.05
RESAMPLES = 2000
BOOTSTRAP_SEED = 0

METRICS = (
    "path_inefficiency",
    "drive_rate_m_per_h",
    "ace_evaluations_mean",
    "overthink_rate",
    "clearance_min_m",
    "wheel_drop_max_m",
    "tilt_max_rad",
    "rocker_max_rad",
    "bogie_max_rad",
)
"""What is compared between drives that both reached their goal."""

Pair = tuple[Row, Row]
"""The drive of the reference, and that of what is judged."""


# ------------------------------------------------------------------ tests


@dataclass(frozen=True, slots=True)
class McNemar:
    """Pairs by which of the two drives did something, and the exact two-sided p of a difference.

    Attributes:
        both: Both drives did.
        only_before: Only the reference's.
        only_after: Only the other.
        neither: None.
    """

    both: int
    only_before: int
    only_after: int
    neither: int
    p: float

    @property
    def pairs(self) -> int:
        """How many there are."""
        return self.both + self.only_before + self.only_after + self.neither

    @property
    def difference(self) -> float:
        """How much the share has grown."""
        return (self.only_after - self.only_before) / self.pairs


def mcnemar(pairs: Sequence[tuple[bool, bool]]) -> McNemar:
    """Test whether one of two drives does something more often than the other."""
    only_before = sum(before and not after for before, after in pairs)
    only_after = sum(after and not before for before, after in pairs)
    both = sum(before and after for before, after in pairs)
    discordant = only_before + only_after
    p = float(stats.binomtest(only_before, discordant, 0.5).pvalue) if discordant else 1.0
    neither = len(pairs) - both - discordant
    return McNemar(both, only_before, only_after, neither, p)


@dataclass(frozen=True, slots=True)
class Difference:
    """Means of a metric over pairs, their difference with a bootstrap interval, Wilcoxon's p."""

    metric: str
    pairs: int
    before: float
    after: float
    low: float
    high: float
    p: float

    @property
    def difference(self) -> float:
        """How much the mean has grown."""
        return self.after - self.before


def paired_difference(
    metric: str, before: npt.NDArray[np.float64], after: npt.NDArray[np.float64]
) -> Difference:
    """Compare a metric between the two drives of each pair [n]."""
    grown = after - before
    rng = np.random.default_rng(BOOTSTRAP_SEED)
    means = np.array([rng.choice(grown, len(grown)).mean() for _ in range(RESAMPLES)])
    tail = (1.0 - CONFIDENCE) / 2.0
    low, high = np.quantile(means, (tail, 1.0 - tail))
    moved = grown[grown != 0.0]
    p = float(stats.wilcoxon(moved).pvalue) if len(moved) else 1.0
    return Difference(
        metric, len(grown), float(before.mean()), float(after.mean()), float(low), float(high), p
    )


def holm(p_values: Sequence[float]) -> list[float]:
    """Return p values that hold for all of a family together."""
    corrected = [1.0] * len(p_values)
    largest = 0.0
    for rank, index in enumerate(sorted(range(len(p_values)), key=lambda item: p_values[item])):
        largest = max(largest, min(1.0, (len(p_values) - rank) * p_values[index]))
        corrected[index] = largest
    return corrected


# ------------------------------------------------------------------ comparison


@dataclass(frozen=True, slots=True)
class CellResult:
    """One cell: its pairs, and p corrected for the number of cells."""

    cell: Cell
    test: McNemar
    p_holm: float


@dataclass(frozen=True, slots=True)
class MetricResult:
    """One metric: its pairs, and p corrected for the number of metrics."""

    difference: Difference
    p_holm: float


@dataclass(frozen=True, slots=True)
class Comparison:
    """What is judged against its reference.

    Attributes:
        pairs: Cell by cell.
        left_out_before: Drives of the reference without a partner.
        left_out_after: Drives without a partner in the reference.
        success: Over all pairs: who reached the goal.
        violations: Over all pairs that tell: who violated a true limit on an arc called safe.
        cells: Success in every cell that has pairs.
        metrics: Of pairs that both reached the goal.
        gained: Pairs of which only the judged drive reached the goal.
        lost: Pairs of which only the reference's did.
    """

    pairs: list[Pair]
    left_out_before: list[Row]
    left_out_after: list[Row]
    success: McNemar
    violations: McNemar
    cells: list[CellResult]
    metrics: list[MetricResult]
    gained: list[Pair]
    lost: list[Pair]


def compare(before: Sequence[Row], after: Sequence[Row], axes: Sequence[str]) -> Comparison:
    """Compare drives of one planner and parameter set each, paired by cell and seed."""

    def place(row: Row) -> tuple[Any, ...]:
        return (*cell_of(row, axes), row["seed"])

    references = {place(row): row for row in before}
    pairs = [(references[place(row)], row) for row in after if place(row) in references]
    taken = {place(row) for _, row in pairs}
    return Comparison(
        pairs=pairs,
        left_out_before=[row for row in before if place(row) not in taken],
        left_out_after=[row for row in after if place(row) not in taken],
        success=_test(pairs, is_success),
        violations=_test(
            [pair for pair in pairs if _both_know(pair, "violations_called_safe")],
            lambda row: bool(row["violations_called_safe"]),
        ),
        cells=_cells(pairs, axes),
        metrics=_metrics(pairs),
        gained=[pair for pair in pairs if is_success(pair[1]) and not is_success(pair[0])],
        lost=[pair for pair in pairs if is_success(pair[0]) and not is_success(pair[1])],
    )


def _test(pairs: Sequence[Pair], holds: Callable[[Row], bool]) -> McNemar:
    return mcnemar([(holds(before), holds(after)) for before, after in pairs])


def _both_know(pair: Pair, column: str) -> bool:
    return all(row.get(column) is not None for row in pair)


def _cells(pairs: Sequence[Pair], axes: Sequence[str]) -> list[CellResult]:
    cells: dict[Cell, list[Pair]] = {}
    for pair in pairs:
        cells.setdefault(cell_of(pair[1], axes), []).append(pair)
    tests = {cell: _test(own, is_success) for cell, own in cells.items()}
    corrected = holm([test.p for test in tests.values()])
    return [
        CellResult(cell, test, p_holm)
        for (cell, test), p_holm in zip(tests.items(), corrected, strict=True)
    ]


def _metrics(pairs: Sequence[Pair]) -> list[MetricResult]:
    reached = [pair for pair in pairs if all(map(is_success, pair))]
    results = []
    for metric in METRICS:
        own = [pair for pair in reached if _both_know(pair, metric)]
        if own:
            values = np.array([[float(row[metric]) for row in pair] for pair in own])
            results.append(paired_difference(metric, values[:, 0], values[:, 1]))
    corrected = holm([result.p for result in results])
    return [MetricResult(*item) for item in zip(results, corrected, strict=True)]
