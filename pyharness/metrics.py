# SPDX-License-Identifier: Apache-2.0
"""Numbers of a drive, from its records alone: summary, planning cycles, truth, events."""

import csv
import io
import json
import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from pyharness.called_safe import called_safe
from pyharness.dp import Message
from pyharness.evr import evr_line
from pyharness.history import History
from pyharness.status import Reason, Status

OVERTHINK_EVALUATIONS = 275
"""A planning cycle with more ACE evaluations than this makes a flight rover wait."""

REASONS = [reason for reason in Reason if reason.name != "NONE"]


# ------------------------------------------------------------------ summary


def summarize(history: History) -> dict[str, Any]:
    """Return the summary of a drive; what cannot be known (no step was driven) is None."""
    truth = history.truth
    driven_m = float(truth["distance_driven_m"][-1]) if len(truth) else 0.0
    straight_m = straight_distance_m(history)
    duration_s = float(truth["time_s"][-1]) if len(truth) else 0.0
    evaluations = np.array([int(answer["ace_evaluations"]) for _, answer in history.selections])
    bogie = np.maximum(np.abs(truth["bogie_left_rad"]), np.abs(truth["bogie_right_rad"]))
    safe = called_safe(history)
    return {
        "outcome": history.outcome.outcome,
        "fault_detail": history.outcome.fault_detail,
        "planner": history.info.planner,
        "mode": history.info.waypoints[-1].mode,
        "seed": history.info.seed,
        "distance_driven_m": driven_m,
        "distance_straight_m": straight_m,
        "path_inefficiency": driven_m / straight_m - 1.0 if straight_m > 0.0 else None,
        "duration_sim_s": duration_s,
        "drive_rate_m_per_h": 3600.0 * driven_m / duration_s if duration_s > 0.0 else None,
        "planning_cycles": len(evaluations),
        "ace_evaluations_mean": float(evaluations.mean()) if len(evaluations) else None,
        "ace_evaluations_max": int(evaluations.max()) if len(evaluations) else None,
        "overthink_rate": (
            float(np.mean(evaluations > OVERTHINK_EVALUATIONS)) if len(evaluations) else None
        ),
        "clearance_min_m": _extreme(-truth["clearance_m"], sign=-1.0),
        "tilt_max_rad": _extreme(truth["tilt_rad"]),
        "rocker_max_rad": _extreme(np.abs(truth["rocker_rad"])),
        "bogie_max_rad": _extreme(bogie),
        "wheel_drop_max_m": _extreme(truth["wheel_drop_m"]),
        "slip_max": _extreme(truth["slip"]),
        "localization_error_final_m": _localization_error_m(history, truth),
        "distance_called_safe_m": safe.distance_m,
        "distance_leaving_m": safe.distance_leaving_m,
        "violations_called_safe": safe.violations,
        "violations_leaving": safe.violations_leaving,
        "rejections": rejection_counts(history),
    }


def straight_distance_m(history: History) -> float:
    """Return the length of the straight legs from the start through all waypoints."""
    info = history.info
    places = [(info.start_north_m, info.start_east_m)]
    places += [(waypoint.north_m, waypoint.east_m) for waypoint in info.waypoints]
    return math.fsum(math.dist(start, end) for start, end in pairwise(places))


def rejection_counts(history: History) -> dict[str, int]:
    """Return how many candidate paths were rejected, by reason, over all planning cycles."""
    answers = [answer["rejections"] for _, answer in history.selections]
    return {
        reason.name.lower(): sum(_count(counts, reason) for counts in answers) for reason in REASONS
    }


def _count(counts: npt.NDArray[Any], reason: Any) -> int:
    """Return how often a reason occurred; a file may be older than the reason."""
    return int(counts[reason.value]) if reason.value < len(counts) else 0


def write(history: History, summary: dict[str, Any], folder: Path, has_truth: bool = True) -> None:
    """Write the tables of a drive, and its summary last."""
    (folder / "metrics.csv").write_text(cycles_csv(history), "utf-8")
    if has_truth:
        (folder / "truth.csv").write_text(truth_csv(history), "utf-8")
    (folder / "evr.log").write_text(evr_log(history), "utf-8")
    (folder / "summary.json").write_text(summary_text(summary), "utf-8")


def summary_text(summary: dict[str, Any]) -> str:
    """Return the summary as JSON text."""
    return json.dumps(summary, indent=2, allow_nan=False, ensure_ascii=False) + "\n"


def _extreme(values: npt.NDArray[np.float64], sign: float = 1.0) -> float | None:
    """Return the largest finite value, with the sign given back to it."""
    finite = values[np.isfinite(values)]
    return sign * float(finite.max()) if len(finite) else None


