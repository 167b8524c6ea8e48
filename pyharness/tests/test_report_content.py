# SPDX-License-Identifier: Apache-2.0
import json
from dataclasses import replace

import pytest

from pyharness import report_figures
from pyharness.margins import NO_MARGINS
from pyharness.report_content import (
    Material,
    build_report,
    flattened,
)
from pyharness.report_requirements import requirement_checks
from pyharness.scenario import load_scenario
from pyharness.tests.campaign_rows import (
    GRID,
    counted_margins,
    flat_row,
    made_campaign,
    rows_of,
)

DEFAULTS = load_scenario(None, {})


@pytest.fixture(autouse=True)
def _no_drawing(monkeypatch):
    """Figures are drawn in tests of their own."""
    for name in ("margin_figure", "outcome_figure", "cause_figure"):
        monkeypatch.setattr(report_figures, name, lambda *_: b"<svg/>")


def material(rows, axes=None, **changes):
    variants = dict.fromkeys((row["planner"], row["parameter_set"]) for row in rows)
    values = {
        "name": "made",
        "version": "0.1.0",
        "versions": ["0.1.0 abc"],
        "when": "2026-01-02",
        "axes": GRID if axes is None else axes,
        "drives_expected": len(rows),
        "rows": rows,
        "margins": [counted_margins() for _ in rows],
        "scenarios": dict.fromkeys(variants, (DEFAULTS,)),
        "defaults": DEFAULTS,
        "about_campaign": [("name", "made")],
        "about_run": [("processor", "any")],
        "checks": [],
        "keep": "failures",
    }
    return Material(**(values | changes))


def reached(*_):
    return "goal_reached"


def built(*args):
    """The report as the template reads it, and its files."""
    report, files = build_report(*args)
    return report.as_json(), files


def headings(data):
    return [block["text"] for block in data["blocks"] if block["kind"] == "heading"]


def labelled(data, label):
    return next(block for block in data["blocks"] if block.get("label") == label)


def text_of(data):
    text = json.dumps(data, ensure_ascii=False)
    return text.replace("\N{NARROW NO-BREAK SPACE}", " ").replace("\N{NO-BREAK SPACE}", " ")


def test_safety_comes_first_and_says_metres_and_violations():
    rows = rows_of(reached)
    rows[3] = flat_row("limit_violation", **{key: rows[3][key] for key in (*GRID, "name", "seed")})
    data, _ = built(material(rows), None, [])
    assert data["blocks"][0]["text"] == "Safety"
    statement = data["blocks"][1]
    assert statement["tone"] == "bad"
    assert (
        "960 m were driven on arcs that Navlib had called safe; 1 true limit violation happened"
        in text_of(statement)
    )
    assert labelled(data, "tab-safety")["rows"][0][1:3] == ["960 m", {"text": "1", "tone": "bad"}]
    assert rows[3]["name"] in text_of(labelled(data, "tab-violations"))


def test_no_violation_is_told_with_its_bound():
    data, _ = built(material(rows_of(reached)), None, [])
    assert data["blocks"][1]["tone"] == "good"
    # 3.0 of 0.96 km
    assert "at most 3.1 per km" in text_of(data["blocks"][1])
    assert "tab-violations" not in text_of(data)


def test_sections_stand_in_this_order():
    data, _ = built(material(rows_of(reached)), None, [])
    assert headings(data) == [
        "Safety", "Requirements", "What was run", "Success", "Driving and thinking",
        "Reasons of failure", "Drives without a path", "Margins", "Chosen failures",
        "Appendix: tables", "Failed drives",
    ]  # fmt: skip


def test_the_comparison_stands_behind_safety():
    rows = rows_of(reached)
    data, _ = built(material(rows), material(rows, name="old"), [])
    assert headings(data)[:3] == ["Safety", "Compared with old", "Requirements"]


def test_success_on_the_grid_has_interval_and_count():
    data, _ = built(
        material(rows_of(lambda slope, _, seed: "stuck" if slope and not seed else "goal_reached")),
        None,
        [],
    )
    grid = labelled(data, "tab-success")
    assert grid["columns"] == ["7 %", "10 %"]
    assert [row["title"] for row in grid["rows"]] == ["0 deg", "10 deg"]
    cell = grid["rows"][1]["cells"][0]
    assert (cell["main"], cell["sub"]) == ("67 %", "21 to 94 % · 2/3")


def test_drives_of_several_versions_are_told_first():
    data, _ = built(material(rows_of(reached), versions=["0.1.0 abc", "0.1.0 abd"]), None, [])
    assert "Made with 2 versions of enav-sim: 0.1.0 abc, 0.1.0 abd." in text_of(data["blocks"][0])


def test_a_cell_without_drives_is_empty():
    rows = [row for row in rows_of(reached) if row["terrain.slope_deg"] == 0]
    data, _ = built(material(rows, drives_expected=12), None, [])
    assert labelled(data, "tab-success")["rows"][1]["cells"][0]["main"] == "\N{EN DASH}"
    assert data["blocks"][0]["kind"] == "callout"
    assert "Incomplete: 6 of 12 drives" in text_of(data["blocks"][0])


