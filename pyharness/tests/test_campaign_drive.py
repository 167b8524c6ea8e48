# SPDX-License-Identifier: Apache-2.0
import json

import pytest

from pyharness import margins
from pyharness.campaign_drive import run_campaign_drive
from pyharness.drive_folder import run_drive
from pyharness.scenario import load_scenario, make_terrain
from pyharness.tests.quick_drive import QUICK_DRIVE
from sim.errors import ConfigError

SHORT = {**QUICK_DRIVE, "executive.time_limit_s": 60.0}


def without_wall_time(summary):
    return summary | {"duration_wall_s": None}


def test_a_drive_of_a_campaign_is_that_of_enav_drive(tmp_path):
    scenario = load_scenario(None, SHORT)
    (tmp_path / "campaign").mkdir()
    run_campaign_drive(scenario, "all", tmp_path / "campaign")
    alone = run_drive(scenario, make_terrain(scenario), tmp_path / "alone")
    result = json.loads((tmp_path / "campaign/result.json").read_text())
    assert without_wall_time(result["summary"]) == without_wall_time(alone)
    kept = {path.name: path.read_bytes() for path in (tmp_path / "campaign/kept").iterdir()}
    left = {path.name: path.read_bytes() for path in (tmp_path / "alone").iterdir()}
    del kept["summary.json"], left["summary.json"]
    assert kept == left


def test_every_step_is_in_the_margins(tmp_path):
    run_campaign_drive(load_scenario(None, SHORT), "none", tmp_path)
    result = json.loads((tmp_path / "result.json").read_text())
    counted = margins.from_data(result["margins"])
    assert counted["tilt_rad"].total == 8 * result["summary"]["duration_sim_s"]
    assert counted["bogie_rad"].total == 2 * counted["tilt_rad"].total
    assert counted["clearance_m"].extreme == result["summary"]["clearance_min_m"]
    assert [path.name for path in tmp_path.iterdir()] == ["result.json"]


def test_a_start_off_the_terrain_is_refused(tmp_path):
    with pytest.raises(ConfigError, match="is not on the terrain"):
        run_campaign_drive(
            load_scenario(None, SHORT | {"start": [900.0, 0.0, 0.0]}), "none", tmp_path
        )
