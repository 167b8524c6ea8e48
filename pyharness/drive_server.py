# SPDX-License-Identifier: Apache-2.0
"""Runs drives one after the other, each in a process forked from this one, which imports once.

Started by `child_drives`, which asks for a drive by a line of JSON on standard input and reads the
answer on standard output. Whatever a drive does, it ends with the process that asked:

- standard input at its end: that process is gone, so the drive is killed with all its descendants
- this process killed: the kernel kills the drive (PR_SET_PDEATHSIG)
- a drive that is over or takes too long: its process group is killed, and what left the group
  (orphans come to this process, PR_SET_CHILD_SUBREAPER)
"""

import ctypes
import errno
import json
import os
import re
import resource
import select
import shutil
import signal
import sys
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Any, NoReturn

from pyharness.campaign_drive import run_campaign_drive, write_result
from pyharness.errors import HarnessError
from pyharness.scenario import Scenario
from sim.errors import SimError

PR_SET_PDEATHSIG = 1
PR_SET_CHILD_SUBREAPER = 36
NO_ROOM = (errno.ENOSPC, errno.EDQUOT)
EXIT_NO_ROOM = os.EX_IOERR
ADDRESS = re.compile("0x[0-9a-f]+")


def main() -> None:
    """Serve until nobody is there to ask."""
    _prctl(PR_SET_CHILD_SUBREAPER, 1)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    folder = Path(tempfile.mkdtemp(prefix="enav-drives-"))
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    for descriptor in (1, 2):  # nothing that a planner prints gets among the answers
        _redirect(descriptor, os.devnull)
    try:
        while line := sys.stdin.readline():
            _empty(folder)
            request = json.loads(line)
            if request["keep"] != "none":
                import pyharness.overhead  # noqa: F401 (once, for all drives)
            status = _supervised(request, folder)
            answers.write(json.dumps({"status": status, "folder": str(folder)}) + "\n")
            answers.flush()
    except (BrokenPipeError, _GoneError):
        pass
    finally:
        shutil.rmtree(folder, ignore_errors=True)


class _GoneError(Exception):
    """The process that asked is gone."""


def _supervised(request: dict[str, Any], folder: Path) -> int | None:
    """Run one drive; return its wait status, or None when it took too long.

    Raises:
        _GoneError: The process that asked is gone.
    """
    server_pid = os.getpid()
    pid = os.fork()
    if pid == 0:
        _be_drive(request, folder, server_pid)
    with suppress(OSError):  # both sides do it, whoever comes first
        os.setpgid(pid, pid)
    is_over, is_alone = _wait(pid, request["time_out_s"])
    # it is not reaped yet, so that its number is still the name of its group
    _kill_group(pid)
    status = os.waitpid(pid, 0)[1]
    _kill_orphans()
    if is_alone:
        raise _GoneError
    return status if is_over else None


def _wait(pid: int, time_out_s: float) -> tuple[bool, bool]:
    """Wait for a drive; return whether it is over, and whether the process that asked is gone."""
    process = os.pidfd_open(pid)
    poll = select.poll()
    poll.register(process, select.POLLIN)
    poll.register(0, select.POLLIN)  # nothing is asked meanwhile: this is the end
    try:
        ready = [descriptor for descriptor, _ in poll.poll(1000.0 * time_out_s)]
    finally:
        os.close(process)
    return process in ready, 0 in ready


def _kill_group(pid: int) -> None:
    with suppress(ProcessLookupError):
        os.killpg(pid, signal.SIGKILL)


def _kill_orphans() -> None:
    """Kill what has left the group of its drive; whoever dies may leave orphans in turn."""
    children = Path(f"/proc/self/task/{os.getpid()}/children")
    if not children.exists():  # a kernel without this list
        return
    while pids := [int(number) for number in children.read_text().split()]:
        for pid in pids:
            _kill_group(pid)
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
            os.waitpid(pid, 0)


def _empty(folder: Path) -> None:
    for path in folder.iterdir():
        shutil.rmtree(path) if path.is_dir() else path.unlink()


# ------------------------------------------------------------------ the forked process


def _be_drive(request: dict[str, Any], folder: Path, server_pid: int) -> NoReturn:
    code = 1
    try:
        os.setpgid(0, 0)
        _prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() == server_pid:  # not killed before that
            _redirect(0, os.devnull)
            _drive(request, folder)
            code = 0
    except OSError as error:
        code = EXIT_NO_ROOM if error.errno in NO_ROOM else 1
    except SystemExit as error:
        code = error.code if isinstance(error.code, int) else 1
    finally:
        os._exit(code)


def _drive(request: dict[str, Any], folder: Path) -> None:
    """Run a drive; what it cannot be run for is its result, but for a full disk."""
    try:
        scenario = Scenario.model_validate_json(request["scenario"])
        run_campaign_drive(scenario, request["keep"], folder)
    except (HarnessError, SimError) as error:
        write_result(folder, {"error": " ".join(str(error).split())})
    except Exception as error:
        if isinstance(error, OSError) and error.errno in NO_ROOM:
            raise
        write_result(folder, {"error": _described(error)})


def _described(error: Exception) -> str:
    """Return an error as the same text in every run: without addresses and names of this folder."""
    text = f"{error.strerror}" if isinstance(error, OSError) and error.strerror else f"{error}"
    return ADDRESS.sub("0x...", " ".join(f"{type(error).__name__}: {text}".split()))


def _redirect(descriptor: int, path: str) -> None:
    other = os.open(path, os.O_RDWR)
    os.dup2(other, descriptor)
    os.close(other)


def _prctl(option: int, value: int) -> None:
    ctypes.CDLL(None, use_errno=True).prctl(option, value, 0, 0, 0)


if __name__ == "__main__":
    main()
