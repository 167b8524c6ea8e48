# SPDX-License-Identifier: Apache-2.0
"""Time of a drive under the commands of clients."""

import threading
import time

import pytest

from pyharness.command_server import CommandServer
from pyharness.commands import CommandError
from pyharness.session import Session
from pyharness.tests.socket_client import connecting


class Count:
    """A drive that counts its steps of half a second; it is over after 40 or when stopped."""

    def __init__(self):
        self.steps = 0
        self.is_over = False

    @property
    def time_s(self):
        return 0.5 * self.steps

    def advance(self):
        self.steps += 1
        self.is_over = self.steps >= 40
        return not self.is_over

    def seek(self, time_s):  # noqa: ARG002
        raise CommandError("seek: only a replay can")

    def image_now(self):
        return {"point_count": 5}

    def place_rover(self, command):
        return {"yaw_deg": command.yaw_deg}

    def evaluate_arc(self, command):
        return {"is_safe": command.length_m < 1}

    def stop(self):
        self.is_over = True


@pytest.fixture
def drive():
    return Count()


@pytest.fixture
def server(drive):
    server = CommandServer(0)

    def run():
        Session(drive, server).run()
        server.close()

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    yield server
    # without clients it runs to the end
    thread.join(10)
    assert not thread.is_alive()


@pytest.fixture
def connect(server):
    with connecting(server) as connect:
        yield connect


@pytest.fixture
def client(connect):
    return connect()


def test_it_waits_for_the_first_run_and_then_goes_to_the_end(client, drive):
    assert client.read() == {
        "type": "state",
        "time_s": 0.0,
        "is_running": False,
        "speed": None,
        "is_over": False,
    }
    time.sleep(0.05)
    assert drive.steps == 0
    assert client.ask(command="run", id=1)["id"] == 1
    assert client.read_all()[-1]["is_over"]
    assert drive.steps == 40


def test_steps_and_times_are_exact(client, drive):
    client.ask(command="step", count=3)
    while client.wait("state")["is_running"]:
        pass
    assert drive.steps == 3
    client.ask(command="run", until_s=10.0)
    while client.wait("state")["is_running"]:
        pass
    assert drive.time_s == 10.0


def test_the_pace_is_kept_and_commands_are_heard_meanwhile(client, drive):
    client.ask(command="speed", factor=10.0)
    start_s = time.monotonic()
    client.ask(command="run", until_s=4.0)
    assert client.ask(command="image_now")["result"] == {"point_count": 5}
    assert drive.time_s < 4.0
    while client.wait("state")["is_running"]:
        pass
    # the last of the eight steps is due at 3.5 s
    assert 0.3 < time.monotonic() - start_s < 1.0


def test_a_pause_stops_time(client, drive):
    client.ask(command="speed", factor=1.0)
    client.ask(command="run")
    client.ask(command="pause")
    steps = drive.steps
    time.sleep(0.6)
    assert drive.steps == steps < 5


@pytest.mark.faults
@pytest.mark.parametrize(
    ("line", "message"),
    [
        (b"nonsense", "not JSON"),
        (b'{"command": "fly"}', "unknown command 'fly'"),
        (b'{"command": "seek", "time_s": 1}', "only a replay can"),
        (b'{"command": "step"}', "pause it first"),
    ],
)
def test_what_is_wrong_or_out_of_sequence_is_one_error_line_and_the_drive_goes_on(
    client, drive, line, message
):
    client.ask(command="speed", factor=2.0)
    client.ask(command="run")
    client.send_line(line)
    assert message in client.wait("error", "reply")["error"]
    assert client.ask(command="speed", factor=None)["type"] == "reply"
    client.read_all()
    assert drive.steps == 40


@pytest.mark.faults
def test_without_clients_the_drive_runs_on(connect, drive):
    first = connect()
    first.ask(command="step", count=2)
    first.close()
    deadline_s = time.monotonic() + 10
    while not drive.is_over:
        assert time.monotonic() < deadline_s
        time.sleep(0.01)
    assert drive.steps == 40


@pytest.mark.faults
def test_another_client_stays_in_control_when_one_goes(client, connect, drive):
    other = connect()
    other.ask(command="step", count=2)
    other.close()
    time.sleep(0.1)
    assert drive.steps == 2
    assert client.ask(command="stop")["type"] == "reply"


def test_many_clients_see_the_same(connect, drive):
    clients = [connect() for _ in range(10)]
    for client in clients:
        client.ask(command="pause")
    clients[0].ask(command="run")
    ends = [client.read_all()[-1] for client in clients]
    assert all(end["is_over"] and end["time_s"] == drive.time_s for end in ends)
