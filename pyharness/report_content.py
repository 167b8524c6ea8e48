# SPDX-License-Identifier: Apache-2.0
"""A whole report from what is known of a campaign: blocks, and the figures they name."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pyharness import report_blocks as blocks
from pyharness import report_comparison as comparison
from pyharness import report_figures as figures
from pyharness import report_sections as sections
from pyharness.campaign_pairs import Comparison, compare
from pyharness.campaign_statistics import (
    Row,
    by_cell,
    no_path_causes,
    outcome_counts,
    safety,
)
from pyharness.margins import Margins
from pyharness.report_blocks import Block, Report
from pyharness.report_failures import failure_blocks
from pyharness.report_margins import margin_blocks
from pyharness.report_names import VariantKey, cell_text, variant_of, variant_text
from pyharness.scenario import Scenario

BARS_MAX = 45
"""Cells that a figure has room for."""

Files = Mapping[str, bytes]
"""Figures and pictures by the names that the blocks give them."""


@dataclass(frozen=True, slots=True)
class Material:
    """What is known of a campaign.

    Attributes:
        name: Of the campaign.
        version: Of the software that ran last, with its revision where there is one.
        versions: All that drives were made with, as far as they are known.
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
    versions: Sequence[str]
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
    """A comparison with the names of both sides, and whose drives they are."""

    judged: str
    reference: str
    result: Comparison
    suffix: str
    keys: tuple[VariantKey, VariantKey]


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
    content: list[Block] = [*_incomplete(material), *_mixed(material)]
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
    content.append(blocks.Heading("Chosen failures"))
    content += failure_blocks(material.rows, material.axes, pictures, material.keep, files)
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


def _mixed(material: Material) -> list[Block]:
    if len(material.versions) <= 1:
        return []
    text = (
        f"Made with {len(material.versions)} versions of enav-sim: {', '.join(material.versions)}."
    )
    return [blocks.Callout("note", [blocks.strong(text)])]


# ------------------------------------------------------------------ comparisons


def _against(material: Material, reference: Material) -> list[_Judgement]:
    """Compare with another campaign: what has the same name, or what is alone on both sides."""
    own, other = _variants(material), _variants(reference)
    if set(material.axes) != set(reference.axes):
        return []
    partners = {item.key: item for item in other}
    if len(own) == len(other) == 1:
        partners = {own[0].key: other[0]}
    return [
        _Judgement(
            *_two_names(material, item, reference, partners[item.key], len(own) > 1),
            compare(partners[item.key].rows, item.rows, list(material.axes)),
            f"-against{item.suffix}",
            (item.key, partners[item.key].key),
        )
        for item in own
        if item.key in partners
    ]


def _two_names(
    material: Material, item: _Variant, reference: Material, partner: _Variant, is_one_of_many: bool
) -> tuple[str, str]:
    """Return short names of both sides that differ."""
    if material.name == reference.name and item.key != partner.key:
        return " ".join(item.key), " ".join(partner.key)
    names = (material.name, reference.name)
    judged, referred = names if names[0] != names[1] else ("this campaign", "the reference")
    if is_one_of_many:
        return f"{judged}: {item.name}", f"{referred}: {item.name}"
    return judged, referred


def _among(variants: Sequence[_Variant], axes: sections.Axes) -> list[_Judgement]:
    """Compare the others of one campaign with the first."""
    return [
        _Judgement(
            other.name,
            variants[0].name,
            compare(variants[0].rows, other.rows, list(axes)),
            f"-within{other.suffix}",
            (other.key, variants[0].key),
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
        sides = [
            side.scenarios.get(key, ())
            for side, key in zip((material, reference), item.keys, strict=True)
        ]
        if all(sides):
            differing = _differences(sides[1][0], sides[0][0], material.axes)
            content.append(_settings_between(differing, item))
    return content + _without_partner(judgements, material, reference)


def _without_partner(
    judgements: Sequence[_Judgement], material: Material, reference: Material
) -> list[Block]:
    """Name the planners and parameter sets that only one campaign has."""
    lines = []
    for side, whose, index in ((material, "this campaign", 0), (reference, "the reference", 1)):
        compared = {item.keys[index] for item in judgements}
        alone = [key for key in dict.fromkeys(map(variant_of, side.rows)) if key not in compared]
        if alone:
            names = "; ".join(", ".join(key) for key in alone)
            lines.append(f"Left out, being in {whose} only: {names}.")
    return [blocks.Callout("note", lines)] if lines else []


def _settings_between(differing: Sequence[tuple[str, str, str]], item: _Judgement) -> Block:
    if not differing:
        return blocks.Paragraph("The settings of both are the same besides the axes.")
    rows = [[blocks.code(name), *values] for name, *values in differing]
    return blocks.Table(
        f"tab-settings{item.suffix}",
        "Settings in which the two differ, besides the axes.",
        [
            blocks.Column("setting"),
            blocks.Column(item.reference, wide=True),
            blocks.Column(item.judged, wide=True),
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
    before: Scenario, after: Scenario, axes: sections.Axes
) -> list[tuple[str, str, str]]:
    """Return dotted names and both values of what differs between two drives besides axes."""
    old, new = (flattened(item.model_dump(mode="json")) for item in (before, after))
    unsaid = {"name", "seed", "terrain.seed"} | {
        key for key in [*old, *new] for axis in axes if f"{key}.".startswith(f"{axis}.")
    }
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
    limits = material.scenarios.get(variant.key, ())
    return content + margin_blocks(variant.margins, limits, suffix, files)


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
