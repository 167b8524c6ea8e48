# SPDX-License-Identifier: Apache-2.0
import math
from pathlib import Path

import pytest

from pyharness.params import param_values
from pyharness.scenario import (
    Scenario,
    check_places,
    directed_arcs,
    drive_info,
    load_scenario,
    make_terrain,
    navlib_params,
    vehicle_params,
    zones_request,
)
from sim.config import dump_model, parse_model
from sim.errors import ConfigError
from sim.vehicle import load_vehicle


def problems(tmp_path, text, overrides=None):
    path = tmp_path / "s.yaml"
    path.write_text(text)
    with pytest.raises(ConfigError) as caught:
        load_scenario(path, overrides or {})
    return [line.removeprefix(f"{path}:") for line in caught.value.problems]


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("sed: 1", "1:1: sed: unknown key, did you mean 'seed'?"),
        ("seed: one", "1:1: seed: expected an integer, got 'one'"),
        ("seed: 1\nseed: 2", "2:1: seed: duplicate key"),
        ("start: [1, 2]", "1:1: start.2: expected at least 3 items"),
        ("goal: 3", "1:1: goal: expected a list, got 3"),
        ("navlib: {tilt_max_rad: 9}", "expected 0.05 to 1.2 rad, got 9"),
        ("navlib: {tilt_maxx_rad: 1}", "unknown key, did you mean 'tilt_max_rad'?"),
        ("executive: {compute: {vo_s: -1}}", "executive.compute.vo_s: expected >= 0.0, got -1"),
        ("mode: avoid", "expected one of unguarded, guarded, avoid_koz, avoid_all"),
        ("zones: [{kind: keep_out, shape: circle}]", "a circle needs center_site_m, radius_m"),
        ("terrain: {file: a.pgm, cfa: 0.1}", "give a file or a recipe, not both"),
        ("goal: [1, 2]\nwaypoints: [{goal_site_m: [1, 2]}]", "give waypoints or a goal, not both"),
        ("name: ../x", "1:1: name: expected letters, digits"),
        ("[1, 2]", "1:1: expected keys and values at the top, got a list"),
    ],
)
def test_a_fault_is_one_line_with_its_place(tmp_path, text, line):
    (problem,) = problems(tmp_path, text)
    assert line in problem


def test_a_number_stuck_to_its_unit_is_no_number(tmp_path):
    (problem,) = problems(tmp_path, "executive: {crawl_length_m: 5.5m}")
    assert problem == "1:13: executive.crawl_length_m: expected a number, got '5.5m'"


def test_all_faults_are_told_at_once(tmp_path):
    assert len(problems(tmp_path, "sed: 1\nseed: x\nrecords: all")) == 3


def test_a_fault_of_an_override_names_the_override():
    with pytest.raises(ConfigError, match="--set seed: expected an integer"):
        load_scenario(None, {"seed": "x"})


def test_a_triangle_without_area_is_refused(tmp_path):
    zone = "zones: [{kind: keep_out, shape: triangle, vertices_site_m: [[0, 0], [1, 1], [2, 2]]}]"
    assert "degenerate" in problems(tmp_path, zone)[0]


def test_parameters_that_contradict_each_other_are_refused(tmp_path):
    # the belly box would have no length
    problem = problems(tmp_path, "navlib: {belly_front_x_m: -2.0}")
    assert problem[0].startswith("navlib: belly_")


def test_the_default_scenario_is_the_demonstration():
    scenario = load_scenario(None, {})
    info = drive_info(scenario)
    assert (info.start_north_m, info.start_east_m, info.start_yaw_rad) == (-40.0, 0.0, 0.0)
    assert [(item.north_m, item.east_m, item.mode) for item in info.waypoints] == [
        (40.0, 0.0, "avoid_all")
    ]
    assert scenario.terrain.cfa == 0.07


def test_a_resolved_scenario_is_its_own_resolution():
    settings = {
        "zones": [
            {"kind": "keep_out", "shape": "circle", "center_site_m": [1, 2], "radius_m": 3},
            {
                "kind": "keep_in",
                "shape": "rectangle",
                "center_site_m": [0, 0],
                "length_m": 100,
                "width_m": 90,
                "heading_deg": 10,
            },
        ],
        "seed": 5,
        "records": "display",
        "navlib.tilt_max_rad": 0.4,
    }
    scenario = load_scenario(None, settings)
    text = dump_model(scenario)
    path_scenario = parse_model(text, "again", Scenario)
    assert dump_model(path_scenario) == text
    assert navlib_params(scenario)["product_level"] == 1.0
    assert navlib_params(scenario)["tilt_max_rad"] == 0.4


