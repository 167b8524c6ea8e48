# SPDX-License-Identifier: Apache-2.0
"""Planners that crash, hang or leave processes behind, for `file.py:Class`.

Those that live for a while tell their process by a file beside this one's copy.
"""

import os
import signal
import subprocess
import time
from pathlib import Path

from pyharness.planners.enav import Enav

HERE = Path(__file__).parent


def tell(pids):
    """Write process numbers, whole or not at all."""
    partial = HERE / f"{os.getpid()}.partial"
    partial.write_text(" ".join(map(str, pids)))
    partial.replace(HERE / f"{os.getpid()}.pids")


class Killed(Enav):
    def _analyze_terrain(self, request):  # noqa: ARG002
        os.kill(os.getpid(), signal.SIGKILL)


class Segfault(Enav):
    def _analyze_terrain(self, request):  # noqa: ARG002
        os.kill(os.getpid(), signal.SIGSEGV)


class RealTimeSignal(Enav):
    def _analyze_terrain(self, request):  # noqa: ARG002
        os.kill(os.getpid(), 40)


class Exits(Enav):
    def _analyze_terrain(self, request):  # noqa: ARG002
        os._exit(7)


class CannotStart(Enav):
    def __init__(self, *_):
        raise ValueError(f"{object()} is not what it was")


class Hangs(Enav):
    def _analyze_terrain(self, request):  # noqa: ARG002
        tell([os.getpid()])
        time.sleep(1000)


class Chatters(Enav):
    """Prints among the answers of its supervisor."""

    def _analyze_terrain(self, request):
        os.write(1, b'{"status": 9}\n')
        return super()._analyze_terrain(request)


class Breeds(Enav):
    """Leaves one process in its group and one in a session of its own, then hangs or goes on."""

    hangs = False

    def _set_kioz(self, request):
        stays = subprocess.Popen(["sleep", "1000"])
        leaves = subprocess.Popen(["sleep", "1000"], start_new_session=True)
        tell([os.getpid(), stays.pid, leaves.pid])
        if self.hangs:
            time.sleep(1000)
        return super()._set_kioz(request)


class BreedsAndHangs(Breeds):
    hangs = True
