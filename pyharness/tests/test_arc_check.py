# SPDX-License-Identifier: Apache-2.0
import math
import re

import numpy as np
import pytest

from pyharness.arc_check import check_on_drive, check_on_terrain, check_text
from pyharness.dp import Kind
from pyharness.dp_file import DpReader
from pyharness.errors import HarnessError, RerunError
from pyharness.messages import Arc
from pyharness.status import Mode
from sim.terrain import Terrain

AHEAD = Arc(3.0, 0.0)


def flat(**bumps_m):
    """Level ground of 40 m with a bump of a height at a distance north."""
    z = np.zeros((400, 400), dtype=np.float32)
    terrain = Terrain(z, 0.1, -19.95, -19.95)
    for height_m, north_m in bumps_m.values():
        near = np.abs(terrain.north_m - north_m) < 0.3
        z[np.ix_(near, np.abs(terrain.east_m) < 0.3)] = -height_m
    return Terrain(z, 0.1, -19.95, -19.95)


def test_level_ground_is_safe_with_the_margins_of_the_vehicle():
    check = check_on_terrain(flat(), AHEAD, (0.0, 0.0, 0.0))
    assert check.is_safe
    text = check_text(check)
    assert text.startswith("safe\narc of 3.00 m, +0.0 deg from north 0.00 m, east 0.00 m")
    # a bound: the belly is at 0.60 m
    assert re.search(r"clearance, m +0\.5[89]\d  0\.350   \+0\.2[34]\d", text)


def test_a_rock_higher_than_the_clearance_is_not_safe_and_says_where():
    check = check_on_terrain(flat(rock=(0.4, 4.0)), AHEAD, (0.0, 0.0, 0.0))
    assert not check.is_safe
    text = check_text(check)
    assert "CLEARANCE" in text
    # the front of the belly is 0.9 m ahead, the rock begins at 3.7 m
    assert 2.5 <= float(check.answer["failing_at"]) <= 3.0
    assert check_on_terrain(flat(rock=(0.4, 4.0)), Arc(2.0, 0.0), (0.0, 0.0, 0.0)).is_safe
    assert check_on_terrain(flat(rock=(0.4, 4.0)), AHEAD, (0.0, 5.0, 0.0)).is_safe


def test_a_turn_in_place_is_judged_by_its_angle():
    check = check_on_terrain(flat(), Arc(0.0, math.radians(90.0)), (0.0, 0.0, 0.0))
    assert check.is_safe
    assert "at, deg" in check_text(check)


def test_ground_outside_the_terrain_is_unknown():
    check = check_on_terrain(flat(), Arc(5.0, 0.0), (16.0, 0.0, 0.0))
    assert "UNKNOWN" in check_text(check)
    with pytest.raises(HarnessError, match="not on the terrain"):
        check_on_terrain(flat(), AHEAD, (30.0, 0.0, 0.0))


def test_a_recorded_evaluation_asked_again_gets_the_recorded_answer(quick_drive):
    with DpReader(quick_drive) as reader:
        decoded = [
            (item.kind, reader.schema.decode(item.kind, item.payload))
            for item in reader.records()
            if item.kind in (Kind.EVALUATE_ARC_IN, Kind.EVALUATE_ARC_OUT)
        ]
    requests = [item for kind, item in decoded if kind == Kind.EVALUATE_ARC_IN]
    answers = [item for kind, item in decoded if kind == Kind.EVALUATE_ARC_OUT]
    pairs = zip(requests, answers, strict=True)
    asked_alike = [pair for pair in pairs if pair[0]["mode"] == Mode.AVOID_ALL]
    assert len(asked_alike) > 4
    for request, answer in asked_alike[::4]:
        pose, arc = request["pose"], request["arc"]
        place = (float(pose["x_site_m"]), float(pose["y_site_m"]), float(pose["yaw_rad"]))
        asked = Arc(float(arc["length_m"]), float(arc["heading_change_rad"]))
        check = check_on_drive(quick_drive, asked, float(request["time_s"]), place)
        assert check.is_safe == bool(answer["is_safe"])
        assert int(check.answer["pose_count"]) == int(answer["pose_count"])
        if check.request["uncertainty"] == request["uncertainty"]:
            assert check.answer.tobytes() == answer.tobytes()


def test_without_a_pose_the_arc_begins_where_the_rover_believed_to_be(quick_drive):
    check = check_on_drive(quick_drive, AHEAD)
    assert float(check.request["pose"]["x_site_m"]) == pytest.approx(-1.5, abs=1.5)


def test_behind_the_rover_nothing_was_seen(quick_drive):
    check = check_on_drive(quick_drive, AHEAD, place=(-14.0, 0.0, math.pi))
    assert "UNKNOWN" in check_text(check)


def test_zones_of_the_drive_are_checked(tmp_path, record_quick_drive):
    zone = {"kind": "keep_out", "shape": "circle", "center_site_m": [2.0, 0.0], "radius_m": 1.0}
    record_quick_drive(tmp_path / "drive.dp", {"zones": [zone], "terrain": {"size_m": 40.0}})
    check = check_on_drive(tmp_path / "drive.dp", AHEAD)
    assert "KIOZ" in check_text(check)


def test_a_time_before_anything_was_seen_is_refused(quick_drive):
    with pytest.raises(RerunError, match="no terrain had been analyzed yet at 1 s"):
        check_on_drive(quick_drive, AHEAD, 1.0)
