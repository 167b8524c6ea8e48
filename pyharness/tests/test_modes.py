# SPDX-License-Identifier: Apache-2.0
"""The four Go To modes on one scene: rocks on the straight line, then a KOZ, all in a KIZ."""

import numpy as np
import pytest

from pyharness.examples import example
from pyharness.modes import MODES, drive_modes
from pyharness.scenario import load_scenario, make_terrain
from sim.vehicle import load_vehicle

HEAP_NORTH_M = (-4.5, -1.5)
ZONE_NORTH_M, ZONE_HALF_WIDTH_M = (5.0, 7.0), 3.5


@pytest.fixture(scope="module")
def drives(tmp_path_factory):
    """Summary and true track of every mode, and the picture."""
    folder = tmp_path_factory.mktemp("modes")
    scenario = load_scenario(example("four_modes"), {})
    summaries = {}
    picture = drive_modes(scenario, make_terrain(scenario), folder, False, summaries.__setitem__)
    tracks = {
        mode: np.genfromtxt(folder / mode / "truth.csv", delimiter=",", names=True)
        for mode, _, _ in MODES
    }
    return summaries, tracks, picture


def east_at(track, north_m):
    """Where a track crosses a parallel."""
    return float(np.interp(north_m, track["x_site_m"], track["y_site_m"]))


def test_unguarded_drives_over_the_rocks_and_refuses_at_the_zone(drives):
    summaries, tracks, _ = drives
    assert summaries["unguarded"]["outcome"] == "no_path"
    assert "kioz" in summaries["unguarded"]["fault_detail"]
    end_m = float(tracks["unguarded"]["x_site_m"][-1])
    assert HEAP_NORTH_M[1] < end_m < ZONE_NORTH_M[0]
    assert abs(east_at(tracks["unguarded"], -3.0)) < 0.5


def test_guarded_takes_the_same_path_and_refuses_at_the_rocks(drives):
    summaries, tracks, _ = drives
    assert summaries["guarded"]["outcome"] == "no_path"
    assert "clearance" in summaries["guarded"]["fault_detail"]
    guarded, unguarded = tracks["guarded"], tracks["unguarded"]
    assert float(guarded["x_site_m"][-1]) < HEAP_NORTH_M[0] - 1.0
    for north_m in np.linspace(-17.0, guarded["x_site_m"][-1] - 0.1, 20):
        assert east_at(guarded, north_m) == pytest.approx(east_at(unguarded, north_m), abs=0.02)


def test_avoid_koz_goes_over_the_rocks_and_round_the_zone(drives):
    summaries, tracks, _ = drives
    assert summaries["avoid_koz"]["outcome"] == "goal_reached"
    assert abs(east_at(tracks["avoid_koz"], -3.0)) < 1.0
    assert abs(east_at(tracks["avoid_koz"], 6.0)) > ZONE_HALF_WIDTH_M
    # over rocks that ACE refuses and the true rover survives
    vehicle = load_vehicle()
    least_m = vehicle.belly.height_m - vehicle.navlib_limits.clearance_margin_m
    assert (
        vehicle.fault_limits.clearance_min_m < summaries["avoid_koz"]["clearance_min_m"] < least_m
    )


def test_avoid_all_goes_round_both(drives):
    summaries, tracks, _ = drives
    assert summaries["avoid_all"]["outcome"] == "goal_reached"
    assert abs(east_at(tracks["avoid_all"], -3.0)) > 1.0
    assert abs(east_at(tracks["avoid_all"], 6.0)) > ZONE_HALF_WIDTH_M
    vehicle = load_vehicle()
    least_m = vehicle.belly.height_m - vehicle.navlib_limits.clearance_margin_m
    assert summaries["avoid_all"]["clearance_min_m"] > least_m


def test_the_four_tracks_are_drawn(drives):
    _, _, picture = drives
    assert picture.read_bytes().startswith(b"\x89PNG")
