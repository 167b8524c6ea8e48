# SPDX-License-Identifier: Apache-2.0
"""Lines of text to and from any number of clients on a socket of this machine.

Knows neither what the lines say nor who answers them. A client that goes, or does not read what it
is sent, is dropped; nobody else notices.
"""

import queue
import socket
import threading
from contextlib import suppress
from dataclasses import dataclass, field

from pyharness.errors import HarnessError

HOST = "127.0.0.1"
LINE_MAX_BYTES = 1 << 16  # of a client's line: commands are short
OUTBOX_LINES = 256
PATIENCE_S = 10.0  # with a client that reads nothing while its outbox is full


@dataclass(eq=False, slots=True)
class Client:
    """One connection: a reader and a writer thread, with a bounded outbox between."""

    connection: socket.socket
    outbox: queue.Queue[bytes | None] = field(
        default_factory=lambda: queue.Queue(maxsize=OUTBOX_LINES)
    )
    writer: threading.Thread | None = None

    def send(self, line: bytes) -> bool:
        """Queue a line, waiting for a slow reader; False when it is too slow or gone."""
        try:
            self.outbox.put(line, timeout=PATIENCE_S)
        except queue.Full:
            self.cut()
            return False
        return True

    def cut(self) -> None:
        """End the connection; its threads notice."""
        with suppress(OSError):
            self.connection.shutdown(socket.SHUT_RDWR)


@dataclass(frozen=True, slots=True)
class Message:
    """A line that a client sent; None when the client has gone."""

    client: Client
    line: bytes | None


class CommandServer:
    """Accepts clients, hands their lines to `receive`, sends lines to one or all."""

    def __init__(self, port: int) -> None:
        """Listen; port 0 takes any that is free.

        Raises:
            HarnessError: The port cannot be had.
        """
        try:
            self._listener = socket.create_server((HOST, port))
        except (OSError, OverflowError) as error:
            raise HarnessError(f"port {port} of {HOST}: {error}") from error
        self._inbox: queue.Queue[Message] = queue.Queue()
        self._lock = threading.Lock()
        self._clients: set[Client] = set()
        self._latest: dict[str, bytes] = {}
        threading.Thread(target=self._accept, name="command-server", daemon=True).start()

    @property
    def port(self) -> int:
        """The port it listens on."""
        return int(self._listener.getsockname()[1])

    @property
    def client_count(self) -> int:
        """How many clients there are."""
        with self._lock:
            return len(self._clients)

    def publish(self, line: bytes, key: str) -> None:
        """Send a line to all clients; one that comes later gets the newest of each key first."""
        with self._lock:
            self._latest[key] = line
            clients = list(self._clients)
        for client in clients:
            if not client.send(line):
                self._forget(client)

    def receive(self, timeout_s: float | None) -> Message | None:
        """Return the next line of a client; None when none comes in time."""
        try:
            return self._inbox.get(timeout=timeout_s) if timeout_s != 0 else self._inbox.get(False)
        except queue.Empty:
            return None

    def close(self) -> None:
        """Send what is queued, then end all connections."""
        with suppress(OSError):
            self._listener.shutdown(socket.SHUT_RDWR)  # wakes who waits in accept
        self._listener.close()
        with self._lock:
            clients, self._clients = list(self._clients), set()
        for client in clients:
            with suppress(queue.Full):
                client.outbox.put(None, timeout=PATIENCE_S)
        for client in clients:
            if client.writer is not None:
                client.writer.join(PATIENCE_S)
            client.cut()

    def _accept(self) -> None:
        while True:
            try:
                connection, _ = self._listener.accept()
            except OSError:
                return
            connection.settimeout(None)
            client = Client(connection)
            client.writer = threading.Thread(target=self._write, args=(client,), daemon=True)
            with self._lock:
                for line in self._latest.values():
                    client.outbox.put_nowait(line)
                self._clients.add(client)
            client.writer.start()
            threading.Thread(target=self._read, args=(client,), daemon=True).start()

    def _read(self, client: Client) -> None:
        with suppress(OSError), client.connection.makefile("rb") as lines:
            while line := lines.readline(LINE_MAX_BYTES):
                if not line.endswith(b"\n"):
                    client.outbox.put(b'{"type":"error","error":"line too long or cut off"}\n')
                    break
                if line.strip():
                    self._inbox.put(Message(client, line))
        self._forget(client)
        self._inbox.put(Message(client, None))
        with suppress(queue.Full):
            client.outbox.put(None, timeout=PATIENCE_S)

    def _write(self, client: Client) -> None:
        with suppress(OSError):
            while (line := client.outbox.get()) is not None:
                client.connection.sendall(line)
        self._forget(client)
        client.cut()
        client.connection.close()

    def _forget(self, client: Client) -> None:
        with self._lock:
            self._clients.discard(client)
