# SPDX-License-Identifier: Apache-2.0
import pytest

from pyharness.report_names import (
    axis_numbers,
    axis_titles,
    axis_value,
    cell_text,
    variant_text,
)


def test_cells_are_named_with_units():
    axes = ["terrain.slope_deg", "terrain.cfa", "noise.vo_sigma_m"]
    assert cell_text((10, 0.07, 0.02), axes) == "slope 10 deg, CFA 7 %, noise.vo_sigma_m 0.02"
    assert axis_titles(axes) == ["slope, deg", "CFA, %", "noise.vo_sigma_m"]
    assert axis_numbers((10, 0.07, 0.02), axes) == ["10", "7", "0.02"]
    assert cell_text((), []) == "all"


def test_values_that_are_no_numbers_are_named_too():
    assert axis_value("mode", "guarded") == "guarded"
    assert axis_value("terrain.cfa", 0.125) == "12.5 %"


@pytest.mark.parametrize(
    ("keys", "names"),
    [
        ([("enav", "default")], ["enav"]),
        ([("enav", "default"), ("gestalt", "default")], ["enav", "gestalt"]),
        ([("enav", "a"), ("enav", "b")], ["a", "b"]),
        ([("enav", "enav"), ("gestalt", "g"), ("gestalt", "h")], ["enav", "g", "h"]),
        (
            [("enav", "a"), ("enav", "b"), ("gestalt", "a")],
            ["enav, a", "enav, b", "gestalt, a"],
        ),
    ],
)
def test_a_variant_has_the_shortest_name_that_tells_it_apart(keys, names):
    assert [variant_text(key, keys) for key in keys] == names
