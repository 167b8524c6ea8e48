# SPDX-License-Identifier: Apache-2.0
import json

import numpy as np
import pytest

from pyharness import metrics
from pyharness.dp import Kind
from pyharness.dp_file import DpReader
from pyharness.drive_folder import check_folder, run_drive
from pyharness.errors import OutputError
from pyharness.history import History
from pyharness.scenario import load_scenario, make_terrain

SHORT = {
    "terrain": {"size_m": 40.0, "cfa": 0.03},
    "start": [-10.0, 0.0, 0.0],
    "goal": [5.0, 0.0],
    "camera": {"cloud_width_px": 160, "cloud_height_px": 120},
}
FILES = {
    "drive.dp",
    "evr.log",
    "metrics.csv",
    "overhead.png",
    "scenario.yaml",
    "summary.json",
    "truth.csv",
}


def run(folder, overrides=None, path=None, **options):
    scenario = load_scenario(path, {**(SHORT if path is None else {}), **(overrides or {})})
    return run_drive(scenario, make_terrain(scenario), folder, **options)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    folder = tmp_path_factory.mktemp("drives") / "short"
    run(folder)
    return folder


def test_a_drive_leaves_its_folder_and_nothing_else(finished):
    assert {path.name for path in finished.iterdir()} == FILES
    assert [path.name for path in finished.parent.iterdir()] == ["short"]


def test_the_rover_arrives(finished):
    summary = json.loads((finished / "summary.json").read_text())
    assert summary["outcome"] == "goal_reached"
    assert 12.0 < summary["distance_driven_m"] < 20.0
    assert summary["duration_wall_s"] > 0.0


def test_the_records_are_complete_and_give_the_same_numbers(finished):
    with DpReader(finished / "drive.dp") as reader:
        history = History(reader.schema, reader.info)
        kinds = set()
        for record in reader.records():
            history.take(record)
            kinds.add(record.kind)
        assert reader.damage is None
    assert kinds >= {
        Kind.INIT_IN,
        Kind.SET_KIOZ_IN,
        Kind.PROCESS_DISPARITY_IN,
        Kind.ANALYZE_TERRAIN_IN,
        Kind.SELECT_ARC_OUT,
        Kind.EVALUATE_ARC_OUT,
        Kind.EVR,
        Kind.TRUTH,
        Kind.ESTIMATE,
        Kind.TIMELINE,
    }
    summary = json.loads((finished / "summary.json").read_text())
    del summary["duration_wall_s"]
    assert summary == metrics.summarize(history)
    assert (finished / "metrics.csv").read_text() == metrics.cycles_csv(history)


def test_the_same_scenario_gives_the_same_bytes(finished, tmp_path):
    run(tmp_path / "again")
    run(tmp_path / "from_file", path=finished / "scenario.yaml")
    for name in FILES - {"summary.json"}:
        expected = (finished / name).read_bytes()
        assert (tmp_path / "again" / name).read_bytes() == expected, name
        assert (tmp_path / "from_file" / name).read_bytes() == expected, name


def test_another_seed_gives_another_drive(finished, tmp_path):
    run(tmp_path / "other", {"seed": 1})
    other = (tmp_path / "other/drive.dp").read_bytes()
    assert other != (finished / "drive.dp").read_bytes()


@pytest.mark.parametrize("mode", ["unguarded", "guarded", "avoid_koz"])
def test_every_mode_drives_on_easy_ground(tmp_path, mode):
    easy = {"mode": mode, "terrain": {"size_m": 40.0}, "slip.enabled": False}
    assert run(tmp_path / mode, easy)["outcome"] == "goal_reached"


def test_a_keep_out_zone_is_driven_round(tmp_path):
    zone = {"kind": "keep_out", "shape": "circle", "center_site_m": [-1.0, 0.0], "radius_m": 1.5}
    summary = run(tmp_path / "zone", {"zones": [zone], "terrain": {"size_m": 40.0}})
    assert summary["outcome"] == "goal_reached"
    track = np.genfromtxt(tmp_path / "zone/truth.csv", delimiter=",", names=True)
    assert np.hypot(track["x_site_m"] + 1.0, track["y_site_m"]).min() > 1.5


def test_a_goal_behind_a_zone_is_refused_when_zones_are_not_driven_round(tmp_path):
    zone = {"kind": "keep_out", "shape": "circle", "center_site_m": [1.0, 0.0], "radius_m": 1.5}
    summary = run(tmp_path / "zone", {"zones": [zone], "mode": "unguarded"})
    assert summary["outcome"] == "no_path"
    assert "kioz" in summary["fault_detail"]


def test_a_start_in_a_zone_is_a_fault_with_complete_records(tmp_path):
    zone = {"kind": "keep_out", "shape": "circle", "center_site_m": [-10.0, 0.0], "radius_m": 1.0}
    assert run(tmp_path / "zone", {"zones": [zone]})["outcome"] == "kioz_violation"
    with DpReader(tmp_path / "zone/drive.dp") as reader:
        assert list(reader.records())
        assert reader.damage is None


def test_a_finished_drive_is_replaced_only_by_force(finished, tmp_path):
    folder = tmp_path / "kept"
    run(folder, {"executive.time_limit_s": 10.0})
    with pytest.raises(OutputError, match="--force"):
        run(folder)
    run(folder, {"executive.time_limit_s": 20.0}, force=True)
    assert json.loads((folder / "summary.json").read_text())["duration_sim_s"] == 20.0
    assert {path.name for path in folder.parent.iterdir()} == {"kept"}
    assert finished.exists()


@pytest.mark.parametrize("force", [False, True])
def test_a_folder_that_is_no_drive_is_never_replaced(tmp_path, force):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine/thesis.txt").touch()
    with pytest.raises(OutputError, match="not the folder of a drive"):
        check_folder(tmp_path / "mine", force)


@pytest.mark.faults
def test_an_interrupted_drive_does_not_look_finished(tmp_path):
    def interrupt(progress):
        if progress.planning_cycles > 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(tmp_path / "cut", progress=interrupt)
    assert not (tmp_path / "cut").exists()
    with DpReader(tmp_path / "cut.partial/drive.dp") as reader:
        assert len(list(reader.records())) > 10
        assert reader.damage is not None
    run(tmp_path / "cut", {"executive.time_limit_s": 10.0})
    assert {path.name for path in tmp_path.iterdir()} == {"cut"}


@pytest.mark.faults
def test_an_unwritable_place_is_one_clear_error(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(OutputError, match="file"):
        run(tmp_path / "file/inside")


def test_a_planner_from_a_file_drives(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text("from pyharness.planners.enav import Enav\nclass Mine(Enav): pass\n")
    limit = {"planner": f"{path}:Mine", "executive.time_limit_s": 200.0}
    assert run(tmp_path / "mine", limit)["planner"] == "mine.py:Mine"


@pytest.mark.parametrize("planner", ["gestalt", "rrtsharp"])
def test_drives_of_the_other_planners_leave_the_same_folder_and_can_be_repeated(tmp_path, planner):
    summary = run(tmp_path / "first", {"planner": planner})
    assert summary["outcome"] == "goal_reached"
    assert summary["planner"] == planner
    assert {path.name for path in (tmp_path / "first").iterdir()} == FILES
    run(tmp_path / "second", path=tmp_path / "first/scenario.yaml")
    for name in FILES - {"summary.json"}:
        first, second = (tmp_path / folder / name for folder in ("first", "second"))
        assert first.read_bytes() == second.read_bytes(), name
