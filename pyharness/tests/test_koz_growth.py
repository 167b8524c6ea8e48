# SPDX-License-Identifier: Apache-2.0
"""Zones grow by three sigmas of the position, and so the true rover stays out of them."""

import functools
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest

from pyharness.dp import Kind, native_schema
from pyharness.drive import drive
from pyharness.history import History
from pyharness.planners.enav import Enav
from pyharness.records import RecordStream
from pyharness.scenario import drive_info, load_scenario, make_terrain
from pyharness.status import Reason

# a goal behind a zone, on ground without hazards, with localisation far worse than a rover's
ZONE_NORTH_M, ZONE_HALF_LENGTH_M, ZONE_HALF_WIDTH_M = 4.0, 1.0, 3.0
SCENE = {
    "terrain": {"size_m": 40.0},
    "start": [-10.0, 0.0, 0.0],
    "goal": [12.0, 0.0],
    "mode": "avoid_koz",
    "camera": {"cloud_width_px": 40, "cloud_height_px": 30},
    "zones": [
        {
            "kind": "keep_out",
            "shape": "rectangle",
            "center_site_m": [ZONE_NORTH_M, 0.0],
            "length_m": 2 * ZONE_HALF_LENGTH_M,
            "width_m": 2 * ZONE_HALF_WIDTH_M,
        }
    ],
    "noise": {"vo_sigma_fraction": 0.05, "attitude_sigma_deg": 1.0, "vo_yaw_sigma_deg": 0.3},
}


@functools.cache
def terrain():
    return make_terrain(load_scenario(None, {"terrain": SCENE["terrain"]}))


def run(seed, **overrides):
    scenario = load_scenario(None, {**SCENE, "seed": seed, **overrides})
    history = History(native_schema(), drive_info(scenario))
    analyses = []

    def take(record):
        history.take(record)
        if record.kind == Kind.ANALYZE_TERRAIN_OUT:
            analyses.append(native_schema().decode(record.kind, record.payload))

    drive(scenario, terrain(), Enav, RecordStream([take]))
    return history, analyses


def least_distance_m(history):
    """Least distance of the true track from the zone; 0 inside."""
    pose = history.truth["pose"]
    north_m = np.abs(pose["x_site_m"] - ZONE_NORTH_M) - ZONE_HALF_LENGTH_M
    east_m = np.abs(pose["y_site_m"]) - ZONE_HALF_WIDTH_M
    return float(np.hypot(np.maximum(north_m, 0.0), np.maximum(east_m, 0.0)).min())


def stays_out(seed):
    history, _ = run(seed)
    return history.outcome.outcome, least_distance_m(history)


def test_the_uncertainty_grows_along_the_drive_and_the_refused_band_with_it():
    history, analyses = run(0, **{"executive.uncertainty.zone_margin_m": 0.0})
    grown_m = np.array(
        [float(request["uncertainty"]["global_position_m"]) for request, _ in history.selections]
    )
    assert np.all(np.diff(grown_m[:-1]) > -0.05)
    assert grown_m[-1] > 2.5 * grown_m[0]
    band = np.array([int(item["infinite"][Reason.KIOZ]) for item in analyses])
    assert band[-1] > 1.3 * band[len(band) // 4] > 0
    assert least_distance_m(history) > 0.3


def test_without_growth_the_same_errors_lead_into_the_zone():
    nothing = {"global_sigmas": 0.0, "zone_margin_m": 0.0}
    history, _ = run(
        0, **{f"executive.uncertainty.{name}": value for name, value in nothing.items()}
    )
    assert history.outcome.outcome == "kioz_violation"


@pytest.mark.parametrize("seed", [1, 2])
def test_the_true_rover_stays_out_of_the_zone(seed):
    outcome, distance_m = stays_out(seed)
    assert outcome == "goal_reached"
    assert distance_m > 0.0


@pytest.mark.verify
@pytest.mark.timeout(1800)
def test_the_true_rover_stays_out_of_the_zone_over_100_seeds():
    with ProcessPoolExecutor(2) as pool:
        results = list(pool.map(stays_out, range(100)))
    distances_m = np.array([distance_m for _, distance_m in results])
    assert not [item for item in results if item[0] == "kioz_violation"]
    assert distances_m.min() > 0.0
    # most arrive: the zones are kept, the drives are not given up
    assert sum(outcome == "goal_reached" for outcome, _ in results) >= 95
