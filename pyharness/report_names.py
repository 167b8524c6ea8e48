# SPDX-License-Identifier: Apache-2.0
"""What people call the axes, cells, planners and metrics of a campaign."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from pyharness.campaign_statistics import Cell, Row

# name, unit, factor from the scenario's unit
_AXES = {"terrain.cfa": ("CFA", "%", 100.0), "terrain.slope_deg": ("slope", "deg", 1.0)}


def axis_title(axis: str) -> str:
    """Return the name of an axis."""
    return _AXES[axis][0] if axis in _AXES else axis


def axis_value(axis: str, value: Any) -> str:
    """Return a value of an axis with its unit."""
    if axis in _AXES:
        _, unit, factor = _AXES[axis]
        return f"{factor * value:g} {unit}"
    return f"{value:g}" if isinstance(value, float) else str(value)


def axis_titles(axes: Sequence[str]) -> list[str]:
    """Return headings of columns for the axes, with units."""
    return [f"{_AXES[axis][0]}, {_AXES[axis][1]}" if axis in _AXES else axis for axis in axes]


def axis_numbers(cell: Cell, axes: Sequence[str]) -> list[str]:
    """Return the values of a cell without units."""
    return [
        axis_value(axis, value).removesuffix(f" {_AXES[axis][1]}" if axis in _AXES else "")
        for axis, value in zip(axes, cell, strict=True)
    ]


def cell_text(cell: Cell, axes: Sequence[str]) -> str:
    """Return the name of a cell."""
    parts = [
        f"{axis_title(axis)} {axis_value(axis, value)}"
        for axis, value in zip(axes, cell, strict=True)
    ]
    return ", ".join(parts) or "all"


VariantKey = tuple[str, str]
"""Planner and parameter set."""


def variant_of(row: Row) -> VariantKey:
    """Return whose drive it is."""
    return str(row["planner"]), str(row["parameter_set"] or "")


def variant_text(key: VariantKey, others: Sequence[VariantKey]) -> str:
    """Return the shortest name that tells a planner and parameter set from others."""
    planner, parameter_set = key
    if len({item[0] for item in others}) == len(others):
        return planner
    if len({item[1] for item in others}) == len(others):
        return parameter_set
    return f"{planner}, {parameter_set}"


@dataclass(frozen=True, slots=True)
class Shown:
    """How a column is shown: its name, unit, factor from SI, decimal places, and what is better."""

    name: str
    unit: str
    factor: float
    digits: int
    better: int
    """1: more is better; -1: less is better; 0: neither."""

    @property
    def title(self) -> str:
        """Name and unit."""
        return f"{self.name}, {self.unit}" if self.unit else self.name


DEG = math.degrees(1.0)

COLUMNS = {
    "path_inefficiency": Shown("path inefficiency", "%", 100.0, 1, -1),
    "drive_rate_m_per_h": Shown("drive rate", "m/h", 1.0, 1, 1),
    "distance_driven_m": Shown("distance", "m", 1.0, 1, 0),
    "duration_sim_s": Shown("duration", "min", 1.0 / 60.0, 1, 0),
    "planning_cycles": Shown("planning cycles", "", 1.0, 1, 0),
    "ace_evaluations_mean": Shown("ACE evaluations, mean", "", 1.0, 1, -1),
    "ace_evaluations_max": Shown("ACE evaluations, most", "", 1.0, 0, -1),
    "overthink_rate": Shown("overthinking", "%", 100.0, 1, -1),
    "clearance_min_m": Shown("least clearance", "m", 1.0, 3, 1),
    "wheel_drop_max_m": Shown("largest wheel drop", "m", 1.0, 3, -1),
    "tilt_max_rad": Shown("largest tilt", "deg", DEG, 2, -1),
    "rocker_max_rad": Shown("largest rocker angle", "deg", DEG, 2, -1),
    "bogie_max_rad": Shown("largest bogie angle", "deg", DEG, 2, -1),
    "slip_max": Shown("largest slip", "%", 100.0, 0, 0),
    "localization_error_final_m": Shown("final localisation error", "m", 1.0, 2, -1),
    "duration_wall_s": Shown("wall time", "s", 1.0, 1, 0),
}
