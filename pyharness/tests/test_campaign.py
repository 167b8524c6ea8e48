# SPDX-License-Identifier: Apache-2.0
import json
from pathlib import Path

import pytest

from pyharness.campaign import Campaign, drives_of, load_campaign, scenario_of
from pyharness.campaigns import BUILT_IN
from sim.config import dump_model, parse_model
from sim.errors import ConfigError


def read(folder, text):
    path = folder / "c.yaml"
    path.write_text(text)
    return load_campaign(str(path))


def faults(folder, text):
    with pytest.raises(ConfigError) as error:
        read(folder, text)
    return [problem.replace(f"{folder}/", "") for problem in error.value.problems]


def campaign(**changes):
    return Campaign.model_validate_json(json.dumps({"name": "c", "seeds": 2} | changes))


def test_the_standard_campaign_is_the_published_grid():
    drives = list(drives_of(load_campaign("standard")))
    assert len(drives) == len({drive.name for drive in drives}) == 1200
    grid = {(slope, cfa) for slope in (0, 5, 10, 15, 20) for cfa in (0.07, 0.10, 0.12, 0.15)}
    for seed in range(60):
        assert {drive.axis_values for drive in drives if drive.seed == seed} == grid
    assert drives[0].name == "slope_deg0-cfa0.07-seed0000"


@pytest.mark.parametrize("name", BUILT_IN)
def test_campaigns_that_come_along_are_usable(name):
    assert load_campaign(name).name == name


def test_drives_come_seed_by_seed_and_in_every_cell_with_the_same_seeds():
    drives = list(
        drives_of(campaign(axes={"terrain.cfa": [0.07, 0.1]}, planners=["enav", "gestalt"]))
    )
    assert [drive.seed for drive in drives] == [0] * 4 + [1] * 4
    assert [drive.name for drive in drives[:4]] == [
        "enav-cfa0.07-seed0000",
        "gestalt-cfa0.07-seed0000",
        "enav-cfa0.1-seed0000",
        "gestalt-cfa0.1-seed0000",
    ]


def test_the_slope_azimuth_is_drawn_per_seed():
    drives = list(drives_of(campaign(axes={"terrain.slope_deg": [5, 10]})))
    for drive in drives:
        terrain = scenario_of(campaign(), drive).terrain
        assert (terrain.slope_azimuth_deg, terrain.seed) == (None, drive.seed)


def test_an_axis_wins_over_the_scenario_and_a_parameter_set_over_both():
    one = campaign(
        scenario={"terrain": {"cfa": 0.2, "size_m": 110}, "mode": "guarded"},
        axes={"terrain.cfa": [0.07]},
        parameter_sets={"koz": {"mode": "avoid_koz"}},
    )
    scenario = scenario_of(one, next(drives_of(one)))
    assert (scenario.terrain.cfa, scenario.terrain.size_m) == (0.07, 110)
    assert scenario.waypoints[0].mode == "avoid_koz"


def test_parameter_sets_may_name_planners():
    one = campaign(
        parameter_sets={
            "enav": {},
            "careful": {"planner": "gestalt", "planner_params": {"step_max_m": 0.25}},
        }
    )
    _, careful = list(drives_of(one))[:2]
    assert (careful.planner, careful.parameter_set) == ("gestalt", "careful")
    assert scenario_of(one, careful).planner_params["step_max_m"] == 0.25


def test_relative_names_of_files_start_at_the_folder_of_the_campaign(tmp_path):
    (tmp_path / "mine.py").write_text("from pyharness.planners.enav import Enav as Mine\n")
    one = read(tmp_path, "name: c\nseeds: 1\nplanners: ['mine.py:Mine']\n")
    (drive,) = drives_of(one)
    assert drive.planner == "mine.py:Mine"
    assert scenario_of(one, drive).planner == f"{tmp_path}/mine.py:Mine"
    again = read(tmp_path, dump_model(one))
    assert again == one
    assert scenario_of(again, drive).planner == f"{tmp_path}/mine.py:Mine"


def test_values_that_make_no_name_get_numbers():
    one = campaign(axes={"start": [[-40, 0, 0], [-40, 0, 90]]})
    assert [drive.name for drive in drives_of(one)][:2] == [
        "cell0000-seed0000",
        "cell0001-seed0000",
    ]
    modes = campaign(axes={"mode": ["guarded", "avoid_all"]})
    assert next(drives_of(modes)).name == "mode_guarded-seed0000"


