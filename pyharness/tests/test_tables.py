# SPDX-License-Identifier: Apache-2.0
import pytest

from pyharness import tables
from pyharness.clib import lib
from sim.strict_yaml import read_tree


@pytest.mark.parametrize("rows", [tables.param_rows(), tables.evr_rows(), tables.dp_rows()])
def test_every_row_appears_in_every_format(rows):
    for write in tables.FORMATS.values():
        text = write(rows)
        assert all(str(row["name"]) in text for row in rows)


def test_there_are_as_many_rows_as_in_c():
    assert len(tables.param_rows()) == lib.NAV_PARAM_COUNT
    assert len(tables.evr_rows()) == lib.NAV_EVR_COUNT + lib.NAV_HOST_EVR_COUNT
    assert len(tables.dp_rows()) == lib.NAV_DP_COUNT + lib.NAV_HOST_DP_COUNT


def test_the_yaml_is_read_back():
    assert read_tree(tables.to_yaml(tables.evr_rows()), "evrs").data == tables.evr_rows()


def test_a_bar_in_a_cell_does_not_split_it():
    assert tables.to_markdown([{"a": "x|y"}]).splitlines()[2] == "| x\\|y |"