def test_the_seed_drives_the_terrain_unless_that_has_its_own():
    assert load_scenario(None, {"seed": 9}).terrain.seed == 9
    assert load_scenario(None, {"seed": 9, "terrain.seed": 2}).terrain.seed == 2


@pytest.mark.parametrize("text", ["", "vehicle: perseverance", "vehicle: mine.yaml", "inline"])
def test_a_part_of_any_vehicle_can_be_set(tmp_path, text):
    mine = dump_model(load_vehicle(overrides={"name": "mine"}))
    (tmp_path / "mine.yaml").write_text(mine)
    if text == "inline":
        text = "vehicle:\n" + "".join(f"  {line}\n" for line in mine.splitlines())
    path = tmp_path / "s.yaml"
    path.write_text(text)
    scenario = load_scenario(path, {"vehicle.settling.wheel": "cylinder"})
    assert scenario.vehicle.settling.wheel == "cylinder"
    assert scenario.vehicle.name == (
        "mine" if "perseverance" not in text and text else "perseverance"
    )
    plain = load_scenario(path, {})
    assert scenario.vehicle.geometry == plain.vehicle.geometry
    assert plain.vehicle.settling.wheel == "disc"


def test_a_bad_part_of_a_vehicle_is_one_line(tmp_path):
    (problem,) = problems(tmp_path, "", {"vehicle.settling.wheel": "ball"})
    assert problem == (
        "--set vehicle.settling.wheel: expected one of point, disc, cylinder, got 'ball'"
        " (known: point, disc, cylinder)"
    )
    (problem,) = problems(tmp_path, "", {"vehicle.settling.weel": "disc"})
    assert problem == "--set vehicle.settling.weel: unknown key, did you mean 'wheel'?"


def test_the_vehicle_tells_navlib_its_geometry_and_limits():
    given = vehicle_params(load_vehicle())
    defaults = param_values({})
    assert set(given) <= set(defaults)
    for name, value in given.items():
        assert value == pytest.approx(defaults[name], abs=1e-6), name


def test_files_are_found_from_the_folder_of_the_scenario(tmp_path):
    (tmp_path / "s.yaml").write_text("terrain: {file: t/a.pgm}")
    assert load_scenario(tmp_path / "s.yaml", {}).terrain.file == str(tmp_path / "t/a.pgm")
    given = load_scenario(tmp_path / "s.yaml", {"terrain": {"file": "b.pgm"}})
    assert given.terrain.file == str(Path("b.pgm").absolute())


def test_a_mode_goes_for_all_waypoints(tmp_path):
    (tmp_path / "s.yaml").write_text("waypoints: [{goal_site_m: [1, 2]}, {goal_site_m: [3, 4]}]")
    info = drive_info(load_scenario(tmp_path / "s.yaml", {"mode": "guarded"}))
    assert [item.mode for item in info.waypoints] == ["guarded", "guarded"]


def test_zones_become_records():
    zone = {"kind": "keep_in", "shape": "rectangle", "center_site_m": [1.0, 2.0]}
    zone |= {"length_m": 5.0, "width_m": 4.0, "heading_deg": 90.0}
    request = zones_request(load_scenario(None, {"zones": [zone]}))
    assert int(request["zone_count"]) == 1
    assert float(request["zones"][0]["heading_rad"]) == pytest.approx(math.pi / 2)


def test_a_goal_off_the_terrain_is_told_with_its_place(tmp_path):
    path = tmp_path / "s.yaml"
    path.write_text("terrain: {size_m: 30}\nstart: [0, 0, 0]\ngoal: [300, 0]\n")
    scenario = load_scenario(path, {})
    terrain = make_terrain(scenario)
    with pytest.raises(ConfigError, match=r"s\.yaml:3:1: goal: 300, 0 is not on the terrain"):
        check_places(scenario, terrain, path, {})
    with pytest.raises(ConfigError, match="--set goal: 300, 0"):
        check_places(scenario, terrain, None, {"goal": [300, 0]})
    check_places(load_scenario(path, {"goal": [10, 0]}), terrain, path, {})


