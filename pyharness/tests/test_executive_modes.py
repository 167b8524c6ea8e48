# SPDX-License-Identifier: Apache-2.0
"""Directed arcs, the crawl, the modes, and what is kept from zones."""

import pytest

from pyharness.dp import Kind, new_message
from pyharness.faults import SafetyWatch
from pyharness.messages import Arc, DirectedArc
from pyharness.records import Waypoint
from pyharness.status import Activity, HostEvr, Reason
from pyharness.tests.executive_drive import ARC_S


def test_the_crawl_is_straight_unguarded_and_checked_against_zones_only(make_drive):
    drive = make_drive()
    drive.run()
    crawl = [item for item in drive.timeline(Activity.DRIVING) if item[2] == 0]
    assert sum(end_s - start_s for start_s, end_s, _ in crawl) == pytest.approx(5.5 * ARC_S)
    assert min(time_s for time_s, _ in drive.calls("select")) >= crawl[-1][1]
    assert min(time_s for time_s, _ in drive.calls("evaluate")) >= crawl[-1][1]
    checks = [request for _, request in drive.calls("check_zones")]
    assert float(checks[0]["arc"]["length_m"]) == 5.5
    assert len(checks) > 20
    # an image before it, and one at the start of every metre
    assert drive.world.images[1:7] == [item[0] for item in crawl]
    assert drive.events()[:3] == [HostEvr.GO_TO, HostEvr.CRAWL, HostEvr.WAYPOINT_REACHED]


def test_the_crawl_is_as_long_as_the_rover_believes_not_as_commanded(make_drive):
    drive = make_drive(motion_share=0.8)
    drive.run()
    crawl = [item for item in drive.timeline(Activity.DRIVING) if item[2] == 0]
    assert sum(end_s - start_s for start_s, end_s, _ in crawl) >= 5.5 / 0.8 * ARC_S - 0.125


def test_a_zone_ahead_of_the_crawl_is_refused_before_the_rover_moves(make_drive):
    drive = make_drive()
    drive.planner.zone_north_m = 4.0
    outcome = drive.run()
    assert outcome.outcome == "unsafe_arc"
    assert "kioz" in outcome.fault_detail
    assert drive.timeline(Activity.DRIVING) == []


def test_the_crawl_is_skipped_where_the_map_under_the_rover_is_known(make_drive):
    drive = make_drive(prior_m=4.0)
    drive.planner.is_map_known = True
    assert drive.run().is_reached
    assert drive.calls("check_zones") == []
    assert HostEvr.CRAWL_SKIPPED in drive.events()
    _, prior = drive.calls("process")[0]
    assert (float(prior["time_s"]), float(prior["points"][0]["x_m"])) == (0.0, 4.0)


def test_a_directed_arc_is_evaluated_before_and_while_it_is_driven(make_drive):
    arcs = (DirectedArc(Arc(3.0, 0.6), "guarded"), DirectedArc(Arc(0.0, 1.0), "unguarded"))
    drive = make_drive(arcs=arcs, waypoints=())
    assert drive.run().outcome == "arcs_driven"
    driving = drive.timeline(Activity.DRIVING)
    first_s = driving[0][0]
    before = [request for time_s, request in drive.calls("evaluate") if time_s < first_s]
    assert [float(request["arc"]["length_m"]) for request in before] == [3.0]
    during = [request for time_s, request in drive.calls("evaluate") if time_s >= first_s]
    lengths_m = [float(request["arc"]["length_m"]) for request in during]
    assert len(lengths_m) > 9
    assert lengths_m == sorted(lengths_m, reverse=True)
    shape = [float(item["arc"]["heading_change_rad"] / item["arc"]["length_m"]) for item in during]
    assert shape == pytest.approx([0.2] * len(shape))
    # three pieces without a stop, an image at the start of each; then the turn in place
    assert [end_s - start_s for start_s, end_s, _ in driving] == [20.0, 20.0, 20.0, 20.0]
    assert driving[0][1] == driving[1][0]
    assert len(drive.timeline(Activity.STEERING)) == 2
    assert drive.calls("select") == []
    assert drive.events() == [HostEvr.DIRECTED_ARC, HostEvr.DIRECTED_ARC]


@pytest.mark.parametrize("check", [0, 5])
def test_an_unsafe_directed_arc_is_a_fault_and_no_other_is_looked_for(make_drive, check):
    drive = make_drive(arcs=(DirectedArc(Arc(3.0, 0.0), "guarded"),), waypoints=())
    drive.planner.is_safe = [True] * check + [False]
    outcome = drive.run()
    assert outcome.outcome == "unsafe_arc"
    assert bool(drive.timeline(Activity.DRIVING)) == (check > 0)
    assert drive.world.state.x_m < 3.0
    assert drive.events()[-1] == HostEvr.FAULT_UNSAFE_ARC


def test_waypoints_follow_directed_arcs_without_a_crawl_where_the_map_is_known(make_drive):
    drive = make_drive(arcs=(DirectedArc(Arc(6.0, 0.0), "unguarded"),))
    drive.planner.is_map_known = True
    assert drive.run().is_reached
    assert drive.events()[:3] == [HostEvr.DIRECTED_ARC, HostEvr.GO_TO, HostEvr.CRAWL_SKIPPED]


