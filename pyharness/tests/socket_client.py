# SPDX-License-Identifier: Apache-2.0
"""A client of the command socket, as a test needs it."""

import json
import socket
from contextlib import contextmanager


class SocketClient:
    """Sends commands, reads lines until the one it waits for."""

    def __init__(self, port):
        self.connection = socket.create_connection(("127.0.0.1", port), timeout=30)
        self.lines = self.connection.makefile("rb")
        self.seen = []

    def send(self, **command):
        self.send_line(json.dumps(command).encode())

    def send_line(self, line):
        self.connection.sendall(line + b"\n")

    def read(self):
        line = self.lines.readline()
        if not line:
            return None
        self.seen.append(json.loads(line))
        return self.seen[-1]

    def wait(self, *types):
        """Read on to the next line of one of these types."""
        while (item := self.read()) is not None:
            if item["type"] in types:
                return item
        return None

    def ask(self, **command):
        self.send(**command)
        return self.wait("reply", "error")

    def read_all(self):
        while self.read() is not None:
            pass
        return self.seen

    def close(self):
        self.lines.close()
        self.connection.close()


@contextmanager
def connecting(server):
    """Give a function that connects a client; all are closed at the end."""
    clients = []

    def connect():
        clients.append(SocketClient(server.port))
        return clients[-1]

    yield connect
    for client in clients:
        client.close()
