# SPDX-License-Identifier: Apache-2.0
import shutil

import pytest

from pyharness.bench_ace import ace_instructions


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("valgrind") is None, reason="valgrind is not installed")
def test_instructions_are_counted_and_repeat_exactly():
    counts = ace_instructions()
    assert 1_000 < counts["ace_instructions_per_pose"] < counts["ace_instructions_uncertain"]
    assert ace_instructions() == counts


def test_without_valgrind_there_is_nothing_to_tell(monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda _: None)
    assert ace_instructions() == {}
