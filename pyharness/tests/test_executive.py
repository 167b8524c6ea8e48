# SPDX-License-Identifier: Apache-2.0
"""The executive against a world and a planner that do as they are told."""

import itertools
from dataclasses import replace

import pytest

from pyharness.dp import Kind, native_schema
from pyharness.executive_config import ComputeTimes
from pyharness.faults import SafetyWatch
from pyharness.records import Waypoint
from pyharness.status import Activity, Mode
from pyharness.tests.executive_drive import ARC_S


def test_the_drive_ends_inside_the_waydisc(make_drive):
    drive = make_drive()
    assert drive.run().outcome == "goal_reached"
    assert drive.world.state.x_m == pytest.approx(14.0, abs=0.02)


def test_standing_to_think_the_rover_looks_and_plans_between_arcs(make_drive):
    drive = make_drive(thinking="standing")
    assert drive.run().is_reached
    driving = [item for item in drive.timeline(Activity.DRIVING) if item[2] > 0]
    times = drive.config.compute
    think_s = times.imaging_s + times.vo_s + times.process_disparity_s + times.analyze_terrain_s
    gaps_s = [second[0] - first[1] for first, second in itertools.pairwise(driving)]
    assert min(gaps_s) > think_s
    for lane in (Activity.IMAGING, Activity.PROCESS_DISPARITY, Activity.SELECT_ARC):
        starts_s = [start_s for start_s, _, cycle in drive.timeline(lane) if cycle > 0]
        assert not any(
            start_s <= time_s < end_s for time_s in starts_s for start_s, end_s, _ in driving
        )
    # what was seen last is in the plan
    _, request = drive.calls("select")[-1]
    newest_s = max(float(item["time_s"]) for _, item in drive.calls("process"))
    assert float(request["time_s"]) - newest_s == pytest.approx(think_s, abs=1.0)


def test_the_plan_uses_terrain_seen_two_arcs_earlier(make_drive):
    drive = make_drive()
    drive.run()
    starts = [item[0] for item in drive.timeline(Activity.DRIVING)]
    planned = [start_s for start_s in starts if start_s > 150.0]
    for k in range(2, len(planned) - 1):
        selected_s = max(time_s for time_s, _ in drive.calls("select") if time_s < planned[k])
        merged = next(
            index
            for index, (name, _, _) in enumerate(drive.planner.calls)
            if name == "select" and drive.planner.calls[index][1] == selected_s
        )
        newest_s = max(
            float(request["time_s"])
            for name, _, request in drive.planner.calls[:merged]
            if name == "process"
        )
        assert newest_s == planned[k - 2]


def test_vo_starts_at_the_middle_of_the_arc_and_planning_follows_it(make_drive):
    drive = make_drive()
    drive.run()
    arc_start_s, arc_end_s, cycle = drive.timeline(Activity.DRIVING)[8]
    (vo,) = [item for item in drive.timeline(Activity.VISUAL_ODOMETRY) if item[2] == cycle]
    (analysis,) = [item for item in drive.timeline(Activity.ANALYZE_TERRAIN) if item[2] == cycle]
    (selection,) = [item for item in drive.timeline(Activity.SELECT_ARC) if item[2] == cycle]
    middle_s = 0.5 * (arc_start_s + arc_end_s)
    assert middle_s <= vo[0] <= middle_s + drive.config.compute.evaluate_base_s + 0.25
    assert vo[1] <= analysis[0] < analysis[1] <= selection[0] < selection[1] <= arc_end_s


def test_one_computer_does_one_thing_at_a_time(make_drive):
    drive = make_drive()
    drive.run()
    lanes = (
        Activity.VISUAL_ODOMETRY,
        Activity.PROCESS_DISPARITY,
        Activity.ANALYZE_TERRAIN,
        Activity.SELECT_ARC,
        Activity.EVALUATE_ARC,
    )
    busy = sorted(item for lane in lanes for item in drive.timeline(lane))
    assert all(first[1] <= second[0] + 1e-9 for first, second in itertools.pairwise(busy))