@pytest.mark.parametrize("axes", [{}, {"terrain.cfa": [0.07, 0.1]}, {**GRID, "mode": ["guarded"]}])
def test_other_numbers_of_axes_make_tables(axes):
    rows = rows_of(reached, mode="guarded")
    data, files = built(material(rows, axes=axes), material(rows, axes=axes, name="old"), [])
    assert labelled(data, "tab-success")["kind"] == "table"
    assert labelled(data, "tab-change-against")["kind"] == "table"
    widths = [len(row) for row in labelled(data, "tab-performance")["rows"]]
    assert set(widths) == {len(labelled(data, "tab-performance")["columns"])}
    assert "outcomes.svg" in files


def test_axes_may_hold_text_and_lists():
    axes = {"mode": ["guarded", "avoid_all"], "start": [[0, 0, 0], [1, 0, 0]]}
    rows = [
        flat_row(mode=mode, start=start, seed=0) for mode in axes["mode"] for start in axes["start"]
    ]
    data, _ = built(material(rows, axes=axes), None, [])
    assert labelled(data, "tab-success")["rows"][1]["cells"][1]["main"] == "100 %"


def test_no_success_leaves_means_empty():
    data, _ = built(material(rows_of(lambda *_: "no_path")), None, [])
    assert labelled(data, "tab-success")["rows"][0]["cells"][0]["main"] == "0 %"
    cells = labelled(data, "tab-drive_rate_m_per_h")["rows"][0]["cells"]
    assert {cell["main"] for cell in cells} == {"\N{EN DASH}"}
    assert "12 drives ended because no path passed" in text_of(data)
    causes = labelled(data, "tab-causes")["rows"]
    assert causes[0][0] == "wheel drop"
    assert causes[0][2:] == ["12", "64.3 %", "0", "5.4 %"]


def test_one_drive_is_enough():
    data, _ = built(material([flat_row()], axes={}), None, [])
    assert "Every drive reached its goal." in text_of(data)


def test_drives_that_crashed_have_no_numbers():
    silent = dict.fromkeys(
        [name for name, value in flat_row().items() if isinstance(value, float | int)]
    )
    places = {"terrain.slope_deg": 0, "terrain.cfa": 0.07, "seed": 0}
    rows = [flat_row("crashed", **{**silent, **places, "fault_detail": "exit code 1"})]
    data, files = built(material(rows, margins=[NO_MARGINS]), None, [])
    assert "1 drive of these crashed" in text_of(data)
    assert data["blocks"][1]["tone"] == "note"
    assert not any(name.startswith("margin") for name in files)


def test_margins_are_drawn_with_limits_and_extreme():
    data, files = built(material(rows_of(reached)), None, [])
    assert sum(name.startswith("margin-") for name in files) == 5
    assert "Belly clearance of the true rover, 1 200 steps; the least is 0.4 m." in text_of(data)
    assert "2 400 values, left and right bogie" in text_of(data)


def test_settings_that_differ_from_defaults_are_listed():
    changed = load_scenario(None, {"navlib.tilt_max_rad": 0.5, "seed": 3})
    data, _ = built(
        material(rows_of(reached), scenarios={("enav", "default"): [changed]}), None, []
    )
    (row,) = labelled(data, "tab-settings")["rows"]
    assert row == [{"code": "navlib.tilt_max_rad"}, "0.523599", "0.5"]


def test_what_an_axis_changes_is_no_setting():
    changed = load_scenario(None, {"vehicle.belly.height_m": 0.7, "navlib.rocker_max_rad": 0.1})
    rows = [flat_row(vehicle="high")]
    known = material(rows, axes={"vehicle": ["high"]}, scenarios={("enav", "default"): [changed]})
    names = [row[0]["code"] for row in labelled(built(known, None, [])[0], "tab-settings")["rows"]]
    assert "navlib.rocker_max_rad" in names
    assert not [name for name in names if name.startswith("vehicle.")]


def test_requirements_are_marked():
    rows = rows_of(reached)
    wanted = made_campaign(requirements={"clearance_min_m": 0.5, "wheel_drop_max_m": 0.5})
    checks = requirement_checks(wanted.requirements, rows, GRID, "")
    data, _ = built(material(rows, checks=checks), None, [])
    tones = [row[-1]["tone"] for row in labelled(data, "tab-requirements")["rows"]]
    assert tones == ["bad", "good"]
    assert "1 of 2 requirements of the campaign are met." in text_of(data)


# ------------------------------------------------------------------ comparisons


def test_a_regression_is_said_first_thing_in_the_comparison():
    good = material(rows_of(reached, seeds=50), name="old")
    bad = material(
        rows_of(lambda slope, *_: "no_path" if slope else "goal_reached", seeds=50), name="new"
    )
    data, _ = built(bad, good, [])
    verdict = data["blocks"][4]
    assert verdict["tone"] == "bad"
    assert "New reaches the goal less often than old" in text_of(verdict)
    assert "200 pairs" in text_of(verdict)
    assert "p < 0.0001" in text_of(verdict)
    assert len(labelled(data, "tab-flipped-against")["rows"]) == 100