HEAD = "name: c\nseeds: 2\n"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (HEAD + "sheeds: 1\n", "c.yaml:3:1: sheeds: unknown key, did you mean 'seeds'?"),
        ("name: c\n", "c.yaml:1:1: seeds: missing key"),
        ("name: c\nseeds: 0\n", "c.yaml:2:1: seeds: expected >= 1, got 0"),
        ("name: c\nseeds: [1, -1]\n", "c.yaml:2:12: seeds.1: expected >= 0, got -1"),
        ("name: c\nseeds: [1, 1]\n", "c.yaml:2:1: seeds: a value is given twice"),
        (
            HEAD + "scenario:\n  terrain: {cfaa: 0.1}\n",
            "c.yaml:4:13: terrain.cfaa: unknown key, did you mean 'cfa'?",
        ),
        (
            HEAD + "scenario: {seed: 3}\n",
            "c.yaml:3:1: scenario: seed is not for here, give seeds of the campaign",
        ),
        (
            HEAD + "axes:\n  terrain.cfa: [0.1, much]\n",
            "c.yaml:4:22: terrain.cfa: expected a number, got 'much'",
        ),
        (
            HEAD + "axes:\n  terain.cfa: [0.1]\n",
            "c.yaml:4:16: terain: unknown key, did you mean 'terrain'?",
        ),
        (
            HEAD + "axes: {terrain.cfa: []}\n",
            "c.yaml:3:8: axes.terrain.cfa: expected at least one value",
        ),
        (
            HEAD + "planners: [enav, nobody]\n",
            "c.yaml:3:18: planner nobody: expected file.py:Class or one of enav, gestalt, rrtsharp",
        ),
        (
            HEAD + "parameter_sets:\n  low: {navlib.clearance_min_m: -1}\n",
            "c.yaml:4:9: navlib.clearance_min_m: expected",
        ),
        (
            HEAD + "axes: {terrain.cfa: [0.1]}\nparameter_sets: {a: {terrain: {}}}\n",
            "c.yaml:1:1: parameter_sets.a.terrain: would replace the axis terrain.cfa",
        ),
        (
            HEAD + "planners: [enav, gestalt]\nparameter_sets: {a: {planner: enav}}\n",
            "c.yaml:1:1: give several planners, or planners in parameter_sets, not both",
        ),
        (
            HEAD + "keep: some\n",
            "c.yaml:3:1: keep: expected one of all, failures, none, got 'some'",
        ),
        (HEAD + "time_out_s: 0\n", "c.yaml:3:1: time_out_s: expected > 0"),
        (
            HEAD + "requirements:\n  success_rate_min: [{where: {cfa: [1]}, value: 1}]\n",
            "c.yaml:1:1: requirements.success_rate_min.0.where.cfa: not an axis",
        ),
        (
            HEAD + "scenario: {goal: [1, 1], waypoints: [{goal_site_m: [1, 1]}]}\n",
            "c.yaml: seed0000: give waypoints or a goal, not both",
        ),
    ],
)
def test_faults_are_named_with_their_place(tmp_path, text, expected):
    found = faults(tmp_path, text)
    assert len(found) == 1
    assert found[0].startswith(expected)


def test_every_cell_is_checked_and_all_faults_are_told(tmp_path):
    text = HEAD + "axes:\n  terrain.cfa: [0.1, 0.9]\n  terrain.slope_deg: [0, 80]\n"
    assert [fault.partition(": ")[0] for fault in faults(tmp_path, text)] == [
        "c.yaml:5:26",
        "c.yaml:4:22",
    ]


def test_a_name_that_is_nothing_is_one_line(tmp_path):
    with pytest.raises(ConfigError, match="no such file, expected a campaign's file or one of"):
        load_campaign(str(tmp_path / "standart"))


def test_a_campaign_that_comes_along_is_the_same_when_it_is_read_from_its_folder(tmp_path):
    one = load_campaign("standard")
    assert read(tmp_path, dump_model(one)) == one


def test_a_campaign_is_written_with_all_defaults_and_read_back(tmp_path):
    one = read(tmp_path, HEAD)
    assert parse_model(dump_model(one), "again", Campaign) == one
    assert "time_out_s: 600.0" in dump_model(one)


def test_the_campaign_of_the_documentation_is_one(tmp_path):
    page = (Path(__file__).parents[2] / "docs/montecarlo.md").read_text("utf-8")
    text = page.partition("```yaml\n")[2].partition("```")[0]
    assert read(tmp_path, text).name == "low-clearance"