def test_the_next_arc_is_selected_from_where_this_one_ends(make_drive):
    drive = make_drive()
    drive.run()
    time_s, request = drive.calls("select")[3]
    arc_end_s = next(
        end_s for start_s, end_s, _ in drive.timeline(Activity.DRIVING) if end_s > time_s
    )
    truths = [item for item in drive.records if item.kind == Kind.TRUTH]
    at_end = next(item for item in truths if item.time_s >= arc_end_s)
    pose = native_schema().decode(Kind.TRUTH, at_end.payload)["pose"]
    assert float(request["pose"]["x_site_m"]) == pytest.approx(float(pose["x_site_m"]), abs=0.01)


def test_straight_on_the_rover_does_not_stop(make_drive):
    drive = make_drive()
    drive.run()
    driving = [item for item in drive.timeline(Activity.DRIVING) if item[2] > 0]
    assert len(driving) > 5
    assert all(first[1] == second[0] for first, second in itertools.pairwise(driving))
    assert drive.timeline(Activity.STEERING) == []


def test_it_stops_to_steer_only_when_the_curvature_changes(make_drive):
    drive = make_drive()
    drive.planner.arcs = [(1.0, 0.0), (1.0, 0.1), (1.0, 0.1), (1.0, -0.1), (1.0, 0.0)]
    drive.run()
    steering = drive.timeline(Activity.STEERING)
    assert [item[2] for item in steering] == [2, 4, 5]
    assert all(end_s - start_s == pytest.approx(10.0) for start_s, end_s, _ in steering)


def test_it_waits_when_thinking_is_late(make_drive):
    drive = make_drive()
    drive.planner.ace_evaluations = 1000
    drive.run()
    driving = [item for item in drive.timeline(Activity.DRIVING) if item[2] > 0]
    gaps_s = [second[0] - first[1] for first, second in itertools.pairwise(driving)]
    assert all(gap_s > 5.0 for gap_s in gaps_s)
    assert drive.outcome.is_reached


def test_evaluation_repeats_on_what_remains_of_the_arc(make_drive):
    drive = make_drive()
    drive.run()
    start_s, end_s, cycle = drive.timeline(Activity.DRIVING)[8]
    times = [item[0] for item in drive.timeline(Activity.EVALUATE_ARC) if item[2] == cycle]
    vo_end_s = next(
        item[1] for item in drive.timeline(Activity.VISUAL_ODOMETRY) if item[2] == cycle
    )
    assert len(times) >= 4
    assert any(vo_end_s <= time_s <= vo_end_s + 0.25 for time_s in times)
    requests = [item for item in drive.calls("evaluate") if start_s <= item[0] < end_s]
    lengths_m = [float(request["arc"]["length_m"]) for _, request in requests]
    assert lengths_m == sorted(lengths_m, reverse=True)
    assert all(0.05 <= length_m <= 1.0 for length_m in lengths_m)


def test_an_unsafe_arc_stops_the_rover_which_looks_and_plans_again(make_drive):
    drive = make_drive()
    drive.planner.is_safe = [True, True, False, True]
    assert drive.run().is_reached
    stopped = drive.timeline(Activity.DRIVING)[6]
    assert stopped[1] - stopped[0] < ARC_S
    following = next(item for item in drive.timeline(Activity.SELECT_ARC) if item[0] > stopped[1])
    looks = [time_s for time_s in drive.world.images if stopped[1] <= time_s < following[0]]
    assert len(looks) == 1
    merged_s = [
        float(request["time_s"]) for name, _, request in drive.planner.calls if name == "process"
    ]
    assert looks[0] in merged_s


def test_arcs_that_stay_unsafe_are_a_fault(make_drive):
    drive = make_drive(replans_max=2)
    drive.planner.is_safe = [False]
    outcome = drive.run()
    assert outcome.outcome == "unsafe_arc"
    assert outcome.fault_detail.startswith("3 times in a row in mode avoid_all; evaluate_arc")
    assert "tilt" in outcome.fault_detail


def test_after_an_unsafe_arc_the_selection_keeps_more_distance(make_drive):
    drive = make_drive(replans_max=2)
    drive.planner.is_safe = [False]
    drive.run()
    sizes_m = [float(request["uncertainty"]["position_m"]) for _, request in drive.calls("select")]
    margin_m = drive.config.uncertainty.unsafe_margin_m
    assert [size_m - sizes_m[0] for size_m in sizes_m] == pytest.approx([0, margin_m, 2 * margin_m])