def _localization_error_m(history: History, truth: npt.NDArray[Any]) -> float | None:
    if not len(truth) or not history.estimates:
        return None
    believed, true = history.estimates[-1]["pose"], truth["pose"][-1]
    return math.hypot(
        float(believed["x_site_m"] - true["x_site_m"]),
        float(believed["y_site_m"] - true["y_site_m"]),
    )


# ------------------------------------------------------------------ tables


def cycles_csv(history: History) -> str:
    """Return one row per planning cycle."""
    rows = [
        {"cycle": index, "distance_driven_m": distance_m, **_cycle_row(request, answer)}
        for index, ((request, answer), distance_m) in enumerate(
            zip(history.selections, history.distances_m, strict=True), start=1
        )
    ]
    header = ["cycle", "distance_driven_m", *CYCLE_COLUMNS]
    return csv_text(header, ([row[name] for name in header] for row in rows))


CYCLE_COLUMNS = [
    "time_s",
    "x_site_m",
    "y_site_m",
    "yaw_rad",
    "goal_distance_m",
    "uncertainty_position_m",
    "uncertainty_yaw_rad",
    "status",
    "arc_length_m",
    "arc_heading_change_rad",
    "path_index",
    "path_cost_s",
    "cost_to_go_s",
    "ace_evaluations",
    "paths_tested",
    *(f"rejected_{reason.name.lower()}" for reason in REASONS),
    "bound_clearance_min_m",
    "bound_tilt_max_rad",
    "bound_wheel_drop_max_m",
]


def _cycle_row(request: Message, answer: Message) -> dict[str, Any]:
    pose, goal, bounds = request["pose"], request["goal"], answer["bounds"]
    is_found = int(answer["status"]) == Status.OK
    row: dict[str, Any] = {
        "time_s": float(request["time_s"]),
        "x_site_m": float(pose["x_site_m"]),
        "y_site_m": float(pose["y_site_m"]),
        "yaw_rad": float(pose["yaw_rad"]),
        "goal_distance_m": math.hypot(
            float(goal["x_site_m"] - pose["x_site_m"]), float(goal["y_site_m"] - pose["y_site_m"])
        ),
        "uncertainty_position_m": float(request["uncertainty"]["position_m"]),
        "uncertainty_yaw_rad": float(request["uncertainty"]["yaw_rad"]),
        "status": Status(int(answer["status"])).name.lower(),
        "ace_evaluations": int(answer["ace_evaluations"]),
        "paths_tested": int(answer["paths_tested"]),
    }
    for reason in REASONS:
        row[f"rejected_{reason.name.lower()}"] = _count(answer["rejections"], reason)
    found = {
        "arc_length_m": float(answer["arc"]["length_m"]),
        "arc_heading_change_rad": float(answer["arc"]["heading_change_rad"]),
        "path_index": int(answer["path_index"]),
        "path_cost_s": float(answer["path_cost_s"]),
        "cost_to_go_s": float(answer["cost_to_go_s"]),
        "bound_clearance_min_m": float(bounds["clearance_min_m"]),
        "bound_tilt_max_rad": float(bounds["tilt_max_rad"]),
        "bound_wheel_drop_max_m": float(bounds["wheel_drop_max_m"]),
    }
    return row | (found if is_found else dict.fromkeys(found, ""))


TRUTH_COLUMNS = {
    "time_s": ("time_s",),
    "x_site_m": ("pose", "x_site_m"),
    "y_site_m": ("pose", "y_site_m"),
    "z_site_m": ("pose", "z_site_m"),
    "roll_rad": ("pose", "roll_rad"),
    "pitch_rad": ("pose", "pitch_rad"),
    "yaw_rad": ("pose", "yaw_rad"),
    "rocker_rad": ("rocker_rad",),
    "bogie_left_rad": ("bogie_left_rad",),
    "bogie_right_rad": ("bogie_right_rad",),
    "tilt_rad": ("tilt_rad",),
    "clearance_m": ("clearance_m",),
    "wheel_drop_m": ("wheel_drop_m",),
    "slip": ("slip",),
    "distance_driven_m": ("distance_driven_m",),
    "residual_m": ("residual_m",),
    "is_converged": ("is_converged",),
}


def truth_csv(history: History) -> str:
    """Return one row per tick of ground truth."""
    truth = history.truth
    columns = []
    for path in TRUTH_COLUMNS.values():
        values: Any = truth
        for name in path:
            values = values[name]
        columns.append(values.tolist())
    return csv_text(TRUTH_COLUMNS, zip(*columns, strict=True))


def evr_log(history: History) -> str:
    """Return one line per event report."""
    return "".join(f"{evr_line(evr)}\n" for evr in history.evrs)


def csv_text(header: Iterable[str], rows: Iterable[Sequence[Any]]) -> str:
    """Return CSV text; numbers with nine significant digits, as far as any of them means."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    for row in rows:
        writer.writerow([f"{item:.9g}" if isinstance(item, float) else item for item in row])
    return text.getvalue()
