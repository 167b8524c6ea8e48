# SPDX-License-Identifier: Apache-2.0
"""A whole report from what is known of a campaign: blocks, and the figures they name."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pyharness import report_blocks as blocks
from pyharness import report_comparison as comparison
from pyharness import report_figures as figures
from pyharness import report_sections as sections
from pyharness.campaign_pairs import Comparison, compare
from pyharness.campaign_statistics import (
    Cell,
    Row,
    by_cell,
    cell_of,
    in_order,
    no_path_causes,
    outcome_counts,
    safety,
    violation_place,
)
from pyharness.drive_table import is_success
from pyharness.margins import QUANTITIES, Margins, Quantity, summed
from pyharness.report_blocks import Block, Report
from pyharness.report_names import VariantKey, cell_text, variant_of, variant_text
from pyharness.scenario import Scenario

PICTURES_MAX = 6

Files = Mapping[str, bytes]
"""Figures and pictures by the names that the blocks give them."""


@dataclass(frozen=True, slots=True)
class Material:
    """What is known of a campaign.

    Attributes:
        name: Of the campaign.
        version: Of the software, with its revision where there is one.
        when: Day on which it was begun.
        axes: Values of every axis.
        drives_expected: How many drives the whole campaign has.
        rows: One for every finished drive.
        margins: Of the same drives.
        scenarios: Settings of the first drive of every cell, by planner and parameter set.
        defaults: Settings of a drive of which nothing is said.
        about_campaign: What the campaign says, for people.
        about_run: What is known of software, machine and time, for people.
        checks: Requirements with what was measured.
        keep: Which drives' folders were kept.
    """

    name: str
    version: str
    when: str
    axes: Mapping[str, Sequence[Any]]
    drives_expected: int
    rows: Sequence[Row]
    margins: Sequence[Margins]
    scenarios: Mapping[VariantKey, Sequence[Scenario]]
    defaults: Scenario
    about_campaign: Sequence[tuple[str, str]]
    about_run: Sequence[tuple[str, str]]
    checks: Sequence[sections.Check]
    keep: str


@dataclass(frozen=True, slots=True)
class _Variant:
    """The drives of a planner and parameter set; the suffix makes labels and files its own."""

    key: VariantKey
    name: str
    rows: list[Row]
    margins: list[Margins]
    suffix: str


@dataclass(frozen=True, slots=True)
class _Judgement:
    """A comparison with the names of both sides."""

    judged: str
    reference: str
    result: Comparison
    suffix: str


def build_report(
    material: Material, reference: Material | None, pictures: Sequence[tuple[Row, bytes]]
) -> tuple[Report, Files]:
    """Return a report and its files.

    Args:
        material: What is reported.
        reference: Another campaign that it is compared with, drive by drive.
        pictures: Failed drives with their overhead views as JPEG, in the order to show them.
    """
    variants = _variants(material)
    files: dict[str, bytes] = {}
    content: list[Block] = list(_incomplete(material))
    found = [(item.key, item.name, safety(item.rows)) for item in variants]
    content += sections.safety_blocks(found)
    judgements = _against(material, reference) if reference is not None else []
    if reference is not None:
        content.append(blocks.Heading(f"Compared with {reference.name}"))
        content += _comparison(judgements, material, reference)
    content += sections.requirement_blocks(material.checks)
    content.append(blocks.Contents())
    settings = _settings(material, variants)
    content += sections.run_blocks(material.about_campaign, material.about_run, settings)
    within = _among(variants, material.axes)
    if within:
        content.append(blocks.Heading("Planners and parameter sets compared", new_page=True))
        content.append(blocks.Paragraph(_within_text(variants[0].name, len(within))))
        for item in within:
            content += _judged(item, material.axes)
    for variant in variants:
        content += _results(material, variant, len(variants) > 1, files)
    content += _failures(material, pictures, files)
    content += _appendix(material, variants, [*judgements, *within])
    drives = blocks.count_text(len(material.rows), "drive")
    report = Report(
        f"Monte Carlo report: {material.name}",
        " · ".join(filter(None, [drives, f"enav-sim {material.version}", material.when])),
        f"enav-sim {material.version}",
        content,
    )
    return report, files


def _variants(material: Material) -> list[_Variant]:
    keys = list(dict.fromkeys(map(variant_of, material.rows)))
    result = []
    for index, key in enumerate(keys):
        own = [place for place, row in enumerate(material.rows) if variant_of(row) == key]
        result.append(
            _Variant(
                key,
                variant_text(key, keys),
                [material.rows[place] for place in own],
                [material.margins[place] for place in own],
                f"-{index + 1}" if len(keys) > 1 else "",
            )
        )
    return result


def _incomplete(material: Material) -> list[Block]:
    done, expected = len(material.rows), material.drives_expected
    if done >= expected:
        return []
    text = (
        f"Incomplete: {done} of {blocks.count_text(expected, 'drive')} of the campaign are"
        " finished. All that follows is about these."
    )
    return [blocks.Callout("bad", [blocks.strong(text)])]


# ------------------------------------------------------------------ comparisons


def _against(material: Material, reference: Material) -> list[_Judgement]:
    """Compare with another campaign: what has the same name, or what is alone on both sides."""
    own, other = _variants(material), _variants(reference)
    if set(material.axes) != set(reference.axes):
        return []
    by_key = {item.key: item for item in other}
    if len(own) == len(other) == 1:
        by_key = {own[0].key: other[0]}
    result = []
    for item in own:
        if item.key in by_key:
            partner = by_key[item.key]
            names = _two_names(material, item, reference, partner, len(own) > 1)
            pairs = compare(partner.rows, item.rows, list(material.axes))
            result.append(_Judgement(*names, pairs, f"-against{item.suffix}"))
    return result


def _two_names(
    material: Material, item: _Variant, reference: Material, partner: _Variant, with_variant: bool
) -> tuple[str, str]:
    """Return short names of both sides that differ."""
    if material.name != reference.name:
        judged, referred = material.name, reference.name
    elif item.key != partner.key:
        return " ".join(filter(None, item.key)), " ".join(filter(None, partner.key))
    else:
        judged, referred = "this campaign", "the reference"
    return (
        (f"{judged}: {item.name}", f"{referred}: {item.name}")
        if with_variant
        else (
            judged,
            referred,
        )
    )


def _among(variants: Sequence[_Variant], axes: sections.Axes) -> list[_Judgement]:
    """Compare the others of one campaign with the first."""
    return [
        _Judgement(
            other.name,
            variants[0].name,
            compare(variants[0].rows, other.rows, list(axes)),
            f"-within{other.suffix}",
        )
        for other in variants[1:]
    ]


def _within_text(first: str, count: int) -> str:
    if count == 1:
        return f"The reference is {first}, the first of the campaign."
    return (
        f"The reference of each is {first}, the first of the campaign. The tests over all pairs"
        f" are not corrected for there being {count} of them."
    )


def _comparison(
    judgements: Sequence[_Judgement], material: Material, reference: Material
) -> list[Block]:
    if not judgements:
        names = ", ".join(" ".join(key) for key in dict.fromkeys(map(variant_of, reference.rows)))
        why = (
            f"the axes of the reference are others ({', '.join(reference.axes) or 'none'})"
            if set(material.axes) != set(reference.axes)
            else f"no planner and parameter set is in both (the reference has {names or 'none'})"
        )
        return [blocks.Callout("note", [f"Nothing can be compared: {why}."])]
    content: list[Block] = []
    for item in judgements:
        content += _judged(item, material.axes)
    first, other = (
        next(iter(side.scenarios.values()), [None])[0] for side in (material, reference)
    )
    if first is not None and other is not None:
        differing = _differences(other, first, {*material.axes, *reference.axes})
        content.append(_settings_between(differing, judgements[0]))
    return content


def _settings_between(differing: Sequence[tuple[str, str, str]], names: _Judgement) -> Block:
    if not differing:
        return blocks.Paragraph("The settings of both campaigns are the same besides the axes.")
    rows = [[blocks.code(name), *map(blocks.breakable, values)] for name, *values in differing]
    return blocks.Table(
        "tab-settings-between",
        "Settings in which the two campaigns differ, besides the axes.",
        [
            blocks.Column("setting"),
            blocks.Column(names.reference, wide=True),
            blocks.Column(names.judged, wide=True),
        ],
        rows,
        small=True,
    )


def _judged(item: _Judgement, axes: sections.Axes) -> list[Block]:
    return comparison.comparison_blocks(item.judged, item.reference, item.result, axes, item.suffix)


# ------------------------------------------------------------------ settings


def _settings(material: Material, variants: Sequence[_Variant]) -> list[tuple[str, str, str]]:
    """Return the settings that differ from the defaults; those of some variants with their name."""
    by_variant = {
        item.name: _differences(material.defaults, material.scenarios[item.key][0], material.axes)
        for item in variants
        if material.scenarios.get(item.key)
    }
    everywhere = [
        row
        for row in next(iter(by_variant.values()), [])
        if all(row in own for own in by_variant.values())
    ]
    own_rows = [
        (f"{name}: {key}", default, value)
        for name, rows in by_variant.items()
        for key, default, value in rows
        if (key, default, value) not in everywhere
    ]
    return everywhere + own_rows


def _differences(
    before: Scenario, after: Scenario, left_out: Mapping[str, Any] | set[str]
) -> list[tuple[str, str, str]]:
    """Return dotted names and both values of what differs between two drives."""
    old, new = (flattened(item.model_dump(mode="json")) for item in (before, after))
    unsaid = {"name", "seed", "terrain.seed", *left_out}
    return [
        (key, _shown(old.get(key)), _shown(new.get(key)))
        for key in dict.fromkeys([*old, *new])
        if key not in unsaid and old.get(key) != new.get(key)
    ]


def flattened(data: Any, prefix: str = "") -> dict[str, Any]:
    """Return nested settings by dotted names."""
    if isinstance(data, Mapping) and data:
        return {
            name: value
            for key, item in data.items()
            for name, value in flattened(item, f"{prefix}.{key}" if prefix else str(key)).items()
        }
    return {prefix: data}


def _shown(value: Any) -> str:
    if value is None:
        return blocks.NOTHING
    return f"{value:.6g}" if isinstance(value, float) else str(value)


# ------------------------------------------------------------------ results


def _results(
    material: Material, variant: _Variant, is_one_of_several: bool, files: dict[str, bytes]
) -> list[Block]:
    rows, axes, suffix = variant.rows, material.axes, variant.suffix
    level = 1
    content: list[Block] = []
    if is_one_of_several:
        content.append(blocks.Heading(f"Results of {variant.name}", new_page=True))
        level = 2
    content.append(blocks.Heading("Success", level))
    content += sections.success_blocks(rows, axes, suffix)
    content.append(blocks.Heading("Driving and thinking", level))
    content += sections.metric_blocks(rows, axes, suffix)
    content.append(blocks.Heading("Reasons of failure", level))
    content += _outcomes(rows, axes, suffix, files)
    content.append(blocks.Heading("Drives without a path", level))
    causes = no_path_causes(rows)
    if causes.drives:
        bars = [
            (name.replace("_", " "), causes.main_at_end[name], causes.main_overall[name])
            for name in causes.reasons
            if causes.main_at_end[name] or causes.main_overall[name]
        ]
        files[f"causes{suffix}.svg"] = figures.cause_figure(bars)
    content += sections.cause_blocks(causes, f"causes{suffix}.svg", suffix)
    content.append(blocks.Heading("Margins", level))
    content += _margins(material, variant, files)
    return content


BARS_MAX = 45


def _outcomes(
    rows: Sequence[Row], axes: sections.Axes, suffix: str, files: dict[str, bytes]
) -> list[Block]:
    cells = [
        (cell_text(cell, list(axes)), outcome_counts(own))
        for cell, own in by_cell(rows, list(axes)).items()
    ]
    if len(cells) > BARS_MAX:
        text = [f"{len(cells)} cells: see ", blocks.ref(f"tab-outcomes{suffix}"), "."]
        return [blocks.Paragraph(text)]
    files[f"outcomes{suffix}.svg"] = figures.outcome_figure(cells)
    picture = blocks.Picture(
        f"fig-outcomes{suffix}",
        [
            "How the drives of every cell ended; numbers in ",
            blocks.ref(f"tab-outcomes{suffix}"),
            ".",
        ],
        f"outcomes{suffix}.svg",
    )
    return [blocks.Pictures([picture])]


# ------------------------------------------------------------------ margins


@dataclass(frozen=True, slots=True)
class _MarginView:
    """How a quantity is shown: name, unit, factor from SI, and where its limits stand."""

    name: str
    unit: str
    factor: float
    navlib_limit: str
    true_limit: str
    is_true_in_deg: bool


_DEG = math.degrees(1.0)
_MARGIN_VIEWS = {
    "clearance_m": _MarginView(
        "belly clearance", "m", 1.0, "clearance_min_m", "clearance_min_m", False
    ),
    "wheel_drop_m": _MarginView(
        "wheel drop", "m", 1.0, "wheel_drop_max_m", "wheel_drop_max_m", False
    ),
    "tilt_rad": _MarginView("tilt", "deg", _DEG, "tilt_max_rad", "tilt_max_deg", True),
    "rocker_rad": _MarginView(
        "rocker angle", "deg", _DEG, "rocker_max_rad", "rocker_max_deg", True
    ),
    "bogie_rad": _MarginView("bogie angle", "deg", _DEG, "bogie_max_rad", "bogie_max_deg", True),
}


def _margins(material: Material, variant: _Variant, files: dict[str, bytes]) -> list[Block]:
    total = summed(variant.margins)
    scenarios = material.scenarios.get(variant.key, ())
    shown = []
    for name, quantity in QUANTITIES.items():
        histogram, view = total[name], _MARGIN_VIEWS[name]
        if histogram.extreme is None:
            continue
        file = f"margin-{name}{variant.suffix}.svg"
        limits = _limits(view, scenarios)
        word = "least" if quantity.is_least else "largest"
        files[file] = figures.margin_figure(
            figures.Distribution(
                title=f"{view.name}, {view.unit}",
                unit=view.unit,
                edges=view.factor * quantity.edges,
                counts=np.array(histogram.counts),
                below=histogram.under,
                above=histogram.over,
                extreme=view.factor * histogram.extreme,
                extreme_name=word,
                limits=limits,
            )
        )
        caption = _margin_caption(view, quantity, histogram.total, view.factor * histogram.extreme)
        label = f"fig-{name.replace('_', '-')}{variant.suffix}"
        shown.append(blocks.Picture(label, caption, file))
    if not shown:
        return [blocks.Paragraph("No drive has told its margins.")]
    about = (
        "Every step of 1/8 s of every drive, the crawl at the start among them; the curve is the"
        " share of steps up to a value. Dashed: Navlib's limit, which bounds what it predicts;"
        " solid: the limit of the true rover, beyond which operators would call a fault."
    )
    return [blocks.Paragraph(about), *(blocks.Pictures([picture]) for picture in shown)]


def _margin_caption(view: _MarginView, quantity: Quantity, total: int, extreme: float) -> str:
    what = "values, left and right bogie of every step" if quantity.name == "bogie_rad" else "steps"
    word = "least" if quantity.is_least else "largest"
    return (
        f"{view.name.capitalize()} of the true rover, {blocks.whole(total)} {what}; the {word} is"
        f" {extreme:.3g} {view.unit}."
    )


def _limits(view: _MarginView, scenarios: Sequence[Scenario]) -> list[figures.LimitLine]:
    """Return all limits that drives were under."""
    factor = view.factor
    navlib = {factor * float(getattr(item.navlib, view.navlib_limit)) for item in scenarios}
    true = {
        float(getattr(item.vehicle.fault_limits, view.true_limit))
        for item in scenarios
        if not isinstance(item.vehicle, str)
    }
    return [
        *(figures.LimitLine("Navlib", value, False) for value in sorted(navlib)),
        *(figures.LimitLine("fault", value, True) for value in sorted(true)),
    ]


# ------------------------------------------------------------------ chosen failures


def choose_failures(
    rows: Sequence[Row], axes: Sequence[str], has_picture: Callable[[str], bool]
) -> list[Row]:
    """Return failures to show: outcome by outcome in turn, each time the lowest cell that is new.

    Violations on arcs called safe come first, then the most frequent outcome. Within an outcome a
    cell is shown again only when no other is left; within a cell the lowest seed comes first.
    """
    failed = [row for row in rows if not is_success(row) and has_picture(str(row["name"]))]
    frequent = list(outcome_counts(failed))
    kinds: dict[tuple[int, str], list[Row]] = {}
    for row in failed:
        place = violation_place(row)
        rank = -1 if place == "called safe" else frequent.index(str(row["outcome"]))
        kinds.setdefault((rank, str(row["outcome"])), []).append(row)
    queues = [_spread(kinds[key], axes) for key in sorted(kinds)]
    chosen: list[Row] = []
    while len(chosen) < PICTURES_MAX and any(queues):
        for queue in queues:
            if queue and len(chosen) < PICTURES_MAX:
                chosen.append(queue.pop(0))
    return chosen


def _spread(rows: Sequence[Row], axes: Sequence[str]) -> list[Row]:
    """Return rows so that every cell comes once before any comes again."""
    seen: dict[Cell, int] = {}
    ranked: list[tuple[int, int, Row]] = []
    for row in sorted(rows, key=lambda item: in_order(item, axes)):
        cell = cell_of(row, axes)
        seen[cell] = seen.get(cell, 0) + 1
        ranked.append((seen[cell], len(ranked), row))
    return [row for _, _, row in sorted(ranked, key=lambda item: item[:2])]


def _failures(
    material: Material, pictures: Sequence[tuple[Row, bytes]], files: dict[str, bytes]
) -> list[Block]:
    axes = list(material.axes)
    content: list[Block] = [blocks.Heading("Chosen failures")]
    if not pictures:
        missing = (
            "No drive failed."
            if all(map(is_success, material.rows))
            else f"No pictures of failed drives were kept (keep: {material.keep})."
        )
        return [*content, blocks.Paragraph(missing)]
    content.append(
        blocks.Paragraph(
            [
                "Overhead views at the end of drives. Which are shown: violations on arcs called"
                " safe first, then outcome by outcome in turn, the most frequent one first; of each"
                f" the lowest cell that is not shown yet, and its lowest seed; {PICTURES_MAX} at"
                " most. The command is run in the campaign folder.",
            ]
        )
    )
    shown: list[blocks.Picture] = []
    for row, jpeg in pictures:
        name = str(row["name"])
        files[f"picture-{len(shown)}.jpg"] = jpeg
        shown.append(
            blocks.Picture(
                f"fig-failure-{len(shown)}",
                [
                    blocks.strong(str(row["outcome"]).replace("_", " ")),
                    f"; {cell_text(cell_of(row, axes), axes)}; seed {row['seed']}."
                    f" {blocks.breakable(str(row['fault_detail']))}. Again: ",
                    blocks.code(f"enav drive --scenario drives/{name}/scenario.yaml -o ../{name}"),
                ],
                f"picture-{len(shown)}.jpg",
            )
        )
    return [*content, blocks.Pictures(shown, across=2)]


# ------------------------------------------------------------------ appendix


def _appendix(
    material: Material, variants: Sequence[_Variant], judgements: Sequence[_Judgement]
) -> list[Block]:
    content: list[Block] = [blocks.Heading("Appendix: tables", new_page=True)]
    for item in variants:
        if len(variants) > 1:
            content.append(blocks.Heading(item.name, level=2))
        content.append(sections.outcome_table(item.rows, material.axes, item.suffix))
        content += sections.appendix_tables(item.rows, material.axes, item.suffix)
    flipped = [
        block
        for item in judgements
        for block in comparison.flipped_blocks(
            item.judged, item.reference, item.result, material.axes, item.suffix
        )
    ]
    if flipped:
        content += [blocks.Heading("Drives that flipped", level=2), *flipped]
    return [
        *content,
        blocks.Heading("Failed drives", level=2),
        *sections.failed_blocks(material.rows, material.axes),
    ]
