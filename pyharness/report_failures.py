# SPDX-License-Identifier: Apache-2.0
"""The section of a report that shows failures: which are chosen, and what is said of them."""

from collections.abc import Callable, Sequence

from pyharness import report_blocks as blocks
from pyharness.campaign_statistics import (
    CALLED_SAFE,
    Cell,
    Row,
    cell_of,
    in_order,
    outcome_counts,
    violation_place,
)
from pyharness.drive_table import is_success
from pyharness.report_blocks import Block
from pyharness.report_names import cell_text, variant_of, variant_text
from pyharness.report_sections import Axes

PICTURES_MAX = 6


def choose_failures(
    rows: Sequence[Row], axes: Sequence[str], has_picture: Callable[[str], bool]
) -> list[Row]:
    """Return failures to show: outcome by outcome in turn, each time the lowest cell that is new.

    Violations on arcs called safe come first, then the most frequent outcome. Within an outcome a
    cell is shown again only when no other is left; within a cell the lowest seed comes first.
    """
    failed = [row for row in rows if not is_success(row) and has_picture(str(row["name"]))]
    frequent = list(outcome_counts(failed))
    kinds: dict[int, list[Row]] = {}
    for row in failed:
        is_worst = violation_place(row) == CALLED_SAFE
        kinds.setdefault(-1 if is_worst else frequent.index(str(row["outcome"])), []).append(row)
    queues = [_spread(kinds[rank], axes) for rank in sorted(kinds)]
    chosen: list[Row] = []
    while len(chosen) < PICTURES_MAX and any(queues):
        chosen += [queue.pop(0) for queue in queues if queue]
    return chosen[:PICTURES_MAX]


def _spread(rows: Sequence[Row], axes: Sequence[str]) -> list[Row]:
    """Return rows so that every cell comes once before any comes again."""
    seen: dict[Cell, int] = {}
    ranked: list[tuple[int, Row]] = []
    for row in sorted(rows, key=lambda item: in_order(item, axes)):
        cell = cell_of(row, axes)
        seen[cell] = seen.get(cell, 0) + 1
        ranked.append((seen[cell], row))
    return [row for _, row in sorted(ranked, key=lambda item: item[0])]


def failure_blocks(
    rows: Sequence[Row],
    axes: Axes,
    pictures: Sequence[tuple[Row, bytes]],
    keep: str,
    files: dict[str, bytes],
) -> list[Block]:
    """Show failures with what happened and how to run them again.

    Args:
        rows: All drives.
        axes: Of the campaign.
        pictures: Failures that were chosen, with their pictures.
        keep: Which drives' folders were kept.
        files: Takes the pictures.
    """
    if not pictures:
        missing = (
            "No drive failed."
            if all(map(is_success, rows))
            else f"No pictures of failed drives were kept (keep: {keep})."
        )
        return [blocks.Paragraph(missing)]
    about = (
        "Overhead views at the end of drives. Which are shown: violations on arcs called safe"
        " first, then outcome by outcome in turn, the most frequent one first; of each the lowest"
        f" cell that is not shown yet, and its lowest seed; {PICTURES_MAX} at most. The command is"
        " run in the campaign folder."
    )
    variants = list(dict.fromkeys(map(variant_of, rows)))
    shown = []
    for index, (row, jpeg) in enumerate(pictures):
        file = f"picture-{index}.jpg"
        files[file] = jpeg
        whose = f"; {variant_text(variant_of(row), variants)}" if len(variants) > 1 else ""
        shown.append(blocks.Picture(f"fig-failure-{index}", _caption(row, axes, whose), file))
    return [blocks.Paragraph(about), blocks.Pictures(shown, across=2)]


def _caption(row: Row, axes: Axes, whose: str) -> blocks.Text:
    name, place = str(row["name"]), cell_text(cell_of(row, list(axes)), list(axes))
    detail = str(row["fault_detail"] or blocks.NOTHING)
    return [
        blocks.strong(str(row["outcome"]).replace("_", " ")),
        f"{whose}; {place}; seed {row['seed']}. {detail}. Again: ",
        blocks.code(f"enav drive --scenario drives/{name}/scenario.yaml -o ../{name}"),
    ]
