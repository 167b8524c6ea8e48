# SPDX-License-Identifier: Apache-2.0
"""The report of a campaign as a PDF: the same bytes for the same campaign folder."""

import io
import itertools
import json
import tempfile
from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

from PIL import Image

from pyharness import drive_table, report_template
from pyharness import report_blocks as blocks
from pyharness.campaign import Campaign, drives_of, scenario_of
from pyharness.campaign_statistics import Row, known
from pyharness.drive_table import DRIVES_FOLDER, DriveTable
from pyharness.errors import HarnessError
from pyharness.report_blocks import Report
from pyharness.report_content import Files, Material, build_report
from pyharness.report_failures import choose_failures
from pyharness.report_names import VariantKey, axis_title, axis_value, variant_of, variant_text
from pyharness.report_requirements import requirement_checks
from pyharness.scenario import Scenario, load_scenario
from sim.errors import SimError
from sim.terrain_io import write_atomic

TEMPLATE = "report.typ"
PICTURE_FILE = "overhead.png"
PICTURE_WIDTH_PX = 800
JPEG_QUALITY = 75

RUN_NAMES = {
    "enav_sim": "enav-sim",
    "revision": "source revision",
    "cpu": "processor",
    "wall_time_s": "wall time",
}


def write_report(folder: Path, out: Path, reference: Path | None) -> None:
    """Write the report of a campaign's folder, compared with another one where that is given.

    Raises:
        HarnessError: A folder is not a campaign's or has no finished drive, or typst is missing.
    """
    table = _load(folder)
    other = None if reference is None else material_of(_load(reference))
    report, files = build_report(material_of(table), other, _pictures(table))
    write_atomic(out, compile_pdf(report, files))


def _load(folder: Path) -> DriveTable:
    table = drive_table.load(folder)
    if not table.rows:
        raise HarnessError(f"{folder}: no drive is finished, nothing can be reported")
    return table


def compile_pdf(report: Report, files: Files) -> bytes:
    """Lay out a report.

    Raises:
        HarnessError: typst is not installed.
    """
    try:
        import typst
    except ImportError:
        raise HarnessError("a report needs typst: pip install 'enav-sim[report]'") from None
    with tempfile.TemporaryDirectory(prefix="enav-report-") as name:
        folder = Path(name)
        for file, content in files.items():
            (folder / file).write_bytes(content)
        text = json.dumps(report.as_json(), ensure_ascii=False, allow_nan=False)
        (folder / "report.json").write_text(text, "utf-8")
        template = resources.files(report_template).joinpath(TEMPLATE).read_text("utf-8")
        (folder / TEMPLATE).write_text(template, "utf-8")
        pdf: bytes = typst.compile(
            str(folder / TEMPLATE), root=str(folder), ignore_system_fonts=True, format="pdf"
        )
    return pdf


# ------------------------------------------------------------------ what is known of a campaign


def material_of(table: DriveTable) -> Material:
    """Return what a report says of a campaign."""
    campaign, rows = table.campaign, table.rows
    keys = list(dict.fromkeys(map(variant_of, rows)))
    checks = [
        check
        for key in keys
        for check in requirement_checks(
            campaign.requirements,
            [row for row in rows if variant_of(row) == key],
            campaign.axes,
            variant_text(key, keys) if len(keys) > 1 else "",
        )
    ]
    revision = table.run.get("revision")
    version = str(table.run.get("enav_sim", "of unknown version"))
    return Material(
        name=campaign.name,
        version=f"{version} ({revision})" if revision else version,
        versions=table.run.get("versions", []),
        when=str(table.run.get("started") or "")[:10],
        axes=campaign.axes,
        drives_expected=campaign.drive_count,
        rows=rows,
        margins=table.margins,
        scenarios=_scenarios(campaign),
        defaults=load_scenario(None, {}),
        about_campaign=_about_campaign(campaign),
        about_run=_about_run(table.run, rows),
        checks=checks,
        keep=campaign.keep,
    )


