# SPDX-License-Identifier: Apache-2.0
"""Numbers of a campaign from the rows of its drives: rates, means, outcomes, rejections."""

import json
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import stats

from pyharness.drive_table import is_success
from pyharness.records import Outcome

CONFIDENCE = 0.95

Row = dict[str, Any]
Cell = tuple[Any, ...]
"""Values of the axes, in their order."""

_LAST_REJECTIONS = re.compile(r"paths rejected: (?P<counts>[a-z_]+ \d+(?:, [a-z_]+ \d+)*)")
REJECTIONS_PREFIX = "rejections_"
# a dearer path was passed over, or there was no time: neither is why a rover finds no path
NOT_A_CAUSE = frozenset({"cost", "budget"})


# ------------------------------------------------------------------ rates and means


@dataclass(frozen=True, slots=True)
class Rate:
    """A share of drives with its Wilson interval of 95 %."""

    count: int
    total: int
    low: float
    high: float

    @property
    def share(self) -> float:
        """The measured value."""
        return self.count / self.total


def wilson(count: int, total: int) -> Rate | None:
    """Return a rate with its Wilson interval; None of nothing."""
    if total == 0:
        return None
    interval = stats.binomtest(count, total).proportion_ci(CONFIDENCE, method="wilson")
    return Rate(count, total, float(interval.low), float(interval.high))


def success(rows: Sequence[Row]) -> Rate | None:
    """Return the share of drives that reached their goal."""
    return wilson(sum(map(is_success, rows)), len(rows))


@dataclass(frozen=True, slots=True)
class Mean:
    """A mean with the number of drives that it is of."""

    value: float
    count: int


def known(rows: Sequence[Row], column: str) -> list[float]:
    """Return the numbers of a column; drives that could not tell theirs have none."""
    return [float(row[column]) for row in rows if row.get(column) is not None]


def mean(rows: Sequence[Row], column: str) -> Mean | None:
    """Return the mean of a column over the drives that have it."""
    values = known(rows, column)
    return Mean(float(np.mean(values)), len(values)) if values else None


def most_per_metre(events: int, distance_m: float) -> float | None:
    """Return the rate of rare events that is, with 95 % confidence, not exceeded (Poisson)."""
    if distance_m <= 0.0:
        return None
    return float(stats.chi2.ppf(CONFIDENCE, 2 * (events + 1))) / 2.0 / distance_m


# ------------------------------------------------------------------ cells


def axis_key(value: Any) -> Any:
    """Return a value of an axis such that it can name a cell: lists and mappings as text."""
    return json.dumps(value) if isinstance(value, list | tuple | dict) else value


def cell_of(row: Row, axes: Sequence[str]) -> Cell:
    """Return where on the axes a drive lies."""
    return tuple(axis_key(row[axis]) for axis in axes)


def in_order(row: Row, axes: Sequence[str]) -> tuple[Any, ...]:
    """Return what sorts drives by cell, lowest first, then by seed."""
    cell = [
        (0, float(value), "") if isinstance(value, int | float) else (1, 0.0, str(value))
        for value in cell_of(row, axes)
    ]
    return (*cell, row["seed"])


def by_cell(rows: Sequence[Row], axes: Sequence[str]) -> dict[Cell, list[Row]]:
    """Return the drives of every cell, cells in the order in which they first come."""
    cells: dict[Cell, list[Row]] = {}
    for row in rows:
        cells.setdefault(cell_of(row, axes), []).append(row)
    return cells


def outcome_counts(rows: Sequence[Row]) -> dict[str, int]:
    """Return how many drives ended how: reached ones first, then the most frequent."""
    counts = Counter(str(row["outcome"]) for row in rows)
    ranked = sorted(counts, key=lambda name: (not Outcome(name).is_reached, -counts[name], name))
    return {name: counts[name] for name in ranked}


# ------------------------------------------------------------------ why there was no path


