# SPDX-License-Identifier: Apache-2.0
"""A recorded drive published again, as if it were live."""

import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from pyharness.dp import Kind
from pyharness.dp_file import Damage, DpReader
from pyharness.errors import DpFileError
from pyharness.history import History
from pyharness.records import Record, RecordStream


class Player:
    """Publishes the records of a file through a stream, with their own numbers.

    Attributes:
        cycle: Planning cycles that are complete: answers of select_arc published.
        time_s: Simulated time reached.
    """

    def __init__(self, reader: DpReader, stream: RecordStream) -> None:
        """Stand before the first record."""
        self._reader = reader
        self._stream = stream
        self._next: Record | None = None
        self._rewind()

    @property
    def is_done(self) -> bool:
        """Whether all records have been published."""
        return self._next is None

    @property
    def next_time_s(self) -> float:
        """Simulated time at which the next record was made: never back, for clouds merged late."""
        return self.time_s if self._next is None else max(self.time_s, self._next.time_s)

    def publish_next(self) -> None:
        """Publish one record, if there is one left."""
        record = self._next
        if record is not None:
            self.time_s = self.next_time_s
            self.cycle += record.kind == Kind.SELECT_ARC_OUT
            self._next = next(self._records, None)
            self._stream.forward(record)

    def seek(self, cycle: int) -> None:
        """Publish at once what comes before a planning cycle, the first being 1.

        Backward this begins again with record 0, and who listens forgets what it had.
        """
        if self.cycle >= cycle:
            self._rewind()
        while self.cycle < cycle - 1 and not self.is_done:
            self.publish_next()

    def play(
        self,
        speed: float | None = None,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        """Publish all that is left: at a multiple of simulated time, or as fast as it goes."""
        start_wall_s, start_s = clock(), self.time_s
        while not self.is_done:
            if speed is not None:
                ahead_s = (self.next_time_s - start_s) / speed - (clock() - start_wall_s)
                if ahead_s > 0.0:
                    sleep(ahead_s)
            self.publish_next()

    def _rewind(self) -> None:
        self.cycle = 0
        self.time_s = 0.0
        self._records: Iterator[Record] = self._reader.records()
        self._next = next(self._records, None)


def read_history(path: Path) -> tuple[History, Damage | None]:
    """Return what the intact records of a file tell, and its damage.

    Raises:
        DpFileError: The file cannot be used, or its records are not those of a drive.
    """
    with DpReader(path) as reader:
        history = History(reader.schema, reader.info)
        for _ in taken(history, reader.records(), path):
            pass
        return history, reader.damage


def taken(history: History, records: Iterable[Record], path: Path) -> Iterator[Record]:
    """Yield records after a history has taken them in."""
    for record in records:
        take(history, record, path)
        yield record


def take(history: History, record: Record, path: Path) -> None:
    """Take in a record of a file whose layout may be another than this program knows."""
    with makes_sense(path, f"record {record.sequence} is not laid out as this program expects"):
        history.take(record)


@contextmanager
def makes_sense(path: Path, fault: str) -> Iterator[None]:
    """Turn what fails because of the contents of a file, its checksums being right, into an error.

    Raises:
        DpFileError: With the fault.
    """
    try:
        yield
    except (LookupError, ValueError, TypeError, ArithmeticError) as error:
        raise DpFileError(f"{path}: {fault}: {error}") from None
