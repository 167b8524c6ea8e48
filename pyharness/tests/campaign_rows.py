# SPDX-License-Identifier: Apache-2.0
"""Made-up results of campaigns: rows of drives, and the folder of a campaign."""

import json
import random

import numpy as np

from pyharness import margins
from pyharness.campaign import Campaign, drives_of
from pyharness.child_drives import DriveResult
from pyharness.drive_table import (
    CAMPAIGN_FILE,
    DRIVES_FOLDER,
    RESULTS_FOLDER,
    RUN_FILE,
    result_path,
    result_text,
)
from sim.config import dump_model, parse_model

LAST_REFUSAL = "4 times in a row in mode avoid_all; paths rejected: wheel_drop 900, clearance 500"
VIOLATION = "tilt 35.2 deg over tilt_max_deg 35; true position north 3.00 m, east 2.00 m; safe"
GRID = {"terrain.slope_deg": [0, 10], "terrain.cfa": [0.07, 0.1]}


def row(outcome="goal_reached", **changes):
    """A drive that reached its goal, but for what is changed."""
    details = {"no_path": LAST_REFUSAL, "limit_violation": VIOLATION}
    return {
        "name": "drive-seed0000",
        "planner": "enav",
        "parameter_set": "default",
        "seed": 0,
        **summary(outcome, details.get(outcome, "")),
        **changes,
    }


def summary(outcome, detail, worse=1.0, rng=None):
    """Columns of a summary."""
    noise = 1.0 if rng is None else rng.uniform(0.95, 1.05)
    return {
        "outcome": outcome,
        "fault_detail": detail,
        "mode": "avoid_all",
        "distance_driven_m": 88.0 * noise,
        "distance_straight_m": 80.0,
        "path_inefficiency": 0.1 * noise * worse,
        "duration_sim_s": 3600.0,
        "drive_rate_m_per_h": 88.0 * noise / worse,
        "duration_wall_s": 4.0,
        "planning_cycles": 90,
        "ace_evaluations_mean": 120.0 * noise,
        "ace_evaluations_max": 900,
        "overthink_rate": 0.05 * noise,
        "clearance_min_m": 0.4 * noise,
        "tilt_max_rad": 0.2 * noise,
        "rocker_max_rad": 0.1 * noise,
        "bogie_max_rad": 0.3 * noise,
        "wheel_drop_max_m": 0.3 * noise,
        "slip_max": 0.2,
        "localization_error_final_m": 0.5,
        "distance_called_safe_m": 80.0,
        "distance_leaving_m": 1.0,
        "violations_called_safe": int(outcome == "limit_violation"),
        "violations_leaving": 0,
        "rejections": {"clearance": 700, "wheel_drop": 40, "cost": 5000},
    }


def flat_row(outcome="goal_reached", **changes):
    """A row as it stands in a table of drives."""
    flat = row(outcome, **changes)
    rejections = flat.pop("rejections")
    return flat | {f"rejections_{name}": count for name, count in rejections.items()}


def rows_of(outcome_of, seeds=3, **changes):
    """Drives in the four cells of a grid."""
    return [
        flat_row(
            outcome_of(slope, cfa, seed),
            name=f"slope{slope}-cfa{cfa}-seed{seed:04d}",
            seed=seed,
            **{"terrain.slope_deg": slope, "terrain.cfa": cfa},
            **changes,
        )
        for seed in range(seeds)
        for slope in GRID["terrain.slope_deg"]
        for cfa in GRID["terrain.cfa"]
    ]


def counted_margins():
    """Histograms of a drive of 100 steps."""
    fields = ["clearance_m", "wheel_drop_m", "tilt_rad", "rocker_rad"]
    fields += ["bogie_left_rad", "bogie_right_rad"]
    truth = np.zeros(100, [(name, float) for name in fields])
    truth["clearance_m"] = np.linspace(0.4, 0.6, 100)
    truth["wheel_drop_m"] = np.linspace(0.0, 0.3, 100)
    for name in fields[2:]:
        truth[name] = np.linspace(0.0, 0.13, 100)
    return margins.margins_of(truth)


def made_campaign(**changes):
    """A campaign of 2 x 2 cells with 3 seeds."""
    return parse_model(
        "", "campaign", Campaign, {"name": "made", "axes": GRID, "seeds": 3, **changes}
    )


def write_campaign(folder, campaign, outcome_of, worse=1.0, skip=()):
    """Write the folder of a campaign whose drives end as `outcome_of(drive, rng)` says."""
    (folder / RESULTS_FOLDER).mkdir(parents=True)
    (folder / CAMPAIGN_FILE).write_text(dump_model(campaign), "utf-8")
    run = {"enav_sim": "0.1.0", "revision": "abc", "started": "2026-01-02T03:04:05+00:00"}
    (folder / RUN_FILE).write_text(json.dumps(run), "utf-8")
    for drive in drives_of(campaign):
        if drive.name in skip:
            continue
        rng = random.Random(f"{drive.axis_values} {drive.seed}")
        outcome, detail = outcome_of(drive, rng)
        if outcome in ("crashed", "timed_out"):
            result = DriveResult(outcome=outcome, detail=detail)
        else:
            result = DriveResult(
                summary=summary(outcome, detail, worse, rng),
                margins=margins.to_data(counted_margins()),
            )
        text = result_text(drive.place(campaign), "avoid_all", result)
        result_path(folder, drive).write_text(text, "utf-8")
    return folder


def add_picture(folder, name):
    """Keep a picture of a drive."""
    from PIL import Image

    place = folder / DRIVES_FOLDER / name
    place.mkdir(parents=True)
    Image.new("RGB", (1600, 1000), (200, 120, 80)).save(place / "overhead.png")
