# SPDX-License-Identifier: Apache-2.0
import pytest

from pyharness.campaign_pairs import compare
from pyharness.report_comparison import comparison_blocks, flipped_blocks
from pyharness.tests.campaign_rows import GRID, rows_of


def reached(*_):
    return "goal_reached"


def lines_of(content):
    """What the callout says."""
    return [
        "".join(part if isinstance(part, str) else part["strong"] for part in line)
        for line in content[0].lines
    ]


def blocks_of(before, after, axes=GRID, names=("new", "old")):
    return comparison_blocks(*names, compare(before, after, list(axes)), axes, "-x")


def labelled(content, label):
    return next(block for block in content if getattr(block, "label", "") == label)


@pytest.mark.parametrize(
    ("column", "value", "word"),
    [
        ("drive_rate_m_per_h", 99.0, "better"),
        ("drive_rate_m_per_h", 50.0, "worse"),
        ("path_inefficiency", 0.01, "better"),
        ("clearance_min_m", 0.3, "worse"),
        ("tilt_max_rad", 0.1, "better"),
    ],
)
def test_a_metric_that_moved_is_judged_by_which_way_is_better(column, value, word):
    before, after = rows_of(reached, seeds=10), rows_of(reached, seeds=10, **{column: value})
    content = blocks_of(before, after)
    judged = [row[-1] for row in labelled(content, "tab-differences-x").rows if row[-1]]
    assert [cell["text"] for cell in judged] == [word]
    assert any(line.startswith(f"{word.capitalize()} where both") for line in lines_of(content))


def test_gains_are_told_with_both_counts():
    before = rows_of(lambda slope, *_: "stuck" if slope else "goal_reached", seeds=10)
    content = blocks_of(before, rows_of(reached, seeds=10))
    assert content[0].tone == "good"
    text = lines_of(content)[0]
    assert text.startswith("New reaches the goal more often than old")
    assert "20 reached it with old, 40 with new (+50.0 percentage points)" in text
    pairs = labelled(content, "tab-pairs-x").rows
    assert [row[1:] for row in pairs] == [["20", "0"], ["20", "0"]]
    cell = labelled(content, "tab-change-x").rows[1].cells[0]
    assert cell.main == "+100"
    assert cell.sub.startswith("+10 \N{MINUS SIGN}0 of 10")


def test_without_common_drives_there_is_nothing_to_say():
    (callout,) = blocks_of(rows_of(reached), [])
    assert "no drive in common" in callout.lines[0]


def test_violations_on_safe_arcs_are_told():
    content = blocks_of(rows_of(reached), rows_of(lambda *_: "limit_violation"))
    assert any(
        line.startswith("True limit violations on arcs called safe: 0 with old, 12 with new")
        for line in lines_of(content)
    )


def test_long_names_do_not_head_columns():
    content = blocks_of(rows_of(reached), rows_of(reached), names=("n" * 60, "old"))
    titles = [column.title for column in labelled(content, "tab-differences-x").columns]
    assert titles[2:4] == ["reference", "judged"]


def test_flipped_drives_are_listed_lost_ones_first_with_the_reason():
    before = rows_of(
        lambda slope, cfa, _: "no_path" if (slope, cfa) == (0, 0.07) else "goal_reached"
    )
    after = rows_of(lambda slope, *_: "stuck" if slope else "goal_reached", fault_detail="100 m")
    result = compare(before, after, list(GRID))
    (table,) = flipped_blocks("new", "old", result, GRID, "-x")
    assert [row[0] for row in table.rows] == ["lost"] * 6 + ["gained"] * 3
    assert table.rows[0][1:] == ["10", "7", "0", "goal reached", "stuck", "100 m"]
    assert table.rows[-1][4:6] == ["no path", "goal reached"]
    assert flipped_blocks("new", "old", compare(before, before, list(GRID)), GRID, "-x") == []
