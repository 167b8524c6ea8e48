# SPDX-License-Identifier: Apache-2.0
"""Fuzzes the reader, the metrics and the re-run with files whose checksums are right again.

`python -m pyharness.tests.fuzz_dp --seconds 60` ends with 1 and keeps the file when one is used in
another way than by an answer or one clear error, or takes longer than it should.
"""

import argparse
import random
import sys
import tempfile
import time
from pathlib import Path

from pyharness import metrics
from pyharness.dp_file import DpReader
from pyharness.errors import HarnessError
from pyharness.planners.enav import Enav
from pyharness.replay import makes_sense, read_history
from pyharness.rerun import compare, unbroken
from pyharness.tests.mutate_dp import mutated, record_starts
from pyharness.tests.quick_drive import record_drive

SLOW_S = 30.0


def use(path: Path) -> None:
    """Do all that the command line does with a file; errors for the user are fine."""
    try:
        history, _ = read_history(path)
        with makes_sense(path, "its records make no sense"):
            metrics.summary_text(metrics.summarize(history))
            metrics.cycles_csv(history)
            metrics.truth_csv(history)
            metrics.evr_log(history)
        with DpReader(path) as reader:
            compare(unbroken(reader.records()), reader.schema, Enav)
    except HarnessError:
        pass


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "drive.dp"
        record_drive(path, {"executive.crawl_length_m": 3.0, "executive.time_limit_s": 110.0})
        data = path.read_bytes()
        with DpReader(path) as reader:
            starts = record_starts(data, list(reader.records()))
        end_s = time.monotonic() + options.seconds
        count = 0
        while time.monotonic() < end_s:
            case = mutated(data, starts, random.Random(options.seed + count))
            path.write_bytes(case)
            start_s = time.monotonic()
            try:
                use(path)
            except Exception as error:
                return _found(case, options.seed + count, repr(error))
            if time.monotonic() - start_s > SLOW_S:
                return _found(case, options.seed + count, "slow")
            count += 1
    sys.stdout.write(f"fuzz_dp: {count} files in {options.seconds:.0f} s, nothing found\n")
    return 0


def _found(case: bytes, seed: int, what: str) -> int:
    kept = Path("build") / f"fuzz_dp_{seed}.dp"
    kept.parent.mkdir(exist_ok=True)
    kept.write_bytes(case)
    sys.stdout.write(f"fuzz_dp: {kept}: {what}\n")
    return 1


if __name__ == "__main__":
    sys.exit(main())