def test_two_identical_campaigns_show_no_difference():
    rows = rows_of(reached)
    data, _ = built(material(rows), material(rows), [])
    verdict = next(block for block in data["blocks"][2:] if block["kind"] == "callout")
    assert verdict["tone"] == "note"
    assert "No difference shown" in text_of(verdict)
    assert "The settings of both are the same" in text_of(data)


def test_what_has_no_partner_is_said():
    data, _ = built(material(rows_of(reached, seeds=3)), material(rows_of(reached, seeds=5)), [])
    assert "Left out: 8 drives of the reference without a partner" in text_of(data)


def test_other_axes_cannot_be_compared():
    reference = material(rows_of(reached), axes={"terrain.cfa": [0.07, 0.1]})
    data, _ = built(material(rows_of(reached)), reference, [])
    assert "Nothing can be compared: the axes of the reference are others" in text_of(data)


def test_settings_that_differ_between_campaigns_are_listed():
    rows = rows_of(reached)
    changed = load_scenario(None, {"navlib.tilt_max_rad": 0.5})
    reference = material(rows, name="old", scenarios={("enav", "default"): [changed]})
    data, _ = built(material(rows), reference, [])
    assert labelled(data, "tab-settings-against")["rows"] == [
        [{"code": "navlib.tilt_max_rad"}, "0.5", "0.523599"]
    ]


def test_planners_of_one_campaign_only_are_named():
    both = rows_of(reached) + rows_of(reached, planner="gestalt")
    other = rows_of(reached) + rows_of(reached, planner="rrtsharp")
    data, _ = built(material(both), material(other), [])
    assert "Left out, being in this campaign only: gestalt, default." in text_of(data)
    assert "Left out, being in the reference only: rrtsharp, default." in text_of(data)
    alone = rows_of(reached, planner="rrtsharp") + rows_of(reached, parameter_set="b")
    data, _ = built(material(rows_of(reached)), material(alone), [])
    assert "no planner and parameter set is in both" in text_of(data)


def test_two_campaigns_of_one_planner_each_are_compared_whatever_its_name():
    changed = load_scenario(None, {"planner": "gestalt"})
    other = material(
        rows_of(reached, planner="gestalt"),
        name="other",
        scenarios={("gestalt", "default"): [changed]},
    )
    data, _ = built(material(rows_of(reached)), other, [])
    assert "12 pairs" in text_of(data)
    assert [{"code": "planner"}, "gestalt", "enav"] in labelled(data, "tab-settings-against")[
        "rows"
    ]


def test_planners_of_one_campaign_are_compared_with_the_first():
    rows = rows_of(reached, seeds=20)
    rows += rows_of(lambda *_: "no_path", seeds=20, planner="gestalt")
    data, files = built(material(rows), None, [])
    assert "Gestalt reaches the goal less often than enav" in text_of(data)
    assert [text for text in headings(data) if text.startswith("Results of")] == [
        "Results of enav", "Results of gestalt",
    ]  # fmt: skip
    assert {"outcomes-1.svg", "outcomes-2.svg"} <= set(files)
    assert "called safe; 0 true limit violations" in text_of(data["blocks"][1])
    assert "gestalt: 6 400 m were driven on arcs that gestalt had called safe" in text_of(
        data["blocks"][1]
    )


def test_labels_are_used_once():
    rows = rows_of(reached) + rows_of(lambda *_: "no_path", parameter_set="other")
    pictures = [(rows[-1], b"jpeg"), (rows[-2], b"jpeg")]
    data, files = built(material(rows), material(rows), pictures)
    labels = [block["label"] for block in data["blocks"] if "label" in block]
    labels += [
        picture["label"]
        for block in data["blocks"]
        if block["kind"] == "pictures"
        for picture in block["pictures"]
    ]
    assert len(set(labels)) == len(labels)
    named = {
        picture["file"]
        for block in data["blocks"]
        if block["kind"] == "pictures"
        for picture in block["pictures"]
    }
    assert named == set(files)


# ------------------------------------------------------------------ failures, settings


def test_a_picture_says_how_to_run_the_drive_again():
    row = rows_of(lambda *_: "no_path")[0]
    data, files = built(material([row]), None, [(row, b"jpeg")])
    (picture,) = next(
        block["pictures"]
        for block in data["blocks"]
        if block["kind"] == "pictures" and block["across"] == 2
    )
    assert files[picture["file"]] == b"jpeg"
    assert f"enav drive --scenario drives/{row['name']}/scenario.yaml" in text_of(picture)
    assert "slope 0 deg, CFA 7 %; seed 0" in text_of(picture)


def test_nothing_kept_is_said():
    data, _ = built(replace(material(rows_of(lambda *_: "stuck")), keep="none"), None, [])
    assert "No pictures of failed drives were kept (keep: none)." in text_of(data)


def test_settings_are_flattened_to_dotted_names():
    assert flattened({"a": {"b": 1, "c": {}}, "d": [1]}) == {"a.b": 1, "a.c": {}, "d": [1]}
