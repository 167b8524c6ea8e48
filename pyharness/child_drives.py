# SPDX-License-Identifier: Apache-2.0
"""Drives in processes of their own, from the side that asks for them.

`Servers.run` is called by threads of the campaign, or of a Dask worker; whatever a drive does, it
returns what became of it.
"""

import json
import os
import signal
import subprocess
import sys
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path
from threading import Lock
from typing import Any

from pyharness.errors import HarnessError, OutputError

# one drive, one core
ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS"), "1"
)
SIGNAL_NAMES = {number.value: number.name for number in signal.Signals}
BY_HAND = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
STOPPED = "the campaign was stopped"


class StoppedError(HarnessError):
    """The drive was given up because the campaign stops."""


@dataclass(frozen=True, slots=True)
class DriveTask:
    """A drive to run.

    Attributes:
        scenario: Resolved, as JSON.
        keep: Of which drives the folder is kept.
        time_out_s: Wall time after which it is given up.
    """

    scenario: str
    keep: str
    time_out_s: float


@dataclass(frozen=True, slots=True)
class DriveResult:
    """What became of a drive.

    Attributes:
        summary: Of a drive that came to its end.
        margins: Its histograms, as plain data.
        outcome: Of a drive that did not: `crashed`, `killed` or `timed_out`.
        detail: What happened to it.
        files: What is kept, name to content.
    """

    summary: dict[str, Any] | None = None
    margins: dict[str, Any] | None = None
    outcome: str = ""
    detail: str = ""
    files: dict[str, bytes] = field(default_factory=dict)


class Servers:
    """The processes that fork drives (`drive_server`): as many as drives run at a time."""

    def __init__(self) -> None:
        """Start none: every one is started when it is needed."""
        self._lock = Lock()
        self._idle: list[_Server] = []
        self._all: set[_Server] = set()
        self._is_stopped = False

    def run(self, task: DriveTask) -> DriveResult:
        """Run one drive in a process of its own.

        Raises:
            StoppedError: `stop` was called.
            OutputError: The disk is full.
            HarnessError: No drive can be run here.
        """
        server = self._take()
        is_usable = False
        try:
            result = server.run(task)
            is_usable = server.is_alive
        finally:
            with self._lock:
                if is_usable and not self._is_stopped:
                    self._idle.append(server)
                else:
                    self._all.discard(server)
                    server.stop()
        return result

    def stop(self) -> None:
        """End all processes, and the drives that they run; no drive is run any more."""
        with self._lock:
            self._is_stopped = True
            for server in self._all:
                server.stop()
            self._all.clear()

    def _take(self) -> "_Server":
        with self._lock:
            if self._is_stopped:
                raise StoppedError(STOPPED)
            if self._idle:
                return self._idle.pop()
            try:
                server = _Server()
            except OSError as error:
                raise HarnessError(f"no drive can be run: {error.strerror}") from error
            self._all.add(server)
            return server


class _Server:
    """One process that forks drives."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "pyharness.drive_server"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,  # until it has begun
            env={**os.environ, **ONE_THREAD},
            text=True,
            start_new_session=True,  # Ctrl-C is for the campaign, which then ends this
        )
        self._is_stopped = False

    @property
    def is_alive(self) -> bool:
        return self._process.poll() is None

    def run(self, task: DriveTask) -> DriveResult:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            self._process.stdin.write(json.dumps(asdict(task)) + "\n")
            self._process.stdin.flush()
            line = self._process.stdout.readline()
        except (OSError, ValueError):  # it has ended, or the pipe was closed by `stop`
            line = ""
        if self._is_stopped:
            raise StoppedError(STOPPED)
        if not line:
            return self._ended()
        answer = json.loads(line)
        return _result(answer["status"], Path(answer["folder"]), task.time_out_s)

    def _ended(self) -> DriveResult:
        """Return what became of the drive when this process ended instead of answering."""
        code = self._process.wait()
        if code < 0:
            return _died(-code)
        assert self._process.stderr is not None
        lines = self._process.stderr.read().strip().splitlines() or [f"exit code {code}"]
        raise HarnessError(f"no drive can be run: {lines[-1]}")

    def stop(self) -> None:
        """Have it kill its drive and end; wait for that."""
        self._is_stopped = True
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        assert self._process.stderr is not None
        with suppress(OSError):
            self._process.stdin.close()
        self._process.wait()
        self._process.stdout.close()
        self._process.stderr.close()


def _result(status: int | None, folder: Path, time_out_s: float) -> DriveResult:
    """Return what became of a drive from how its process ended and what it left."""
    from pyharness.campaign_drive import KEPT_FOLDER, RESULT_FILE

    if status is None:
        return DriveResult(outcome="timed_out", detail=f"over {time_out_s:g} s of wall time")
    code = os.waitstatus_to_exitcode(status)
    if code < 0:
        return _died(-code)
    if code == os.EX_IOERR:
        raise OutputError(f"{folder}: no space left on device")
    if code != 0 or not (folder / RESULT_FILE).exists():
        return DriveResult(outcome="crashed", detail=f"exit code {code}")
    result = json.loads((folder / RESULT_FILE).read_text("utf-8"))
    if "error" in result:
        return DriveResult(outcome="crashed", detail=result["error"])
    kept = folder / KEPT_FOLDER
    files = {path.name: path.read_bytes() for path in kept.iterdir()} if kept.exists() else {}
    return DriveResult(result["summary"], result["margins"], files=files)


def _died(number: int) -> DriveResult:
    """Return what became of a drive that a signal ended."""
    outcome = "killed" if number in BY_HAND else "crashed"
    return DriveResult(outcome=outcome, detail=f"signal {SIGNAL_NAMES.get(number, number)}")
