# SPDX-License-Identifier: Apache-2.0
"""Every fault, made to happen in the real world: the rover stops, the records are complete."""

import json
from dataclasses import replace

import pytest

from pyharness.dp import Kind
from pyharness.dp_file import DpReader
from pyharness.drive_folder import run_drive
from pyharness.evr import evr_table
from pyharness.faults import FAULTS, FaultError, SafetyWatch
from pyharness.records import KIND_END
from pyharness.scenario import load_scenario, make_terrain

BASE = {
    "terrain": {"size_m": 40.0},
    "start": [-10.0, 0.0, 0.0],
    "goal": [10.0, 0.0],
    "camera": {"cloud_width_px": 160, "cloud_height_px": 120},
}
RAISES = """
from pyharness.planners.enav import Enav

class Raises(Enav):
    def _select_arc(self, request):
        raise ZeroDivisionError("no reason")
"""


def zone(north_m, radius_m=1.5):
    center = [north_m, 0.0]
    return {"kind": "keep_out", "shape": "circle", "center_site_m": center, "radius_m": radius_m}


STRAIGHT = {"goal": None, "slip.enabled": False, "noise.enabled": False}
CAUSES = {
    "no_path": ({"mode": "unguarded", "zones": [zone(3.0)]}, "kioz"),
    "unsafe_arc": (
        {**STRAIGHT, "zones": [zone(-5.0)], "arcs": [{"length_m": 8.0, "mode": "unguarded"}]},
        "kioz",
    ),
    "limit_violation": (
        {"terrain": {"size_m": 40.0, "slope_deg": 36.0, "slope_azimuth_deg": 90.0}},
        "tilt",
    ),
    "kioz_violation": ({"zones": [zone(-10.0)]}, "true position"),
    "stuck": (
        {
            "terrain": {"size_m": 40.0, "slope_deg": 25.0, "slope_azimuth_deg": 0.0},
            "slip.terrain_class": "sand",
        },
        "of commanded path",
    ),
    "time_limit": ({"executive.time_limit_s": 60.0}, "60 s"),
    "left_map": (
        {
            **STRAIGHT,
            "start": [17.5, 0.0, 0.0],
            "arcs": [{"length_m": 6.0, "mode": "unguarded"}],
        },
        "true position north",
    ),
    "planner_error": ({"planner": "raises.py:Raises"}, "ZeroDivisionError"),
}


def test_there_is_a_cause_for_every_fault():
    assert set(CAUSES) == set(FAULTS)


@pytest.mark.parametrize("name", FAULTS)
def test_on_a_fault_the_rover_stops_and_the_records_are_complete(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "raises.py").write_text(RAISES)
    settings, reason = CAUSES[name]
    scenario = load_scenario(None, {**BASE, **settings})
    summary = run_drive(scenario, make_terrain(scenario), tmp_path / name)
    assert (summary["outcome"], reason in summary["fault_detail"]) == (name, True), summary
    written = json.loads((tmp_path / name / "summary.json").read_text())
    assert written["outcome"] == name

    with DpReader(tmp_path / name / "drive.dp") as reader:
        records = list(reader.records())
        last_event = [
            reader.schema.decode(item.kind, item.payload)
            for item in records
            if item.kind == Kind.HOST_EVR
        ][-1]
        lanes = [
            reader.schema.decode(item.kind, item.payload)
            for item in records
            if item.kind == Kind.TIMELINE
        ]
        assert reader.damage is None
    assert records[-1].kind == KIND_END
    event = evr_table()[int(last_event["id"])].name
    assert event == f"FAULT_{name.upper()}"
    assert event in (tmp_path / name / "evr.log").read_text().splitlines()[-1]
    # the bar of the last motion ends with the drive
    assert max(float(item["end_s"]) for item in lanes) >= records[-1].time_s


def test_the_watch_names_where_and_what_the_planner_thought(fake_world):
    truth = replace(fake_world().state, x_m=3.0)
    SafetyWatch(lambda _: None, lambda *_: False, str).check(truth, "said safe")
    with pytest.raises(FaultError) as caught:
        SafetyWatch(lambda _: "tilt", lambda *_: True, str).check(truth, "said safe")
    assert caught.value.detail == "tilt; true position north 3.00 m, east 0.00 m; said safe"
    assert caught.value.values == (3.0, 0.0)
