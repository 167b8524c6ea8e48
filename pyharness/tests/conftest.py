# SPDX-License-Identifier: Apache-2.0
"""A world and a planner that do as they are told."""

import math
from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from pyharness.dp import Kind, native_schema, new_message
from pyharness.params import param_values
from pyharness.planner import Planner
from pyharness.records import DriveInfo, Outcome, RecordStream, Waypoint, end_payload
from pyharness.status import Mode, Reason, Status
from pyharness.tests.executive_drive import Drive
from pyharness.tests.quick_drive import record_drive

TICK_S = 0.125
SPEED_M_S = 0.05


@dataclass(frozen=True)
class ExpectedSlip:
    north_m: float = 0.0
    east_m: float = 0.0
    sigma_m: float = 0.0
    yaw_sigma_rad: float = 0.0


@dataclass(frozen=True)
class State:
    """Truth and estimate in one: the fake world has no noise."""

    x_m: float = 0.0
    y_m: float = 0.0
    z_m: float = 0.0
    roll_rad: float = 0.0
    pitch_rad: float = 0.0
    yaw_rad: float = 0.0
    rocker_rad: float = 0.0
    bogie_left_rad: float = 0.0
    bogie_right_rad: float = 0.0
    tilt_rad: float = 0.0
    clearance_m: float = 0.6
    wheel_drop_m: float = 0.0
    slip: float = 0.0
    distance_driven_m: float = 0.0
    residual_m: float = 0.0
    converged: bool = True
    on_map: bool = True
    sigma_position_m: float = 0.1
    sigma_local_m: float = 0.0
    contact_site_m: np.ndarray = field(default_factory=lambda: np.zeros((6, 3)))


class FakeWorld:
    """Flat ground, exact motion at 5 cm/s, 10 s to steer."""

    def __init__(self, motion_share=1.0):
        self.ticks = 0
        self.state = State()
        self.motion_share = motion_share
        self.arc = None
        self.start = self.state
        self.arc_ticks = 0
        self.fixes = []
        self.images = []
        self.looks = []
        self.slip = ExpectedSlip()

    @property
    def time_s(self):
        return self.ticks * TICK_S

    @property
    def estimate(self):
        return self.state

    @property
    def arc_fraction(self):
        if self.arc is None:
            return 1.0
        length_m, heading_rad = self.arc
        duration_s = max(abs(length_m), abs(heading_rad)) / SPEED_M_S
        return min(1.0, self.arc_ticks * TICK_S / duration_s)

    @property
    def arc_done(self):
        return self.arc_fraction >= 1.0

    def start_arc(self, length_m, heading_change_rad):
        self.arc, self.start, self.arc_ticks = (length_m, heading_change_rad), self.state, 0

    def step(self):
        self.ticks += 1
        if self.arc is not None and not self.arc_done:
            self.arc_ticks += 1
            moved_m = self.arc[0] * self.arc_fraction * self.motion_share
            yaw_rad = self.start.yaw_rad + self.arc[1] * self.arc_fraction
            self.state = replace(
                self.state,
                x_m=self.start.x_m + moved_m * math.cos(self.start.yaw_rad),
                y_m=self.start.y_m + moved_m * math.sin(self.start.yaw_rad),
                yaw_rad=yaw_rad,
                distance_driven_m=self.start.distance_driven_m + abs(moved_m),
            )
        return self.state

    def stop(self):
        self.arc = None

    def visual_odometry(self):
        self.fixes.append(self.time_s)
        return True

    def image(self, azimuths_deg=None):
        (self.images if azimuths_deg is None else self.looks).append(self.time_s)
        return np.full((10, 3), len(self.images), dtype=np.float32)

    def ground_around(self, radius_m):
        return np.full((20, 3), radius_m, dtype=np.float32)

    def place(self, north_m, east_m, yaw_rad):
        self.arc = None
        self.state = replace(self.state, x_m=north_m, y_m=east_m, yaw_rad=yaw_rad)
        return self.state

    def slip_ahead(self, length_m, heading_change_rad):  # noqa: ARG002
        return self.slip

    def sigma_position_after_m(self, distance_m):
        return self.state.sigma_position_m + 0.1 * distance_m

    def steering_duration_s(self, curvature_from, curvature_to):
        return 0.0 if curvature_from == curvature_to else 10.0


