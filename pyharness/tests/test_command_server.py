# SPDX-License-Identifier: Apache-2.0
import socket
import time

import pytest

from pyharness import command_server
from pyharness.command_server import CommandServer
from pyharness.errors import HarnessError
from pyharness.tests.socket_client import connecting


@pytest.fixture
def server():
    server = CommandServer(0)
    yield server
    server.close()


@pytest.fixture
def connect(server):
    with connecting(server) as connect:
        yield connect


def until(condition):
    deadline_s = time.monotonic() + 10
    while not condition():
        assert time.monotonic() < deadline_s
        time.sleep(0.005)


def test_it_listens_on_this_machine_only(server):
    assert server._listener.getsockname()[0] == "127.0.0.1"


def test_lines_go_to_all_clients_and_come_back_with_their_sender(server, connect):
    clients = [connect() for _ in range(5)]
    until(lambda: server.client_count == 5)
    server.publish(b'{"type":"state","n":1}\n', "state")
    assert [client.read()["n"] for client in clients] == [1] * 5
    clients[3].send_line(b"hello")
    message = server.receive(5.0)
    assert message.line == b"hello\n"
    message.client.send(b'{"type":"reply"}\n')
    assert clients[3].read() == {"type": "reply"}


def test_a_late_client_gets_the_newest_line_of_every_key(server, connect):
    for n in range(3):
        server.publish(b'{"key":"a","n":%d}\n' % n, "a")
    server.publish(b'{"key":"b","n":9}\n', "b")
    client = connect()
    assert [client.read(), client.read()] == [{"key": "a", "n": 2}, {"key": "b", "n": 9}]


@pytest.mark.faults
def test_a_client_that_goes_is_forgotten_and_reported(server, connect):
    client, other = connect(), connect()
    until(lambda: server.client_count == 2)
    client.close()
    assert server.receive(5.0).line is None
    assert server.client_count == 1
    server.publish(b'{"n":1}\n', "n")
    assert other.read() == {"n": 1}


@pytest.mark.faults
def test_a_client_that_does_not_read_is_dropped_and_the_others_go_on(server, connect, monkeypatch):
    monkeypatch.setattr(command_server, "PATIENCE_S", 0.2)
    stubborn = socket.create_connection(("127.0.0.1", server.port))
    until(lambda: server.client_count == 1)
    line = b'{"text":"%s"}\n' % (b"x" * 200_000)
    until(lambda: server.publish(line, "text") or server.client_count == 0)
    client = connect()
    assert client.read()["text"]
    stubborn.close()


@pytest.mark.faults
def test_a_line_without_end_is_an_error_and_ends_the_connection(connect):
    client = connect()
    client.connection.sendall(b"x" * (command_server.LINE_MAX_BYTES + 10))
    assert "too long" in client.read()["error"]
    assert client.read() is None


def test_on_closing_what_is_queued_still_arrives(server, connect):
    client = connect()
    until(lambda: server.client_count == 1)
    for n in range(100):
        server.publish(b'{"n":%d}\n' % n, "n")
    server.close()
    assert len(client.read_all()) == 100


def test_a_port_in_use_is_one_clear_error(server):
    with pytest.raises(HarnessError, match=f"port {server.port} of 127.0.0.1"):
        CommandServer(server.port)