@dataclass(frozen=True, slots=True)
class Causes:
    """Why drives found no path, by rejection reason.

    Attributes:
        drives: That ended without a path.
        main_at_end: Drives in whose last refusal the reason was the most frequent one.
        main_overall: The same over all planning cycles of the drive.
        paths_at_end: Paths rejected in the last refusals.
        paths_overall: Paths rejected in all planning cycles.
    """

    drives: int
    main_at_end: Counter[str]
    main_overall: Counter[str]
    paths_at_end: Counter[str]
    paths_overall: Counter[str]

    @property
    def reasons(self) -> list[str]:
        """All reasons that occurred, what ended most drives first."""
        names = set(self.paths_at_end) | set(self.paths_overall)
        return sorted(
            names,
            key=lambda name: (
                -self.main_at_end[name], -self.main_overall[name],
                -self.paths_at_end[name], -self.paths_overall[name], name,
            ),
        )  # fmt: skip


def no_path_causes(rows: Sequence[Row]) -> Causes:
    """Return why the drives that ended without a path did."""
    lost = [row for row in rows if row["outcome"] == "no_path"]
    causes = Causes(len(lost), Counter(), Counter(), Counter(), Counter())
    for row in lost:
        for counts, main, paths in (
            (last_rejections(str(row["fault_detail"])), causes.main_at_end, causes.paths_at_end),
            (all_rejections(row), causes.main_overall, causes.paths_overall),
        ):
            paths.update(counts)
            if counts:
                main[min(counts, key=lambda name: (-counts[name], name))] += 1
    return causes


def last_rejections(fault_detail: str) -> dict[str, int]:
    """Return the paths that the last refusal of a drive rejected, by reason."""
    found = _LAST_REJECTIONS.search(fault_detail)
    pairs = [part.split(" ") for part in found["counts"].split(", ")] if found else []
    return _causes({name: int(count) for name, count in pairs})


def all_rejections(row: Row) -> dict[str, int]:
    """Return the paths rejected over all planning cycles of a drive, by reason."""
    return _causes(
        {
            name.removeprefix(REJECTIONS_PREFIX).lower(): int(count)
            for name, count in row.items()
            if name.startswith(REJECTIONS_PREFIX) and count is not None
        }
    )


def _causes(counts: Mapping[str, int]) -> dict[str, int]:
    return {name: count for name, count in counts.items() if count and name not in NOT_A_CAUSE}


# ------------------------------------------------------------------ safety

CALLED_SAFE, LEAVING, ELSEWHERE = "called safe", "leave limits", "elsewhere"


@dataclass(frozen=True, slots=True)
class Safety:
    """Metres driven by what Navlib had said of the arc, and true limit violations.

    Attributes:
        called_safe_m: On arcs that passed in a mode that tests terrain.
        leaving_m: On arcs that passed under the leave limits.
        elsewhere_m: All others: the crawl at the start, modes that do not test terrain.
        violations: Drives that a true limit violation ended, by where.
        silent: Drives that could not tell: crashed, timed out, killed.
    """

    called_safe_m: float
    leaving_m: float
    elsewhere_m: float
    violations: Mapping[str, Sequence[Row]]
    silent: int


def safety(rows: Sequence[Row]) -> Safety:
    """Return how true Navlib's word was."""
    telling = [row for row in rows if row.get("distance_called_safe_m") is not None]
    called_safe_m = sum(known(telling, "distance_called_safe_m"))
    leaving_m = sum(known(telling, "distance_leaving_m"))
    driven_m = sum(known(telling, "distance_driven_m"))
    violations: dict[str, list[Row]] = {CALLED_SAFE: [], LEAVING: [], ELSEWHERE: []}
    for row in rows:
        if where := violation_place(row):
            violations[where].append(row)
    elsewhere_m = max(0.0, driven_m - called_safe_m - leaving_m)
    return Safety(called_safe_m, leaving_m, elsewhere_m, violations, len(rows) - len(telling))


def violation_place(row: Row) -> str | None:
    """Return on what kind of arc a true limit violation ended a drive; None without one."""
    if row["outcome"] != "limit_violation":
        return None
    if row.get("violations_called_safe"):
        return CALLED_SAFE
    return LEAVING if row.get("violations_leaving") else ELSEWHERE
