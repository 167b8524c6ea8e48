# SPDX-License-Identifier: Apache-2.0
"""A drive with clients: runs, pauses and steps it as they say, at the speed they want.

docs/command_socket.md describes the lines.
"""

import base64
import json
import math
import time
from collections.abc import Mapping
from typing import Any

from pyharness.command_server import Client, CommandServer
from pyharness.commands import (
    COMMANDS,
    Command,
    CommandError,
    Controllable,
    EvaluateArc,
    ImageNow,
    Pause,
    PlaceRover,
    Run,
    Seek,
    Speed,
    Step,
    Stop,
    id_of,
    parse_command,
)
from pyharness.dp import Schema
from pyharness.dp_file import description
from pyharness.records import KIND_END, DriveInfo, Record, read_end


class RecordFeed:
    """Sends the record stream to all clients, how to read it first."""

    def __init__(self, server: CommandServer, schema: Schema, info: DriveInfo) -> None:
        """Prepare what every client is sent first."""
        self._server = server
        self._schema = schema
        head = {"byte_order": schema.byte_order, "commands": list(COMMANDS)}
        server.publish(_line("schema", {**head, **description(schema, info)}), "schema")

    def take(self, record: Record) -> None:
        """Send one record."""
        if record.kind == KIND_END:
            outcome = read_end(record.payload)
            end = {"outcome": outcome.outcome, "fault_detail": outcome.fault_detail}
            self._server.publish(_line("end", {"time_s": record.time_s, **end}), "end")
            return
        name = self._schema.kinds[record.kind].name
        data: dict[str, Any] = {
            "kind": name,
            "time_s": record.time_s,
            "sequence": record.sequence,
            "payload": base64.b64encode(record.payload).decode(),
        }
        self._server.publish(_line("record", data), f"record {name}")


class Session:
    """Owns the time of a drive. It waits for the first `run`; without clients it runs on."""

    def __init__(self, drive: Controllable, server: CommandServer) -> None:
        """Stand still."""
        self._drive = drive
        self._server = server
        self._is_running = False
        self._steps_left = 0
        self._until_s = math.inf
        self._speed: float | None = None
        self._start = (0.0, 0.0)  # wall time, drive time from which the pace is counted
        self._publish_state()

    def run(self) -> None:
        """Serve until the drive is over."""
        while not self._drive.is_over:
            self._serve(self._wait_s())
            if not self._drive.is_over and self._is_due():
                self._advance()
        self._is_running = False
        self._publish_state()
        self._serve(0.0)

    def _wait_s(self) -> float | None:
        """Return for how long nothing is to be done but to listen; None is for ever."""
        if not self._is_running:
            return None
        if self._speed is None:
            return 0.0
        wall_s, drive_s = self._start
        due_s = wall_s + (self._drive.time_s - drive_s) / self._speed
        return max(0.0, due_s - time.monotonic())

    def _is_due(self) -> bool:
        return self._is_running and self._wait_s() == 0.0

    def _advance(self) -> None:
        has_more = self._drive.advance()
        self._steps_left -= 1
        if not has_more or self._steps_left == 0 or self._drive.time_s >= self._until_s:
            self._set_running(False)

    def _set_running(self, is_running: bool, steps: int = 0, until_s: float = math.inf) -> None:
        """Run or stand still; steps 0 counts none."""
        self._is_running, self._steps_left, self._until_s = is_running, steps, until_s
        self._start = (time.monotonic(), self._drive.time_s)
        self._publish_state()

    def _publish_state(self) -> None:
        data = {
            "time_s": self._drive.time_s,
            "is_running": self._is_running,
            "speed": self._speed,
            "is_over": self._drive.is_over,
        }
        self._server.publish(_line("state", data), "state")

    # -------------------------------------------------------------- commands

    def _serve(self, wait_s: float | None) -> None:
        """Carry out what clients want: wait for the first, then all that are there."""
        message = self._server.receive(wait_s)
        while message is not None:
            if message.line is not None:
                self._answer(message.client, message.line)
            elif self._server.client_count == 0 and not self._is_running:
                self._speed = None
                self._set_running(True)
            message = self._server.receive(0.0)

    def _answer(self, client: Client, line: bytes) -> None:
        reply: dict[str, Any] = {"id": id_of(line)}
        try:
            command = parse_command(line)
            if self._drive.is_over:
                raise CommandError(f"{command.command}: the drive is over")
            result = self._execute(command)
            kind, reply = "reply", {**reply, "command": command.command, "result": dict(result)}
        except CommandError as error:
            kind, reply = "error", {**reply, "error": str(error)}
        client.send(_line(kind, reply))

    def _execute(self, command: Command) -> Mapping[str, Any]:
        match command:
            case Run(until_s=until_s):
                self._set_running(True, until_s=math.inf if until_s is None else until_s)
            case Pause():
                self._set_running(False)
            case Step(count=count):
                if self._is_running:
                    raise CommandError("step: the drive is running, pause it first")
                self._set_running(True, steps=count)
            case Speed(factor=factor):
                self._speed = factor
                self._set_running(self._is_running, self._steps_left, self._until_s)
            case Seek(time_s=time_s):
                self._drive.seek(time_s)
                self._set_running(self._is_running)
            case ImageNow():
                return self._drive.image_now()
            case PlaceRover():
                return self._drive.place_rover(command)
            case EvaluateArc():
                return self._drive.evaluate_arc(command)
            case Stop():
                self._drive.stop()
        return {}


def _line(kind: str, data: Mapping[str, Any]) -> bytes:
    text = json.dumps({"type": kind, **data}, separators=(",", ":"), allow_nan=False)
    return text.encode() + b"\n"
