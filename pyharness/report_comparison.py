# SPDX-License-Identifier: Apache-2.0
"""The section of a report that judges drives against a reference: numbers in, blocks out."""

from collections.abc import Sequence

from pyharness import report_blocks as blocks
from pyharness.campaign_pairs import ALPHA, Comparison, McNemar, MetricResult, Pair
from pyharness.campaign_statistics import cell_of, in_order
from pyharness.report_blocks import Block, Column, Table
from pyharness.report_names import COLUMNS, axis_numbers
from pyharness.report_sections import Axes, cell_columns, grid

DIFFERENCE_FULL = 0.5
"""A success rate that moved by this much has the full colour."""


def comparison_blocks(
    judged: str, reference: str, result: Comparison, axes: Axes, suffix: str
) -> list[Block]:
    """Say whether and where the judged drives are better or worse than the reference's."""
    if not result.pairs:
        return [
            blocks.Callout(
                "note",
                [f"{judged} and {reference} have no drive in common: nothing can be compared."],
            )
        ]
    content: list[Block] = [
        blocks.Callout(_tone(result.success), _verdict(judged, reference, result)),
        _pairs_table(judged, reference, result, suffix),
    ]
    content += _cells(result, axes, suffix)
    if result.metrics:
        content.append(_metrics_table(judged, reference, result.metrics, suffix))
    return [*content, _how(result)]


HEADING_WIDTH = 24
"""Letters of a name for which there is room at the head of a column."""


def _heads(judged: str, reference: str) -> tuple[str, str]:
    """Return what stands over the columns of both sides."""
    if max(len(judged), len(reference)) > HEADING_WIDTH:
        return "judged", "reference"
    return judged, reference


def _is_shown(test: McNemar) -> bool:
    return test.p < ALPHA


def _tone(test: McNemar) -> blocks.Tone:
    if not _is_shown(test):
        return "note"
    return "good" if test.difference > 0 else "bad"


def _verdict(judged: str, reference: str, result: Comparison) -> list[blocks.Text]:
    test = result.success
    before, after = test.both + test.only_before, test.both + test.only_after
    if _is_shown(test):
        word = "more" if test.difference > 0 else "less"
        head = f"{judged[0].upper()}{judged[1:]} reaches the goal {word} often than {reference}"
    else:
        head = f"No difference shown between {judged} and {reference} in reaching the goal"
    lines: list[blocks.Text] = [
        [
            blocks.strong(f"{head} (McNemar's exact test, {blocks.p_equation(test.p)})."),
            f" {blocks.count_text(test.pairs, 'pair')} of drives: {before} reached it with"
            f" {reference}, {after} with {judged}"
            f" ({blocks.signed(100.0 * test.difference, 1)} percentage points);"
            f" {len(result.gained)} were gained, {len(result.lost)} lost.",
        ]
    ]
    safety = result.violations
    if safety.both + safety.only_before + safety.only_after:
        lines.append(
            "True limit violations on arcs called safe:"
            f" {safety.both + safety.only_before} with {reference},"
            f" {safety.both + safety.only_after} with {judged} ({blocks.p_equation(safety.p)})."
        )
    return lines + _changes(result) + _left_out(judged, reference, result)


def _changes(result: Comparison) -> list[blocks.Text]:
    """Say which metrics got better, and which worse."""
    moved = [item for item in result.metrics if item.p_holm < ALPHA]
    lines: list[blocks.Text] = []
    for word, sign in (("Better", 1.0), ("Worse", -1.0)):
        names = [
            COLUMNS[item.difference.metric].name
            for item in moved
            if sign * COLUMNS[item.difference.metric].better * item.difference.difference > 0.0
        ]
        if names:
            lines.append(f"{word} where both reached the goal: {', '.join(names)}.")
    return lines


def _left_out(judged: str, reference: str, result: Comparison) -> list[blocks.Text]:
    return [
        f"Left out: {blocks.count_text(len(rows), 'drive')} of {name} without a partner (another"
        " cell or seed, or not run yet)."
        for name, rows in ((reference, result.left_out_before), (judged, result.left_out_after))
        if rows
    ]


def _p(p: float) -> str:
    return blocks.p_text(p)


def _pairs_table(judged: str, reference: str, result: Comparison, suffix: str) -> Table:
    test = result.success
    judged, reference = _heads(judged, reference)
    return Table(
        f"tab-pairs{suffix}",
        "Pairs of drives in the same cell with the same seed.",
        [
            Column(""),
            Column(f"{judged}: reached", right=True),
            Column(f"{judged}: failed", right=True),
        ],
        [
            [blocks.strong(f"{reference}: reached"), str(test.both), str(test.only_before)],
            [blocks.strong(f"{reference}: failed"), str(test.only_after), str(test.neither)],
        ],
    )


