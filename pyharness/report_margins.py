# SPDX-License-Identifier: Apache-2.0
"""The section of a report on margins: histograms in, blocks and figures out."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pyharness import report_blocks as blocks
from pyharness import report_figures as figures
from pyharness.margins import QUANTITIES, Histogram, Margins, Quantity, summed
from pyharness.report_blocks import Block
from pyharness.scenario import Scenario


@dataclass(frozen=True, slots=True)
class _View:
    """How a quantity is shown: name, unit, factor from SI.

    Attributes:
        navlib_limit: Navlib's parameter, in SI.
        true_limit: Key of the vehicle's fault limits, in the unit that is shown.
    """

    name: str
    unit: str
    factor: float
    navlib_limit: str
    true_limit: str


_DEG = math.degrees(1.0)
_VIEWS = {
    "clearance_m": _View("belly clearance", "m", 1.0, "clearance_min_m", "clearance_min_m"),
    "wheel_drop_m": _View("wheel drop", "m", 1.0, "wheel_drop_max_m", "wheel_drop_max_m"),
    "tilt_rad": _View("tilt", "deg", _DEG, "tilt_max_rad", "tilt_max_deg"),
    "rocker_rad": _View("rocker angle", "deg", _DEG, "rocker_max_rad", "rocker_max_deg"),
    "bogie_rad": _View("bogie angle", "deg", _DEG, "bogie_max_rad", "bogie_max_deg"),
}


def margin_blocks(
    margins: Sequence[Margins], scenarios: Sequence[Scenario], suffix: str, files: dict[str, bytes]
) -> list[Block]:
    """Show how near the true rover came to its limits at every step of all drives.

    Args:
        margins: Of the drives.
        scenarios: Settings of a drive of every cell, for the limits.
        suffix: Makes labels and files their own.
        files: Takes the figures.
    """
    total = summed(margins)
    shown = []
    for name, quantity in QUANTITIES.items():
        histogram, view = total[name], _VIEWS[name]
        if histogram.extreme is None:
            continue
        file = f"margin-{name}{suffix}.svg"
        extreme = view.factor * histogram.extreme
        files[file] = figures.margin_figure(
            figures.Distribution(
                title=f"{view.name}, {view.unit}",
                unit=view.unit,
                edges=view.factor * quantity.edges,
                counts=np.array(histogram.counts),
                below=histogram.under,
                above=histogram.over,
                extreme=extreme,
                extreme_name=_extreme_name(quantity),
                limits=limit_lines(name, scenarios),
            )
        )
        caption = _caption(view, quantity, histogram, extreme)
        shown.append(blocks.Picture(f"fig-{name}{suffix}", caption, file))
    if not shown:
        return [blocks.Paragraph("No drive has told its margins.")]
    about = (
        "Every step of 1/8 s of every drive, the crawl at the start among them; the curve is the"
        " share of steps up to a value. Dashed: Navlib's limit, which bounds what it predicts;"
        " solid: the limit of the true rover, beyond which operators would call a fault."
    )
    return [blocks.Paragraph(about), *(blocks.Pictures([picture]) for picture in shown)]


def _extreme_name(quantity: Quantity) -> str:
    return "least" if quantity.is_least else "largest"


def _caption(view: _View, quantity: Quantity, histogram: Histogram, extreme: float) -> str:
    what = "values, left and right bogie of every step" if quantity.name == "bogie_rad" else "steps"
    return (
        f"{view.name.capitalize()} of the true rover, {blocks.whole(histogram.total)} {what};"
        f" the {_extreme_name(quantity)} is {extreme:.3g} {view.unit}."
    )


def limit_lines(name: str, scenarios: Sequence[Scenario]) -> list[figures.LimitLine]:
    """Return all limits of a quantity that drives were under, in the unit that is shown."""
    view = _VIEWS[name]
    navlib = {view.factor * float(getattr(item.navlib, view.navlib_limit)) for item in scenarios}
    true = {
        float(getattr(item.vehicle.fault_limits, view.true_limit))
        for item in scenarios
        if not isinstance(item.vehicle, str)
    }
    return [
        *(figures.LimitLine("Navlib", value, False) for value in sorted(navlib)),
        *(figures.LimitLine("fault", value, True) for value in sorted(true)),
    ]