def test_without_a_path_it_looks_around_and_goes_on(make_drive):
    drive = make_drive()
    drive.planner.arcs = [(1.0, 0.0), None, None, (1.0, 0.0)]
    assert drive.run().is_reached
    assert len(drive.world.looks) == 2
    imaging = [item for item in drive.timeline(Activity.IMAGING) if item[0] in drive.world.looks]
    assert imaging[0][1] - imaging[0][0] == (
        len(drive.config.look_around_deg) * drive.config.compute.imaging_s
    )


def test_no_path_again_and_again_is_a_fault_with_the_reasons(make_drive):
    drive = make_drive(replans_max=3)
    drive.planner.arcs = [None]
    outcome = drive.run()
    assert outcome.outcome == "no_path"
    assert outcome.fault_detail == ("4 times in a row in mode avoid_all; paths rejected: tilt 1694")
    assert len(drive.world.looks) == 3


def test_waypoints_are_driven_to_in_turn_each_in_its_mode(make_drive):
    goals = (Waypoint(8.0, 0.0, 1.0, "guarded"), Waypoint(12.0, 0.0, 1.0, "avoid_koz"))
    drive = make_drive(waypoints=goals)
    assert drive.run().is_reached
    modes = [int(request["mode"]) for _, request in drive.calls("select")]
    assert modes == sorted(modes)
    assert set(modes) == {Mode.GUARDED, Mode.AVOID_KOZ}
    assert drive.world.state.x_m == pytest.approx(11.0, abs=0.02)


def test_a_goal_under_the_rover_needs_no_driving(make_drive):
    drive = make_drive(waypoints=(Waypoint(0.5, 0.0, 1.0, "avoid_all"),))
    assert drive.run().is_reached
    assert drive.world.ticks == 0


@pytest.mark.parametrize("name", ["process", "analyze", "select", "evaluate"])
def test_a_planner_that_refuses_ends_the_drive(make_drive, name):
    drive = make_drive()
    drive.planner.refuses = name
    assert drive.run().outcome == "planner_error"


def test_a_true_violation_ends_the_drive_and_says_what_navlib_thought(make_drive):
    safety = SafetyWatch(
        lambda truth: "tilt 40 deg over tilt_max_deg 35" if truth.x_m > 8.0 else None,
        lambda *_: False,
        str,
    )
    outcome = make_drive(safety=safety).run()
    assert outcome.outcome == "limit_violation"
    assert "tilt 40 deg" in outcome.fault_detail
    assert "said safe" in outcome.fault_detail


def test_a_true_position_in_a_zone_is_a_fault(make_drive):
    safety = SafetyWatch(lambda _: None, lambda north_m, _: north_m > 9.0, str)
    assert make_drive(safety=safety).run().outcome == "kioz_violation"


def test_time_runs_out(make_drive):
    outcome = make_drive(time_limit_s=200.0).run()
    assert outcome.outcome == "time_limit"
    assert outcome.fault_detail.startswith("200 s")


def test_wheels_that_slip_through_are_stuck(make_drive):
    assert make_drive(motion_share=0.1).run().outcome == "stuck"


def test_leaving_the_terrain_is_a_fault(make_drive, monkeypatch):
    drive = make_drive()
    step = drive.world.step

    def off_the_map():
        truth = step()
        return replace(truth, on_map=truth.x_m < 3.0)

    monkeypatch.setattr(drive.world, "step", off_the_map)
    assert drive.run().outcome == "left_map"


def test_the_timeline_of_the_wheels_has_no_gap(make_drive):
    drive = make_drive()
    drive.planner.arcs = [(1.0, 0.0), None, (1.0, 0.2), (0.0, 0.5), (1.0, 0.0)]
    drive.run()
    lanes = (Activity.WAITING, Activity.STEERING, Activity.DRIVING)
    spans = sorted(item for lane in lanes for item in drive.timeline(lane))
    assert spans[0][0] == 0.0
    assert spans[-1][1] == drive.world.time_s
    assert all(first[1] == second[0] for first, second in itertools.pairwise(spans))


def test_truth_is_recorded_at_every_tick(make_drive):
    drive = make_drive()
    drive.run()
    assert sum(item.kind == Kind.TRUTH for item in drive.records) == drive.world.ticks


def test_instant_thinking_is_allowed(make_drive):
    times = ComputeTimes(**dict.fromkeys(ComputeTimes.model_fields, 0.0))
    assert make_drive(compute=times).run().is_reached