def _scenarios(campaign: Campaign) -> Mapping[VariantKey, Sequence[Scenario]]:
    """Return the settings of a drive of every cell; none where files that it names are gone."""
    scenarios: dict[VariantKey, list[Scenario]] = {}
    cells = campaign.drive_count // len(campaign.seed_list)
    for drive in itertools.islice(drives_of(campaign), cells):
        try:
            scenario = scenario_of(campaign, drive)
        except (HarnessError, SimError):
            continue
        scenarios.setdefault((drive.planner, drive.parameter_set), []).append(scenario)
    return scenarios


def _about_campaign(campaign: Campaign) -> list[tuple[str, str]]:
    seeds = campaign.seed_list
    runs = seeds == tuple(range(seeds[0], seeds[0] + len(seeds)))
    listed = f"{seeds[0]} to {seeds[-1]}" if runs else ", ".join(map(str, seeds))
    about = [("name", campaign.name)]
    about += [("settings of all drives", _settings_text(campaign.scenario) or "defaults")]
    about += [
        (f"axis {axis_title(axis)}", ", ".join(axis_value(axis, value) for value in values))
        for axis, values in campaign.axes.items()
    ]
    about += [
        ("seeds", f"{len(seeds)} in every cell: {listed}"),
        ("planners", ", ".join(campaign.planners)),
    ]
    about += [
        (f"parameter set {name}", _settings_text(settings) or "nothing changed")
        for name, settings in campaign.parameter_sets.items()
        if settings or len(campaign.parameter_sets) > 1
    ]
    return [
        *about,
        ("drives", blocks.whole(campaign.drive_count)),
        ("time-out of a drive", f"{campaign.time_out_s:g} s of wall time"),
        ("folders kept of", campaign.keep),
    ]


def _settings_text(settings: Mapping[str, Any]) -> str:
    return ", ".join(f"{name} = {json.dumps(value)}" for name, value in settings.items())


def _about_run(run: Mapping[str, Any], rows: Sequence[Row]) -> list[tuple[str, str]]:
    about = [
        (RUN_NAMES.get(name, name.replace("_", " ")), _run_text(name, value))
        for name, value in run.items()
        if value is not None
    ]
    walls_s = known(rows, "duration_wall_s")
    if walls_s:
        mean_s = sum(walls_s) / len(walls_s)
        total = f"{_duration_text(sum(walls_s))} in all, {mean_s:.1f} s a drive"
        about.append(("wall time of the drives", total))
    return about


def _run_text(name: str, value: Any) -> str:
    if name.endswith("_s") and isinstance(value, int | float):
        return _duration_text(float(value))
    if isinstance(value, list):
        return ", ".join(map(str, value))
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def _duration_text(duration_s: float) -> str:
    if duration_s < 120.0:
        return f"{duration_s:.1f} s"
    minutes = round(duration_s / 60.0)
    return f"{minutes} min" if minutes < 120 else f"{minutes // 60} h {minutes % 60} min"


# ------------------------------------------------------------------ pictures


def _pictures(table: DriveTable) -> list[tuple[Row, bytes]]:
    def path(name: str) -> Path:
        return table.folder / DRIVES_FOLDER / name / PICTURE_FILE

    chosen = choose_failures(
        table.rows, list(table.campaign.axes), lambda name: path(name).is_file()
    )
    return [(row, small_jpeg(path(str(row["name"])))) for row in chosen]


def small_jpeg(path: Path) -> bytes:
    """Return a picture as small as a report needs it.

    Raises:
        HarnessError: It is none.
    """
    file = io.BytesIO()
    try:
        with Image.open(path) as picture:
            height_px = round(picture.height * PICTURE_WIDTH_PX / picture.width)
            small = picture.convert("RGB").resize((PICTURE_WIDTH_PX, height_px))
            small.save(file, "JPEG", quality=JPEG_QUALITY)
    except (OSError, ValueError, SyntaxError):
        raise HarnessError(
            f"{path}: cannot be read as a picture (removed, it is left out)"
        ) from None
    return file.getvalue()
