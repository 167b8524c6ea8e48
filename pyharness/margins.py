# SPDX-License-Identifier: Apache-2.0
"""How near to its limits the true rover came: histograms over every 8 Hz step of a drive.

The bins are fixed here, so that histograms of any drives can be added.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

Truth = npt.NDArray[Any]


@dataclass(frozen=True, slots=True)
class Quantity:
    """What is counted.

    Attributes:
        name: Of the quantity, with its unit.
        upper: Upper end of the last bin; the first begins at 0.
        bin_count: Bins of equal width.
        is_least: Whether the least value is the one that matters, not the greatest.
        values: Takes them from the ground truth of a drive.
    """

    name: str
    upper: float
    bin_count: int
    is_least: bool
    values: Callable[[Truth], npt.NDArray[np.float64]]

    @property
    def edges(self) -> npt.NDArray[np.float64]:
        """Return the ends of the bins, one more than there are bins."""
        return np.linspace(0.0, self.upper, self.bin_count + 1)


def _bogie_rad(truth: Truth) -> npt.NDArray[np.float64]:
    """Return both sides of every step, one after the other."""
    both: npt.NDArray[np.float64] = np.concatenate(
        [truth["bogie_left_rad"], truth["bogie_right_rad"]]
    )
    return np.abs(both)


_ANGLE_RAD = math.radians(45.0)
_ANGLE_BINS = 180  # of 0.25 deg

QUANTITIES: Mapping[str, Quantity] = {
    quantity.name: quantity
    for quantity in (
        Quantity("clearance_m", 0.8, 160, True, lambda truth: truth["clearance_m"]),
        Quantity("wheel_drop_m", 0.6, 120, False, lambda truth: truth["wheel_drop_m"]),
        Quantity("tilt_rad", _ANGLE_RAD, _ANGLE_BINS, False, lambda truth: truth["tilt_rad"]),
        Quantity(
            "rocker_rad", _ANGLE_RAD, _ANGLE_BINS, False, lambda truth: np.abs(truth["rocker_rad"])
        ),
        Quantity("bogie_rad", _ANGLE_RAD, _ANGLE_BINS, False, _bogie_rad),
    )
}


@dataclass(frozen=True, slots=True)
class Histogram:
    """Counts of one quantity.

    Attributes:
        counts: Of the bins; a value on an edge belongs to the bin above it.
        under: How many values lie below the first bin.
        over: How many lie at or above the end of the last.
        extreme: The least or greatest value; None where there is none.
    """

    counts: tuple[int, ...]
    under: int = 0
    over: int = 0
    extreme: float | None = None

    @property
    def total(self) -> int:
        """Return how many values were counted."""
        return sum(self.counts) + self.under + self.over


Margins = Mapping[str, Histogram]
"""One histogram for every one of `QUANTITIES`."""

NO_MARGINS: Margins = {
    name: Histogram((0,) * quantity.bin_count) for name, quantity in QUANTITIES.items()
}


def margins_of(truth: Truth) -> Margins:
    """Count the steps of a drive; where a value is not known it is not counted."""
    return {name: _histogram(quantity, truth) for name, quantity in QUANTITIES.items()}


def _histogram(quantity: Quantity, truth: Truth) -> Histogram:
    values = quantity.values(truth)
    values = values[np.isfinite(values)]
    places = np.searchsorted(quantity.edges, values, side="right")
    under, *counts, over = np.bincount(places, minlength=quantity.bin_count + 2).tolist()
    extreme = None
    if len(values):
        extreme = float(values.min() if quantity.is_least else values.max())
    return Histogram(tuple(counts), under, over, extreme)


def summed(several: Iterable[Margins]) -> Margins:
    """Return the histograms of several drives together."""
    parts = [NO_MARGINS, *several]
    return {
        name: _summed(quantity, [part[name] for part in parts])
        for name, quantity in QUANTITIES.items()
    }


def _summed(quantity: Quantity, parts: list[Histogram]) -> Histogram:
    extremes = [part.extreme for part in parts if part.extreme is not None]
    choose = min if quantity.is_least else max
    return Histogram(
        tuple(map(sum, zip(*(part.counts for part in parts), strict=True))),
        sum(part.under for part in parts),
        sum(part.over for part in parts),
        choose(extremes) if extremes else None,
    )


def to_data(margins: Margins) -> dict[str, Any]:
    """Return the histograms as plain data."""
    return {
        name: {
            "under": histogram.under,
            "over": histogram.over,
            "extreme": histogram.extreme,
            "counts": list(histogram.counts),
        }
        for name, histogram in margins.items()
    }


def from_data(data: Mapping[str, Any]) -> Margins:
    """Return the histograms that `to_data` wrote."""
    return {
        name: Histogram(
            tuple(data[name]["counts"]),
            data[name]["under"],
            data[name]["over"],
            data[name]["extreme"],
        )
        for name in QUANTITIES
    }
