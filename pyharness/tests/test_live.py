# SPDX-License-Identifier: Apache-2.0
"""A live drive over the command socket, as a GUI would drive it."""

import base64
import math
import threading

import pytest

from pyharness.command_server import CommandServer
from pyharness.dp import Kind, native_schema
from pyharness.drive import drive
from pyharness.planners.enav import Enav
from pyharness.records import KIND_END, RecordStream
from pyharness.scenario import load_scenario, make_terrain
from pyharness.tests.socket_client import SocketClient

SHORT = {
    "terrain": {"size_m": 40.0},
    "start": [-10.0, 0.0, 0.0],
    "goal": [0.0, 0.0],
    "camera": {"cloud_width_px": 80, "cloud_height_px": 60},
}


class Live:
    """A drive in a thread of its own, and one client."""

    def __init__(self):
        self.records = []
        self.server = CommandServer(0)
        self.scenario = load_scenario(None, SHORT)
        self.thread = threading.Thread(target=self._run, daemon=True)
        self.thread.start()
        self.client = SocketClient(self.server.port)

    def _run(self):
        stream = RecordStream([self.records.append])
        terrain = make_terrain(self.scenario)
        self.outcome = drive(self.scenario, terrain, Enav, stream, self.server)
        self.server.close()

    def run_until(self, time_s):
        self.client.ask(command="run", until_s=time_s)
        while (state := self.client.wait("state"))["is_running"]:
            pass
        return state

    def finish(self):
        if self.thread.is_alive():
            self.client.send(command="run")
        lines = self.client.read_all()
        self.thread.join(30)
        return lines


@pytest.fixture
def live():
    live = Live()
    yield live
    live.client.close()
    live.thread.join(30)


def test_the_stream_over_the_socket_is_the_recorded_one(live):
    lines = live.finish()
    assert lines[0]["type"] == "schema"
    assert {item["name"] for item in lines[0]["kinds"]} >= {"TRUTH", "SELECT_ARC_OUT", "HOST_EVR"}
    sent = {
        item["sequence"]: base64.b64decode(item["payload"])
        for item in lines
        if item["type"] == "record"
    }
    recorded = {item.sequence: item.payload for item in live.records if item.kind != KIND_END}
    missing = set(recorded) - set(sent)
    # what came before the client had connected is replaced by the newest of its kind
    assert all(recorded[number] == payload for number, payload in sent.items())
    assert len(missing) < 20
    assert lines[-2]["type"] == "end" or lines[-1]["type"] == "end"
    assert live.outcome.outcome == "goal_reached"


def test_pausing_and_stepping_leave_the_records_as_they_would_have_been(live):
    for time_s in (20.0, 20.5, 90.0):
        live.run_until(time_s)
    live.client.ask(command="step", count=7)
    live.finish()
    undisturbed = []
    drive(live.scenario, make_terrain(live.scenario), Enav, RecordStream([undisturbed.append]))
    assert live.records == undisturbed


def test_an_arc_is_evaluated_on_request(live):
    live.run_until(200.0)
    verdict = live.client.ask(command="evaluate_arc", length_m=1.0)["result"]
    assert verdict["is_safe"]
    behind = {"length_m": 1.0, "from_north_east_yaw": [-10.0, -15.0, 0.0]}
    refused = live.client.ask(command="evaluate_arc", **behind)["result"]
    assert (refused["is_safe"], refused["reason"]) == (False, "unknown")
    live.finish()


def test_before_terrain_is_analyzed_evaluating_is_refused(live):
    answer = live.client.ask(command="evaluate_arc", length_m=1.0)
    assert "has terrain been analyzed" in answer["error"]
    live.finish()
    assert live.outcome.is_reached


def test_an_image_now_is_merged(live):
    live.run_until(30.0)
    assert live.client.ask(command="image_now")["result"]["point_count"] > 1000
    live.finish()
    assert live.outcome.is_reached


def test_a_rover_set_down_elsewhere_begins_again_from_there(live):
    live.run_until(100.0)
    live.client.ask(command="place_rover", north_m=0.0, east_m=-10.0, yaw_deg=90.0)
    live.finish()
    assert live.outcome.is_reached
    truths = [
        native_schema().decode(item.kind, item.payload)
        for item in live.records
        if item.kind == Kind.TRUTH and item.time_s > 100.0
    ]
    first = truths[0]["pose"]
    assert math.hypot(first["x_site_m"], first["y_site_m"] + 10.0) < 0.05
    assert max(abs(float(item["pose"]["x_site_m"])) for item in truths) < 4.0


def test_off_the_terrain_no_rover_is_set_down(live):
    answer = live.client.ask(command="place_rover", north_m=500.0, east_m=0.0, yaw_deg=0.0)
    assert "500, 0 is not on the terrain" in answer["error"]
    live.finish()
    assert live.outcome.is_reached


def test_a_stopped_drive_has_complete_records(live):
    live.run_until(50.0)
    live.client.ask(command="stop")
    lines = live.finish()
    assert live.outcome.outcome == "stopped"
    assert live.records[-1].kind == KIND_END
    assert any(item["type"] == "end" and item["outcome"] == "stopped" for item in lines)


def test_a_simulation_cannot_be_sought(live):
    assert "only a replay can" in live.client.ask(command="seek", time_s=1.0)["error"]
    live.finish()
