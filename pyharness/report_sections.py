# SPDX-License-Identifier: Apache-2.0
"""The sections of a report on one campaign: numbers in, blocks out."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pyharness import report_blocks as blocks
from pyharness.campaign_statistics import (
    CALLED_SAFE,
    ELSEWHERE,
    LEAVING,
    Causes,
    Row,
    Safety,
    axis_key,
    by_cell,
    in_order,
    mean,
    most_per_metre,
    outcome_counts,
    success,
)
from pyharness.drive_table import is_success
from pyharness.metrics import OVERTHINK_EVALUATIONS
from pyharness.report_blocks import Block, Column, Grid, GridCell, GridRow, Table
from pyharness.report_names import (
    COLUMNS,
    Shown,
    VariantKey,
    axis_numbers,
    axis_title,
    axis_titles,
    axis_value,
)
from pyharness.status import Reason, reason_text

Axes = Mapping[str, Sequence[Any]]


# ------------------------------------------------------------------ safety


KINDS = (
    (CALLED_SAFE, "passed as safe"),
    (LEAVING, "passed under the leave limits only"),
    (ELSEWHERE, "neither: the unguarded crawl, modes that do not test terrain"),
)


def safety_blocks(found: Sequence[tuple[VariantKey, str, Safety]]) -> list[Block]:
    """Say how many metres were driven on arcs called safe, and what went wrong on them.

    Args:
        found: Planner and parameter set with its short name, and the numbers of its drives.
    """
    violations = sum(len(safety.violations[CALLED_SAFE]) for _, _, safety in found)
    is_known = any(safety.called_safe_m > 0.0 for _, _, safety in found)
    lines: list[blocks.Text] = []
    for key, name, safety in found:
        lines.append(_statement(key, name if len(found) > 1 else "", safety))
        if safety.silent:
            lines.append(
                f"{blocks.count_text(safety.silent, 'drive')} of these crashed or did not run to an"
                " end: what the rover did there is not in the numbers."
            )
    tone: blocks.Tone = "bad" if violations else "good" if is_known else "note"
    rows = [
        [
            *([name] if len(found) > 1 else []),
            title,
            blocks.distance_text(distance_m),
            _marked(str(len(safety.violations[kind])), "bad") if safety.violations[kind] else "0",
            _upper(len(safety.violations[kind]), distance_m),
        ]
        for _, name, safety in found
        for (kind, title), distance_m in zip(
            KINDS, (safety.called_safe_m, safety.leaving_m, safety.elsewhere_m), strict=True
        )
    ]
    result: list[Block] = [
        blocks.Heading("Safety"),
        blocks.Callout(tone, lines),
        Table(
            "tab-safety",
            "Metres driven by what the planner had said of the arc, and true limit violations:"
            " states of the true rover that operators would call a fault. A violation ends the"
            " drive.",
            [
                *([Column("planner")] if len(found) > 1 else []),
                Column("arcs", wide=True),
                Column("driven", right=True),
                Column("violations", right=True),
                Column("at most (95 %)", right=True),
            ],
            rows,
        ),
    ]
    listed = [
        (kind, row)
        for kind in (CALLED_SAFE, LEAVING)
        for _, _, safety in found
        for row in safety.violations[kind]
    ]
    if listed:
        result.append(
            Table(
                "tab-violations",
                "Every true limit violation on an arc that had passed; those elsewhere stand among"
                " the failed drives in the appendix.",
                [
                    _drive_column(row for _, row in listed),
                    Column("arc"),
                    Column("detail", wide=True),
                ],
                [[blocks.drive_name(str(row["name"])), kind, _detail(row)] for kind, row in listed],
                small=True,
            )
        )
    return result


def _statement(key: VariantKey, name: str, safety: Safety) -> blocks.Text:
    count = len(safety.violations[CALLED_SAFE])
    speaker = "Navlib" if key[0] == "enav" else key[0]
    head = f"{name}: " if name else ""
    text = (
        f"{head}{blocks.distance_text(safety.called_safe_m)} were driven on arcs that {speaker} had"
        f" called safe; {blocks.count_text(count, 'true limit violation')} happened on them."
    )
    most = most_per_metre(count, safety.called_safe_m)
    bound = (
        "" if most is None else f" With 95 % confidence that is at most {_per_km(most)} (Poisson)."
    )
    return [blocks.strong(text), bound]


def _per_km(per_metre: float) -> str:
    per_km = 1000.0 * per_metre
    return f"{blocks.whole(per_km) if per_km >= 10.0 else f'{per_km:.2g}'} per km"


def _upper(events: int, distance_m: float) -> str:
    most = most_per_metre(events, distance_m)
    return blocks.NOTHING if most is None else _per_km(most)


def _marked(text: str, tone: blocks.Tone) -> dict[str, str]:
    return {"text": text, "tone": tone}


def _drive_column(rows: Iterable[Row]) -> Column:
    """Return the column of names, which share the room with the details where they are long."""
    return Column("drive", wide=any(len(str(row["name"])) > blocks.NAME_WIDTH for row in rows))


def _detail(row: Row) -> str:
    return str(row["fault_detail"] or blocks.NOTHING)


# ------------------------------------------------------------------ requirements


@dataclass(frozen=True, slots=True)
class Check:
    """A requirement with what was measured; `is_met` is None where nothing could be."""

    requirement: str
    threshold: str
    measured: str
    interval: str
    is_met: bool | None


def requirement_blocks(checks: Sequence[Check]) -> list[Block]:
    """List the requirements, met or not."""
    if not checks:
        return [
            blocks.Heading("Requirements"),
            blocks.Paragraph("The campaign states no requirements."),
        ]
    words: dict[bool | None, Any] = {
        True: _marked("met", "good"),
        False: _marked("not met", "bad"),
        None: "no data",
    }
    missed = sum(check.is_met is not True for check in checks)
    verdict = (
        f"{len(checks) - missed} of {blocks.count_text(len(checks), 'requirement')} of the"
        f" campaign {'are' if len(checks) > 1 else 'is'} met."
    )
    return [
        blocks.Heading("Requirements"),
        blocks.Paragraph(verdict),
        Table(
            "tab-requirements",
            "Requirements of the campaign. A requirement is judged by the measured value; where"
            " that is a rate its 95 % Wilson interval is given.",
            [
                Column("requirement", wide=True),
                Column("threshold", right=True),
                Column("measured", right=True),
                Column("interval", right=True),
                Column(""),
            ],
            [
                [item.requirement, item.threshold, item.measured, item.interval, words[item.is_met]]
                for item in checks
            ],
        ),
    ]


# ------------------------------------------------------------------ what was run


def run_blocks(
    campaign: Sequence[tuple[str, str]],
    machine: Sequence[tuple[str, str]],
    settings: Sequence[tuple[str, str, str]],
) -> list[Block]:
    """Say what was run, by what and where, and what differs from the defaults."""
    result: list[Block] = [
        blocks.Heading("What was run"),
        _pairs("tab-campaign", "The campaign.", campaign),
        _pairs("tab-machine", "Software and machine.", machine),
    ]
    if settings:
        columns = [Column("setting"), Column("default", wide=True), Column("here", wide=True)]
        rows = [[blocks.code(name), default, here] for name, default, here in settings]
        caption = "Settings that differ from the defaults of a drive, besides the axes."
        result.append(Table("tab-settings", caption, columns, rows, small=True))
    else:
        result.append(blocks.Paragraph("All settings besides the axes have their defaults."))
    return result


def _pairs(label: str, caption: str, rows: Sequence[tuple[str, str]]) -> Table:
    columns = [Column("item"), Column("value", wide=True)]
    return Table(label, caption, columns, [[name, text] for name, text in rows])


# ------------------------------------------------------------------ results by cell


def cell_columns(axes: Axes) -> list[Column]:
    """Return the columns that name a cell."""
    return [Column(title) for title in axis_titles(list(axes))]


def _cells_and_all(rows: Sequence[Row], axes: Axes) -> list[tuple[list[Any], Sequence[Row]]]:
    """Return the drives of every cell, and all of them, with what stands in these columns."""
    names = list(axes)
    cells = by_cell(rows, names) if names else {}
    named: list[tuple[list[Any], Sequence[Row]]] = [
        (list(axis_numbers(cell, names)), own) for cell, own in cells.items()
    ]
    everything = [blocks.strong("all"), *[""] * (len(names) - 1)] if names else []
    return [*named, (everything, rows)]


Shade = Callable[[float], str]


def grid(
    label: str,
    caption: blocks.Text,
    axes: Axes,
    values: Mapping[tuple[Any, ...], tuple[float, str, str]],
    shade: Shade,
) -> Grid:
    """Return a heat map over two axes of value, number and the line under it."""
    (row_axis, row_values), (column_axis, column_values) = axes.items()

    def cell(key: tuple[Any, ...]) -> GridCell:
        if key not in values:
            return GridCell(blocks.NOTHING, "", blocks.EMPTY_FILL)
        value, main, sub = values[key]
        return GridCell(main, sub, shade(value))

    return Grid(
        label,
        caption,
        f"{axis_title(row_axis)} ↓  {axis_title(column_axis)} →",
        [axis_value(column_axis, value) for value in column_values],
        [
            GridRow(
                axis_value(row_axis, row_value),
                [
                    cell((axis_key(row_value), axis_key(column_value)))
                    for column_value in column_values
                ],
            )
            for row_value in row_values
        ],
    )


def success_blocks(rows: Sequence[Row], axes: Axes, suffix: str) -> list[Block]:
    """Show the success rate of every cell."""
    rates = {cell: success(own) for cell, own in by_cell(rows, list(axes)).items()}
    caption = (
        "Success rate: drives that reached their goal, with the 95 % Wilson interval and the"
        " number of drives."
    )
    if len(axes) == 2:
        values = {
            cell: (
                rate.share,
                blocks.percent(rate.share),
                f"{blocks.interval(rate)} · {rate.count}/{rate.total}",
            )
            for cell, rate in rates.items()
            if rate is not None
        }
        return [grid(f"tab-success{suffix}", caption, axes, values, blocks.shade)]
    columns = [*cell_columns(axes), Column("reached", right=True)]
    columns += [Column("rate", right=True), Column("95 % interval", right=True)]
    table_rows = [
        [
            *axis_numbers(cell, list(axes)),
            f"{rate.count} of {rate.total}",
            blocks.percent(rate.share, 1),
            blocks.interval(rate),
        ]
        for cell, rate in rates.items()
        if rate is not None
    ]
    return [Table(f"tab-success{suffix}", caption, columns, table_rows)]


GRID_METRICS = (
    ("drive_rate_m_per_h", True, "Mean drive rate"),
    ("path_inefficiency", True, "Mean path inefficiency, driven over straight length less one"),
    ("ace_evaluations_mean", False, "Mean number of ACE evaluations of a planning cycle"),
    (
        "overthink_rate",
        False,
        f"Mean share of planning cycles with more than {OVERTHINK_EVALUATIONS} ACE evaluations"
        " (overthinking)",
    ),
)


def metric_blocks(rows: Sequence[Row], axes: Axes, suffix: str) -> list[Block]:
    """Show drive rate, inefficiency and thinking of every cell."""
    if len(axes) != 2:
        return [_metric_table(rows, axes, suffix)]
    return [
        _metric_grid(rows, axes, column, only_reached, title, suffix)
        for column, only_reached, title in GRID_METRICS
    ]


def _metric_grid(
    rows: Sequence[Row], axes: Axes, column: str, only_reached: bool, title: str, suffix: str
) -> Grid:
    shown = COLUMNS[column]
    means = {
        cell: mean([row for row in own if is_success(row) or not only_reached], column)
        for cell, own in by_cell(rows, list(axes)).items()
    }
    present = [item.value for item in means.values() if item is not None]
    values = {
        cell: (
            blocks.scaled(item.value, present),
            blocks.mean_text(item, shown.factor, shown.digits),
            f"n = {item.count}",
        )
        for cell, item in means.items()
        if item is not None
    }
    who = "drives that reached their goal" if only_reached else "all drives"
    unit = f", {shown.unit}" if shown.unit else ""
    return grid(f"tab-{column}{suffix}", f"{title}{unit}; {who}.", axes, values, blocks.shade)


def _metric_table(rows: Sequence[Row], axes: Axes, suffix: str) -> Table:
    table_rows = []
    for cell, own in by_cell(rows, list(axes)).items():
        reached = [row for row in own if is_success(row)]
        table_rows.append(
            [
                *axis_numbers(cell, list(axes)),
                str(len(reached)),
                *(
                    _mean_of(reached if only_reached else own, column)
                    for column, only_reached, _ in GRID_METRICS
                ),
            ]
        )
    columns = [*cell_columns(axes), Column("reached", right=True)]
    columns += [Column(COLUMNS[column].title, right=True) for column, _, _ in GRID_METRICS]
    caption = (
        "Means by cell: drive rate and inefficiency of drives that reached their goal, ACE"
        " evaluations and overthinking of all."
    )
    return Table(f"tab-metrics{suffix}", caption, columns, table_rows, small=True)


def _mean_of(rows: Sequence[Row], column: str) -> str:
    shown = COLUMNS[column]
    return blocks.mean_text(mean(rows, column), shown.factor, shown.digits)


# ------------------------------------------------------------------ failures


def outcome_table(rows: Sequence[Row], axes: Axes, suffix: str) -> Table:
    """Return drives of every cell by outcome."""
    names = list(outcome_counts(rows))
    table_rows = []
    for place, own in _cells_and_all(rows, axes):
        counts = outcome_counts(own)
        table_rows.append([*place, *(str(counts.get(name, "")) for name in names)])
    columns = [*cell_columns(axes), *(Column(_spaced(name), right=True) for name in names)]
    caption = "Drives by outcome and cell."
    return Table(f"tab-outcomes{suffix}", caption, columns, table_rows, small=True)


def _spaced(name: str) -> str:
    return name.replace("_", " ")


def cause_blocks(causes: Causes, file: str, suffix: str) -> list[Block]:
    """Show why drives found no path, by the rejection reasons of their candidate paths."""
    if causes.drives == 0:
        return [blocks.Paragraph("No drive ended without a path.")]
    total_end = sum(causes.paths_at_end.values()) or 1
    total = sum(causes.paths_overall.values()) or 1
    table_rows = [
        [
            _spaced(name),
            _meaning(name),
            str(causes.main_at_end[name]),
            blocks.percent(causes.paths_at_end[name] / total_end, 1),
            str(causes.main_overall[name]),
            blocks.percent(causes.paths_overall[name] / total, 1),
        ]
        for name in causes.reasons
    ]
    return [
        blocks.Paragraph(
            f"{blocks.count_text(causes.drives, 'drive')} ended because no path passed."
            " Each candidate path that was rejected has one reason; paths that were merely dearer"
            " than the selected one, or not tested, are not counted."
        ),
        blocks.Pictures(
            [
                blocks.Picture(
                    f"fig-causes{suffix}",
                    "Drives without a path by the reason that rejected most of their candidate"
                    " paths: in the last refusal, and over the whole drive.",
                    file,
                )
            ]
        ),
        Table(
            f"tab-causes{suffix}",
            "Rejection reasons in drives that ended without a path: drives in which the reason was"
            " the most frequent one, and its share of rejected paths.",
            [
                Column("reason"),
                Column("meaning", wide=True),
                Column("drives, at the end", right=True),
                Column("paths", right=True),
                Column("drives, overall", right=True),
                Column("paths", right=True),
            ],
            table_rows,
            small=True,
        ),
    ]


def _meaning(name: str) -> str:
    known = {reason.name.lower(): int(reason) for reason in Reason}
    return reason_text(known[name]) if name in known else blocks.NOTHING


# ------------------------------------------------------------------ appendix

PERFORMANCE = (
    "path_inefficiency", "drive_rate_m_per_h", "duration_sim_s", "planning_cycles",
    "ace_evaluations_mean", "ace_evaluations_max", "overthink_rate", "duration_wall_s",
)  # fmt: skip
MARGINS = (
    "clearance_min_m", "wheel_drop_max_m", "tilt_max_rad", "rocker_max_rad", "bogie_max_rad",
    "slip_max", "localization_error_final_m",
)  # fmt: skip


def appendix_tables(rows: Sequence[Row], axes: Axes, suffix: str) -> list[Block]:
    """Return all means of every cell."""
    return [
        _all_means(
            rows, axes, f"tab-performance{suffix}", PERFORMANCE, lambda _: "",
            "Means by cell over all drives that have the number; inefficiency and drive rate of"
            " drives that reached their goal.",
        ),
        _all_means(
            rows, axes, f"tab-extremes{suffix}", MARGINS, _worst,
            "Mean of the extreme of each drive by cell, and in brackets the extreme of all.",
        ),
    ]  # fmt: skip


def _worst(shown_values: tuple[str, list[float]]) -> str:
    column, values = shown_values
    shown = COLUMNS[column]
    worst = min(values) if shown.better > 0 else max(values)
    return f" ({blocks.number(shown.factor * worst, shown.digits)})"


def _all_means(
    rows: Sequence[Row],
    axes: Axes,
    label: str,
    metrics: Sequence[str],
    extra: Callable[[tuple[str, list[float]]], str],
    caption: str,
) -> Table:
    reached_only = {column for column, only_reached, _ in GRID_METRICS if only_reached}

    def text(own: Sequence[Row], column: str) -> str:
        if column in reached_only:
            own = [row for row in own if is_success(row)]
        values = [float(row[column]) for row in own if row.get(column) is not None]
        return _mean_of(own, column) + (extra((column, values)) if values else "")

    table_rows = [
        [*place, f"{sum(map(is_success, own))}/{len(own)}", *(text(own, name) for name in metrics)]
        for place, own in _cells_and_all(rows, axes)
    ]
    columns = [*cell_columns(axes), Column("reached", right=True)]
    columns += [Column(_short(COLUMNS[name]), right=True) for name in metrics]
    return Table(label, caption, columns, table_rows, small=True)


def _short(shown: Shown) -> str:
    return shown.title.removeprefix("least ").removeprefix("largest ")


def failed_blocks(rows: Sequence[Row], axes: Axes) -> list[Block]:
    """List every drive that did not reach its goal."""
    failed = sorted(
        (row for row in rows if not is_success(row)), key=lambda row: in_order(row, list(axes))
    )
    if not failed:
        return [blocks.Paragraph("Every drive reached its goal.")]
    return [
        Table(
            "tab-failed",
            "Every drive that did not reach its goal.",
            [_drive_column(failed), Column("outcome"), Column("detail", wide=True)],
            [
                [blocks.drive_name(str(row["name"])), _spaced(str(row["outcome"])), _detail(row)]
                for row in failed
            ],
            small=True,
        )
    ]