def test_arcs_alone_are_a_drive_that_leads_to_their_end():
    arcs = [{"length_m": 2.0}, {"length_m": 0, "heading_change_deg": 90}, {"length_m": 3.0}]
    scenario = load_scenario(None, {"arcs": arcs, "start": [0.0, 0.0, 0.0]})
    assert scenario.waypoints == ()
    (end,) = drive_info(scenario).waypoints
    assert (end.north_m, end.east_m) == pytest.approx((2.0, 3.0))
    first, turn, _ = directed_arcs(scenario)
    assert (first.arc.length_m, first.mode) == (2.0, "guarded")
    assert turn.arc.heading_change_rad == pytest.approx(math.pi / 2)


def test_a_goal_comes_after_arcs():
    scenario = load_scenario(None, {"arcs": [{"length_m": 2.0}], "goal": [5.0, 0.0]})
    assert [item.goal_site_m for item in scenario.waypoints] == [(5.0, 0.0)]


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"arcs": [{"length_m": 11.0}]}, "arcs.0.length_m"),
        ({"arcs": [{"length_m": 0}]}, "an arc needs a length or a heading change"),
        ({"arcs": [{"length_m": 1.0, "mode": "avoid_all"}]}, "arcs.0.mode"),
        ({"waypoints": []}, "at least one waypoint or arc"),
        ({"executive.compute": "fast"}, "expected flight_like, zero or its own keys, got 'fast'"),
        ({"executive.thinking": "never"}, "executive.thinking"),
        ({"prior_map_radius_m": 100.0}, "prior_map_radius_m"),
    ],
)
def test_bad_directions_are_one_clear_error(settings, message):
    with pytest.raises(ConfigError) as caught:
        load_scenario(None, settings)
    assert message in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


def test_compute_times_have_sets_by_name():
    zero = load_scenario(None, {"executive.compute": "zero"}).executive.compute
    assert set(zero.model_dump().values()) == {0.0}
    flight = load_scenario(None, {"executive.compute": "flight_like"}).executive.compute
    assert flight == load_scenario(None, {}).executive.compute
    assert flight.vo_s > 0.0


def test_a_resolved_scenario_of_arcs_is_read_back(tmp_path):
    scenario = load_scenario(None, {"arcs": [{"length_m": 2.0}], "executive.compute": "zero"})
    (tmp_path / "s.yaml").write_text(dump_model(scenario))
    assert load_scenario(tmp_path / "s.yaml", {}) == scenario


def test_parameters_of_a_planner_are_checked_with_their_place(tmp_path):
    text = "planner: gestalt\nplanner_params:\n  near_weight: 0.5\n  far_weight: 1\n"
    wrong, unknown = problems(tmp_path, text)
    assert wrong == "3:3: planner_params.near_weight: expected 1 to 20, got 0.5"
    assert unknown.startswith("4:3: planner_params.far_weight: unknown parameter (known: cell_")
    (line,) = problems(tmp_path, "planner: gestalt", {"planner_params.arc_count": 1.0})
    assert line == "--set planner_params.arc_count: expected 3 to 101, got 1"
    (line,) = problems(tmp_path, "planner_params: {arc_count: 5}")
    assert line == "1:18: planner_params.arc_count: unknown parameter (known: none)"


def test_a_resolved_scenario_holds_all_parameters_of_its_planner(tmp_path):
    scenario = load_scenario(None, {"planner": "rrtsharp", "planner_params.vertices": 77})
    assert scenario.planner_params["vertices"] == 77.0
    assert scenario.planner_params["goal_bias"] == 0.05
    path = tmp_path / "scenario.yaml"
    path.write_text(dump_model(scenario))
    assert load_scenario(path, {}) == scenario


def test_another_planner_than_that_of_the_file_has_its_own_defaults(tmp_path):
    path = tmp_path / "scenario.yaml"
    path.write_text("planner: rrtsharp\nplanner_params: {vertices: 77}\n")
    assert load_scenario(path, {"planner": "enav"}).planner_params == {}
    assert load_scenario(path, {"planner": "rrtsharp"}).planner_params["vertices"] == 77.0
    given = {"planner": "gestalt", "planner_params.arc_count": 7}
    assert "unknown parameter" in str(problems(tmp_path, path.read_text(), given))
