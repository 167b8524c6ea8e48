# SPDX-License-Identifier: Apache-2.0
import math

import pytest

from pyharness.params import param_table, param_values, params_fault


def test_the_defaults_are_accepted_by_navlib():
    assert params_fault(param_values({})) is None


def test_values_keep_the_order_of_the_struct():
    assert list(param_values({"tilt_max_rad": 0.4})) == list(param_table())


@pytest.mark.parametrize("value", [0.0, 10.0, math.nan, math.inf])
def test_a_value_out_of_range_names_the_range(value):
    row = param_table()["tilt_max_rad"]
    assert "expected 0.05 to 1.2 rad" in (row.fault(value) or "")
    assert (params_fault(param_values({"tilt_max_rad": value})) or "").startswith("tilt_max_rad:")


@pytest.mark.parametrize("row", param_table().values(), ids=lambda row: row.name)
def test_both_ends_of_every_range_are_inside(row):
    assert row.fault(row.minimum) is None
    assert row.fault(row.maximum) is None
    assert row.doc
