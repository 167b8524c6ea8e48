# SPDX-License-Identifier: Apache-2.0
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from pyharness import report_figures as figures


def distribution(counts=(5, 0, 1000, 3), **changes):
    values = {
        "title": "tilt, deg",
        "unit": "deg",
        "edges": np.linspace(0.0, 4.0, len(counts) + 1),
        "counts": np.array(counts),
        "below": 0,
        "above": 0,
        "extreme": 3.9,
        "extreme_name": "largest",
        "limits": [figures.LimitLine("Navlib", 3.0, False), figures.LimitLine("fault", 3.1, True)],
        **changes,
    }
    return figures.Distribution(**values)


FIGURES = {
    "margin": lambda: figures.margin_figure(distribution()),
    "margin of one step": lambda: figures.margin_figure(distribution((0, 1, 0, 0), extreme=1.5)),
    "margin beyond all bins": lambda: figures.margin_figure(
        distribution((0, 0, 0, 0), above=3, extreme=7.0, limits=[])
    ),
    "outcomes": lambda: figures.outcome_figure(
        [("a", {"goal_reached": 3, "no_path": 1}), ("b", {"of_my_own": 2})]
    ),
    "causes": lambda: figures.cause_figure([("wheel drop", 5, 0)]),
}


@pytest.mark.parametrize("name", FIGURES)
def test_a_figure_is_svg_with_the_same_bytes_every_time(name):
    first = FIGURES[name]()
    assert ET.fromstring(first).tag.endswith("svg")
    assert FIGURES[name]() == first


def test_all_that_occurred_and_every_limit_is_in_view():
    low, high = figures.window(distribution((0, 0, 9, 0)))
    assert low < 2.0
    assert high > 3.9
    assert figures.window(distribution((0, 0, 0, 0), above=1, extreme=7.0, limits=[]))[1] > 7.0


def test_outcomes_have_colours_of_their_own():
    colors = [color for name, color in figures.OUTCOME_COLORS.items() if name != "arcs_driven"]
    assert len(set(colors)) == len(colors)
