# SPDX-License-Identifier: Apache-2.0
"""What a campaign is held against: every requirement with what was measured."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from pyharness import report_blocks as blocks
from pyharness.campaign import Requirements, SuccessRequirement
from pyharness.campaign_statistics import Rate, Row, axis_key, by_cell, known, success
from pyharness.drive_table import is_success
from pyharness.report_names import COLUMNS, axis_title, axis_value, cell_text
from pyharness.report_sections import Check

AT_LEAST, AT_MOST = "≥", "≤"

Axes = Mapping[str, Sequence[Any]]

# requirement, column, what of it, whether a least value is asked for, unit
_EXTREMES = (
    ("clearance_min_m", "clearance_min_m", "belly clearance at every step", True, "m"),
    ("wheel_drop_max_m", "wheel_drop_max_m", "wheel drop at every step", False, "m"),
    ("tilt_max_deg", "tilt_max_rad", "tilt at every step", False, "deg"),
    ("rocker_max_deg", "rocker_max_rad", "rocker angle at every step", False, "deg"),
    ("bogie_max_deg", "bogie_max_rad", "bogie angle at every step", False, "deg"),
)


def requirement_checks(
    wanted: Requirements, rows: Sequence[Row], axes: Axes, variant: str
) -> list[Check]:
    """Judge the drives of one planner and parameter set; its name, if any, is said first."""
    checks = [_success(item, rows, axes) for item in wanted.success_rate_min]
    reached = [row for row in rows if is_success(row)]
    if wanted.path_inefficiency_mean_max is not None:
        most = wanted.path_inefficiency_mean_max
        checks.append(_mean("path_inefficiency", reached, most, False))
    if wanted.drive_rate_mean_min_m_per_h is not None:
        least = wanted.drive_rate_mean_min_m_per_h
        checks.append(_mean("drive_rate_m_per_h", reached, least, True))
    if wanted.violations_called_safe_max is not None:
        checks.append(_violations(rows, wanted.violations_called_safe_max))
    for name, column, title, is_least, unit in _EXTREMES:
        threshold = getattr(wanted, name)
        if threshold is not None:
            checks.append(_extreme(column, title, rows, threshold, is_least, unit))
    if not variant:
        return checks
    return [replace(item, requirement=f"{variant}: {item.requirement}") for item in checks]


def _success(wanted: SuccessRequirement, rows: Sequence[Row], axes: Axes) -> Check:
    """Judge every cell chosen by the one with the lowest rate; a cell without drives is no data."""
    chosen = {
        axis: [axis_key(value) for value in wanted.where.get(axis, values)]
        for axis, values in axes.items()
    }
    cells = list(itertools.product(*chosen.values()))
    own = by_cell(rows, list(axes))
    rates: list[tuple[Rate, str]] = [
        (rate, cell_text(cell, list(axes)))
        for cell in cells
        if (rate := success(own.get(cell, []))) is not None
    ]
    where = "; ".join(
        f"{axis_title(axis)} {', '.join(axis_value(axis, value) for value in values)}"
        for axis, values in chosen.items()
        if axis in wanted.where
    )
    title = f"success rate in every cell{f' of {where}' if where else ''}"
    threshold = f"{AT_LEAST} {100 * wanted.value:g} %"
    if not rates:
        return Check(title, threshold, blocks.NOTHING, blocks.NOTHING, None)
    worst, cell = min(rates, key=lambda item: item[0].share)
    measured = f"{blocks.percent(worst.share, 1)} ({worst.count}/{worst.total})"
    is_met: bool | None = worst.share >= wanted.value
    if is_met and len(rates) < len(cells):
        is_met = None
    if len(cells) > 1:
        measured += f" at {cell}"
    return Check(title, threshold, measured, blocks.interval(worst), is_met)


def _mean(column: str, reached: Sequence[Row], threshold: float, is_least: bool) -> Check:
    shown = COLUMNS[column]
    title = f"mean {shown.name} of drives that reached their goal"
    values = known(reached, column)
    limit = f"{AT_LEAST if is_least else AT_MOST} {shown.factor * threshold:g} {shown.unit}"
    if not values:
        return Check(title, limit, blocks.NOTHING, blocks.NOTHING, None)
    value = sum(values) / len(values)
    is_met = value >= threshold if is_least else value <= threshold
    measured = f"{blocks.number(shown.factor * value, shown.digits)} {shown.unit}"
    return Check(title, limit, f"{measured} (n = {len(values)})", blocks.NOTHING, is_met)


def _violations(rows: Sequence[Row], most: int) -> Check:
    title = "true limit violations on arcs called safe"
    values = known(rows, "violations_called_safe")
    if not values:
        return Check(title, f"{AT_MOST} {most}", blocks.NOTHING, blocks.NOTHING, None)
    count = int(sum(values))
    return Check(title, f"{AT_MOST} {most}", str(count), blocks.NOTHING, count <= most)


def _extreme(
    column: str, title: str, rows: Sequence[Row], threshold: float, is_least: bool, unit: str
) -> Check:
    shown = COLUMNS[column]
    limit = f"{AT_LEAST if is_least else AT_MOST} {threshold:g} {unit}"
    values = [shown.factor * value for value in known(rows, column)]
    if not values:
        return Check(title, limit, blocks.NOTHING, blocks.NOTHING, None)
    worst = min(values) if is_least else max(values)
    is_met = worst >= threshold if is_least else worst <= threshold
    measured = f"{blocks.number(worst, shown.digits)} {unit}"
    return Check(title, limit, measured, blocks.NOTHING, is_met)
