# SPDX-License-Identifier: Apache-2.0
"""The rover's one computer: it works through a queue of tasks, one after the other."""

from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from pyharness.messages import Arc
from pyharness.telemetry import NO_ARC, Telemetry

TIME_TOLERANCE_S = 1e-9

Task = Callable[[], bool]
"""Starts an activity; whether it leaves the queue. One that cannot start yet stays at its head."""


def nothing() -> None:
    """Finish an activity whose result is already where it belongs."""


@dataclass(frozen=True, slots=True)
class Job:
    """What the computer is busy with; `finish` makes its result count."""

    end_s: float
    finish: Callable[[], None]


@dataclass(slots=True)
class Computer:
    """Idle or busy with one job, and a queue of tasks."""

    telemetry: Telemetry
    _queue: deque[Task] = field(default_factory=deque)
    _job: Job | None = None

    @property
    def is_busy(self) -> bool:
        """Whether a job is running."""
        return self._job is not None

    @property
    def is_done(self) -> bool:
        """Whether nothing is running and nothing is waiting."""
        return self._job is None and not self._queue

    def plan(self, tasks: Iterable[Task]) -> None:
        """Replace the queue; a running job goes on."""
        self._queue = deque(tasks)

    def clear(self) -> None:
        """Give up the running job and the queue."""
        self._job = None
        self._queue.clear()

    def occupy(
        self,
        activity: int,
        duration_s: float,
        finish: Callable[[], None] = nothing,
        arc: Arc = NO_ARC,
    ) -> None:
        """Be busy from now on; `finish` is called when that is over."""
        now_s = self.telemetry.world.time_s
        self._job = Job(now_s + duration_s, finish)
        self.telemetry.activity(activity, now_s, now_s + duration_s, arc)

    def finish_job(self) -> None:
        """Let the result of a job count whose time is over."""
        job, now_s = self._job, self.telemetry.world.time_s
        if job is not None and now_s >= job.end_s - TIME_TOLERANCE_S:
            self._job = None
            job.finish()

    def start_next(self) -> None:
        """Start what waits at the head of the queue, where it can start."""
        while self._job is None and self._queue and self._queue[0]():
            self._queue.popleft()
