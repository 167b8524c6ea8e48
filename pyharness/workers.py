# SPDX-License-Identifier: Apache-2.0
"""Where the drives of a campaign are run: in threads here, or by the workers of a Dask cluster.

Both are an executor of `concurrent.futures`; its tasks wait for a drive in a process of its own.
"""

import logging
from collections.abc import Iterator
from concurrent.futures import CancelledError, Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import metadata
from typing import Any, Protocol

from pyharness.child_drives import DriveResult, DriveTask, Servers
from pyharness.errors import HarnessError

DASK_TIME_OUT_S = 10


class Workers(Protocol):
    """Runs drives."""

    @property
    def about(self) -> dict[str, Any]:
        """Return what they are, for the record."""
        ...

    def submit(self, task: DriveTask) -> Future[DriveResult]:
        """Have a drive run."""
        ...

    def result(self, future: Future[DriveResult]) -> DriveResult:
        """Return what became of a drive that is over."""
        ...


# ------------------------------------------------------------------ this machine


@dataclass(frozen=True, slots=True)
class _LocalWorkers:
    count: int
    executor: Executor
    servers: Servers

    @property
    def about(self) -> dict[str, Any]:
        return {"workers": self.count, "scheduler": None}

    def submit(self, task: DriveTask) -> Future[DriveResult]:
        return self.executor.submit(self.servers.run, task)

    def result(self, future: Future[DriveResult]) -> DriveResult:
        return future.result()


@contextmanager
def local_workers(count: int) -> Iterator[Workers]:
    """Run that many drives at a time on this machine; at the end whatever still runs is killed."""
    servers = Servers()
    pool = ThreadPoolExecutor(count)
    try:
        yield _LocalWorkers(count, pool, servers)
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        servers.stop()
        pool.shutdown()


# ------------------------------------------------------------------ a Dask cluster

_WORKER_SERVERS = Servers()
"""Of a Dask worker: they end with it."""


def run_on_worker(task: DriveTask, version: str) -> DriveResult:
    """Run one drive on the machine of a Dask worker.

    Raises:
        HarnessError: The worker has another version of this package.
    """
    if version != version_here():
        raise HarnessError(f"a worker has enav-sim {version_here()}, expected {version}")
    return _WORKER_SERVERS.run(task)


def version_here() -> str:
    """Return the version of this package."""
    return metadata.version("enav-sim")


@dataclass(frozen=True, slots=True)
class _DaskWorkers:
    address: str
    executor: Executor
    count: int

    @property
    def about(self) -> dict[str, Any]:
        return {"workers": self.count, "scheduler": self.address}

    def submit(self, task: DriveTask) -> Future[DriveResult]:
        try:
            return self.executor.submit(run_on_worker, task, version_here())
        except (RuntimeError, OSError):
            raise self._gone() from None

    def result(self, future: Future[DriveResult]) -> DriveResult:
        from distributed import KilledWorker
        from distributed.comm import CommClosedError

        try:
            return future.result()
        except KilledWorker:
            return DriveResult(outcome="killed", detail="every Dask worker that had it died")
        except (CancelledError, CommClosedError):
            raise self._gone() from None
        except HarnessError:
            raise
        except Exception as error:  # a worker without this package, for one
            raise HarnessError(f"{self.address}: a worker cannot run drives: {error!r}") from None

    def _gone(self) -> HarnessError:
        return HarnessError(f"{self.address}: the Dask scheduler is gone")


@contextmanager
def dask_workers(address: str) -> Iterator[Workers]:
    """Run drives on the workers of a Dask cluster; at the end what has not begun is given up.

    Raises:
        HarnessError: There is no such cluster.
    """
    try:
        from distributed import Client
    except ImportError:
        raise HarnessError(
            "--scheduler needs the extra `cluster`: pip install 'enav-sim[cluster]'"
        ) from None
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    try:
        client = Client(address, timeout=DASK_TIME_OUT_S, set_as_default=False)
    except (OSError, ValueError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise HarnessError(f"--scheduler {address}: no Dask scheduler answers: {reason}") from None
    with client:
        executor = client.get_executor(pure=False)
        try:
            yield _DaskWorkers(address, executor, sum(client.nthreads().values()))
        finally:
            executor.shutdown(wait=False)