@pytest.mark.parametrize("mode", ["unguarded", "guarded"])
def test_the_modes_that_know_one_path_end_at_its_refusal(make_drive, mode):
    drive = make_drive(waypoints=(Waypoint(15.0, 0.0, 1.0, mode),))
    drive.planner.arcs = [(1.0, 0.0), None]
    outcome = drive.run()
    assert outcome.outcome == "no_path"
    assert outcome.fault_detail.startswith(f"once in mode {mode}")
    assert drive.world.looks == []


def test_guarded_stops_at_an_unsafe_arc_for_good(make_drive):
    drive = make_drive(waypoints=(Waypoint(15.0, 0.0, 1.0, "guarded"),))
    drive.planner.is_safe = [True, True, False, True]
    assert drive.run().outcome == "unsafe_arc"


def test_slip_shifts_the_predicted_pose_and_widens_its_uncertainty(make_drive, expected_slip):
    requests = []
    for slip in (expected_slip(), expected_slip(-0.02, 0.01, 0.05, 0.03)):
        drive = make_drive()
        drive.world.slip = slip
        drive.run()
        requests.append(drive.calls("select")[3][1])
    plain, slipping = requests
    for name, group, change in (
        ("x_site_m", "pose", -0.02),
        ("y_site_m", "pose", 0.01),
        ("position_m", "uncertainty", 0.05),
        ("yaw_rad", "uncertainty", 0.03),
    ):
        assert float(slipping[group][name] - plain[group][name]) == pytest.approx(change), name


def test_zones_grow_by_what_the_error_will_be_before_the_next_fix(make_drive):
    drive = make_drive()
    drive.run()
    _, request = drive.calls("select")[3]
    config = drive.config.uncertainty
    grown_m = float(request["uncertainty"]["global_position_m"]) - config.zone_margin_m
    sigma_m = grown_m / config.global_sigmas
    ahead_m = (sigma_m - drive.world.state.sigma_position_m) / 0.1
    assert 0.05 < ahead_m - config.unfixed_ahead_m < 0.5


def test_more_than_three_sigmas_are_kept_from_zones_while_there_is_a_path_that_does(make_drive):
    drive = make_drive()
    drive.planner.reject_reason = Reason.KIOZ
    drive.planner.arcs = [(1.0, 0.0), None, (1.0, 0.0)]
    assert drive.run().is_reached
    grown_m = [float(item["uncertainty"]["global_position_m"]) for _, item in drive.calls("select")]
    margin_m = drive.config.uncertainty.zone_margin_m
    # the third and the four after it: out of the margin, or along it
    assert [size_m > grown_m[2] + 0.9 * margin_m for size_m in grown_m[3:9]] == [
        False,
        False,
        False,
        False,
        True,
        True,
    ]
    assert grown_m[1] > grown_m[2] + 0.9 * margin_m
    analyzed_m = [float(item["global_position_m"]) for _, item in drive.calls("analyze")]
    assert max(analyzed_m) - min(analyzed_m) > 0.9 * margin_m


def test_where_only_one_path_is_known_no_more_than_three_sigmas_are_kept(make_drive):
    grown_m = []
    for mode in ("guarded", "avoid_koz"):
        drive = make_drive(waypoints=(Waypoint(15.0, 0.0, 1.0, mode),))
        drive.run()
        _, request = drive.calls("select")[3]
        grown_m.append(float(request["uncertainty"]["global_position_m"]))
    assert grown_m[1] - grown_m[0] == pytest.approx(drive.config.uncertainty.zone_margin_m)


def test_without_a_crawl_it_looks_before_it_moves(make_drive):
    drive = make_drive(crawl_length_m=0.0)
    assert drive.run().is_reached
    assert drive.world.images[0] == 0.0
    assert drive.timeline(Activity.DRIVING)[0][0] > 0.0


def test_a_violation_in_the_crawl_is_known_to_be_unguarded(make_drive):
    safety = SafetyWatch(lambda truth: "bump" if truth.x_m > 2.0 else None, lambda *_: False, str)
    assert "in mode unguarded said safe" in make_drive(safety=safety).run().fault_detail


def test_guarded_looks_again_at_terrain_that_was_not_seen(make_drive):
    drive = make_drive(waypoints=(Waypoint(15.0, 0.0, 1.0, "guarded"),))
    drive.planner.reject_reason = Reason.UNKNOWN
    drive.planner.arcs = [(1.0, 0.0), None, (1.0, 0.0)]
    assert drive.run().is_reached
    assert len(drive.world.looks) == 1


def test_a_rover_set_down_in_its_crawl_begins_the_go_to_again(make_drive):
    drive = make_drive()
    drive.executive.start(new_message(Kind.SET_KIOZ_IN))
    while drive.world.state.x_m < 2.5:
        drive.executive.advance()
    drive.planner.is_map_known = True
    drive.executive.place(5.0, 0.0, 0.0)
    assert drive.executive.finish().is_reached
    assert drive.events()[:5] == [
        HostEvr.GO_TO,
        HostEvr.CRAWL,
        HostEvr.PLACED,
        HostEvr.GO_TO,
        HostEvr.CRAWL_SKIPPED,
    ]
    # nothing of the crawl is left
    lengths_m = [float(request["arc"]["length_m"]) for _, request in drive.calls("evaluate")]
    assert 0.9 < max(lengths_m) <= 1.0
