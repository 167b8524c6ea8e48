# SPDX-License-Identifier: Apache-2.0
from pyharness.drive import drive
from pyharness.planners.enav import Enav
from pyharness.records import KIND_END, RecordStream, read_end
from pyharness.scenario import load_scenario, make_terrain

QUICK = {
    "terrain": {"size_m": 30.0},
    "start": [-8.0, 0.0, 0.0],
    "goal": [8.0, 0.0],
    "camera": {"cloud_width_px": 40, "cloud_height_px": 30},
    "executive.time_limit_s": 150.0,
}


def run(planner_class=Enav, **overrides):
    records = []
    scenario = load_scenario(None, {**QUICK, **overrides})
    outcome = drive(scenario, make_terrain(scenario), planner_class, RecordStream([records.append]))
    return outcome, records


def test_the_last_record_tells_the_outcome():
    outcome, records = run()
    assert outcome.outcome == "time_limit"
    assert records[-1].kind == KIND_END
    assert read_end(records[-1].payload) == outcome


def test_two_drives_in_one_process_give_the_same_records():
    assert run() == run()


def test_a_planner_that_refuses_the_zones_ends_the_drive(monkeypatch):
    def refuse(self, request):
        raise NotImplementedError("knows no zones")

    monkeypatch.setattr(Enav, "_set_kioz", refuse)
    outcome, _ = run()
    assert outcome.outcome == "planner_error"
    assert "knows no zones" in outcome.fault_detail