def _cells(result: Comparison, axes: Axes, suffix: str) -> list[Block]:
    content: list[Block] = []
    if len(axes) == 2:
        values = {
            item.cell: (
                item.test.difference / DIFFERENCE_FULL,
                blocks.signed(100.0 * item.test.difference, 0),
                f"+{item.test.only_after} \N{MINUS SIGN}{item.test.only_before} of"
                f" {item.test.pairs} · {blocks.p_equation(item.p_holm)}",
            )
            for item in result.cells
        }
        caption = (
            "Change of the success rate in percentage points; drives gained and lost, and p"
            " (McNemar, exact, Holm-corrected for the number of cells)."
        )
        content.append(grid(f"tab-change{suffix}", caption, axes, values, blocks.shade_signed))
    else:
        content.append(_cell_table(result, axes, suffix))
    return content


def _cell_table(result: Comparison, axes: Axes, suffix: str) -> Table:
    return Table(
        f"tab-change{suffix}",
        "Success rate by cell: pairs, drives gained and lost, exact p of McNemar's test, and the"
        " same Holm-corrected for the number of cells.",
        [
            *cell_columns(axes),
            Column("pairs", right=True),
            Column("gained", right=True),
            Column("lost", right=True),
            Column("change, points", right=True),
            Column("p", right=True),
            Column("p, Holm", right=True),
        ],
        [
            [
                *axis_numbers(item.cell, list(axes)),
                str(item.test.pairs),
                str(item.test.only_after),
                str(item.test.only_before),
                blocks.signed(100.0 * item.test.difference, 1),
                _p(item.test.p),
                _p(item.p_holm),
            ]
            for item in result.cells
        ],
        small=True,
    )


def _metrics_table(
    judged: str, reference: str, metrics: Sequence[MetricResult], suffix: str
) -> Table:
    judged, reference = _heads(judged, reference)
    rows = []
    for item in metrics:
        own, shown = item.difference, COLUMNS[item.difference.metric]
        low, high = shown.factor * own.low, shown.factor * own.high
        digits = shown.digits + 1
        rows.append(
            [
                shown.title,
                str(own.pairs),
                blocks.number(shown.factor * own.before, digits),
                blocks.number(shown.factor * own.after, digits),
                blocks.signed(shown.factor * own.difference, digits),
                f"{blocks.signed(low, digits)} to {blocks.signed(high, digits)}",
                _p(item.p_holm),
                _judgement(item),
            ]
        )
    return Table(
        f"tab-differences{suffix}",
        "Means over pairs of which both drives reached the goal; their difference with a 95 %"
        " bootstrap interval; p of Wilcoxon's signed-rank test, Holm-corrected for the number of"
        " metrics.",
        [
            Column("metric", wide=True),
            Column("pairs", right=True),
            Column(reference, right=True),
            Column(judged, right=True),
            Column("difference", right=True),
            Column("95 % interval", right=True),
            Column("p, Holm", right=True),
            Column(""),
        ],
        rows,
        small=True,
    )


def _judgement(item: MetricResult) -> object:
    gain = COLUMNS[item.difference.metric].better * item.difference.difference
    if item.p_holm >= ALPHA or gain == 0.0:
        return ""
    return {"text": "better", "tone": "good"} if gain > 0.0 else {"text": "worse", "tone": "bad"}


def _how(result: Comparison) -> blocks.Paragraph:
    return blocks.Paragraph(
        f"The test over all pairs decides, at p < {ALPHA:g}. The tests of"
        f" {blocks.count_text(len(result.cells), 'cell')} are corrected together by Holm's method,"
        " and so are those of the metrics: they say where a difference lies, not whether there is"
        " one."
    )


def flipped_blocks(
    judged: str, reference: str, result: Comparison, axes: Axes, suffix: str
) -> list[Block]:
    """List the pairs of which one drive only reached the goal."""
    if not result.gained and not result.lost:
        return []
    heads = _heads(judged, reference)
    rows = [
        [word, *axis_numbers(cell_of(pair[1], list(axes)), list(axes)), *_flip(pair)]
        for word, pairs in (("lost", result.lost), ("gained", result.gained))
        for pair in sorted(pairs, key=lambda item: in_order(item[1], list(axes)))
    ]
    return [
        Table(
            f"tab-flipped{suffix}",
            f"Drives that reached the goal with only one of {reference} and {judged}: lost ones"
            " first.",
            [
                Column(""),
                *cell_columns(axes),
                Column("seed", right=True),
                Column(heads[1]),
                Column(heads[0]),
                Column("detail of the failure", wide=True),
            ],
            rows,
            small=True,
        )
    ]


def _flip(pair: Pair) -> list[str]:
    outcomes = [str(row["outcome"]).replace("_", " ") for row in pair]
    details = [str(row["fault_detail"]) for row in pair if row["fault_detail"]]
    return [str(pair[1]["seed"]), *outcomes, "; ".join(details)]