class FakePlanner(Planner):
    """Answers from lists; when one is used up its last answer stays."""

    def __init__(self, params, sink, own_params=None, rng=None, time_s=0.0):
        super().__init__(params, sink, own_params, rng, time_s)
        self.calls = []
        self.arcs = [(1.0, 0.0)]  # None: no path
        self.is_safe = [True]
        self.is_map_known = False
        self.zone_north_m = math.inf  # Unguarded arcs that end beyond it are refused
        self.ace_evaluations = 10
        self.refuses = None
        self.reject_reason = Reason.TILT

    def _answer(self, name, kind, request):
        self.calls.append((name, float(request["time_s"]), request))
        answer = new_message(kind)
        if self.refuses == name:
            answer["status"] = Status.INTERNAL
        return answer

    def _process_disparity(self, request):
        return self._answer("process", Kind.PROCESS_DISPARITY_OUT, request)

    def _analyze_terrain(self, request):
        return self._answer("analyze", Kind.ANALYZE_TERRAIN_OUT, request)

    def _select_arc(self, request):
        answer = self._answer("select", Kind.SELECT_ARC_OUT, request)
        arc = self.arcs.pop(0) if len(self.arcs) > 1 else self.arcs[0]
        answer["ace_evaluations"] = self.ace_evaluations
        if arc is None:
            answer["status"] = Status.NO_PATH
            answer["rejections"][self.reject_reason] = 1694
        else:
            answer["arc"]["length_m"], answer["arc"]["heading_change_rad"] = arc
        return answer

    def _evaluate_arc(self, request):
        arc = request["arc"]
        if arc["length_m"] == 0.0 and arc["heading_change_rad"] == 0.0:
            answer = self._answer("check_map", Kind.EVALUATE_ARC_OUT, request)
            answer["is_safe"] = self.is_map_known
            answer["reason"] = 0 if self.is_map_known else Reason.UNKNOWN
            return answer
        if request["mode"] == Mode.UNGUARDED:
            answer = self._answer("check_zones", Kind.EVALUATE_ARC_OUT, request)
            end_m = float(request["pose"]["x_site_m"] + arc["length_m"])
            answer["is_safe"] = end_m <= self.zone_north_m
            answer["reason"] = 0 if answer["is_safe"] else Reason.KIOZ
            return answer
        answer = self._answer("evaluate", Kind.EVALUATE_ARC_OUT, request)
        answer["is_safe"] = self.is_safe.pop(0) if len(self.is_safe) > 1 else self.is_safe[0]
        answer["reason"] = 0 if answer["is_safe"] else Reason.TILT
        return answer


@pytest.fixture
def fake_world():
    return FakeWorld


@pytest.fixture
def expected_slip():
    return ExpectedSlip


@pytest.fixture
def fake_planner():
    return FakePlanner


@pytest.fixture
def make_drive():
    """Make a drive; the world moves by the given share of what is commanded."""

    def make(motion_share=1.0, **settings):
        return Drive(FakeWorld(motion_share), FakePlanner, **settings)

    return make


@pytest.fixture
def drive_info():
    return DriveInfo("test", "fake", 7, 0.0, 0.0, 0.0, (Waypoint(20.0, 0.0, 1.0, "avoid_all"),))


@pytest.fixture
def some_records():
    """A few records as a drive makes them, the end record last."""
    records = []
    stream = RecordStream([records.append])
    planner = FakePlanner(param_values({}), stream.publish)
    request = new_message(Kind.PROCESS_DISPARITY_IN)
    request["point_count"] = 3
    planner.process_disparity(request)
    request = new_message(Kind.SELECT_ARC_IN)
    request["time_s"] = 1.5
    planner.select_arc(request)
    truth = new_message(Kind.TRUTH)
    truth["distance_driven_m"] = 4.0
    truth["time_s"] = 2.0
    truth["clearance_m"] = 0.5
    stream.publish(Kind.TRUTH, 2.0, truth.tobytes())
    stream.publish(0, 2.0, end_payload(Outcome("goal_reached")))
    assert all(record.kind == 0 or record.kind in native_schema().kinds for record in records)
    return records


@pytest.fixture
def record_quick_drive():
    return record_drive


@pytest.fixture(scope="session")
def quick_drive(tmp_path_factory):
    """The recording of a short drive with small clouds."""
    path = tmp_path_factory.mktemp("recorded") / "drive.dp"
    assert record_drive(path, {}).is_reached
    return path
