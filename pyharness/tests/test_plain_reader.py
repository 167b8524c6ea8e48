# SPDX-License-Identifier: Apache-2.0
"""The reader printed in docs/replay.md does what it says."""

import json
import lzma
import re
from pathlib import Path

import numpy as np
import pytest

from pyharness.dp_file import DpReader

ROOT = Path(__file__).parents[2]
POWERPC = Path(__file__).with_name("data") / "powerpc.dp.xz"


@pytest.fixture(scope="module")
def reader():
    text = re.search(r"```python\n(.*?)```", (ROOT / "docs/replay.md").read_text(), re.DOTALL)[1]
    assert len(text.splitlines()) < 50
    assert set(re.findall(r"^import (\w+)", text, re.MULTILINE)) == {"json", "struct", "zlib"}
    names = {}
    exec(compile(text, "docs/replay.md", "exec"), names)
    return names["read"]


def same(found, expected):
    if isinstance(found, dict):
        return all(same(value, expected[name]) for name, value in found.items())
    if found == []:
        return True
    if isinstance(found, list) and isinstance(found[0], dict):
        return all(same(value, expected[index]) for index, value in enumerate(found))
    return np.array_equal(found, expected if np.ndim(found) == 0 else expected[: len(found)])


@pytest.mark.parametrize("name", ["this machine", "powerpc"])
def test_the_reader_of_the_documentation_reads_every_record(reader, name, quick_drive, tmp_path):
    path = quick_drive
    if name == "powerpc":
        path = tmp_path / "powerpc.dp"
        path.write_bytes(lzma.decompress(POWERPC.read_bytes()))
    with DpReader(path) as ours:
        records = list(ours.records())
        found = list(reader(path))
        assert len(found) == len(records)
        for (kind, time_s, fields), record in zip(found, records, strict=True):
            assert time_s == record.time_s
            if record.kind == 0:
                assert (kind, fields) == ("END", json.loads(record.payload))
            else:
                assert kind == ours.schema.kinds[record.kind].name
                assert same(fields, ours.schema.decode(record.kind, record.payload))


def test_the_reader_of_the_documentation_stops_at_damage(reader, quick_drive, tmp_path):
    data = bytearray(quick_drive.read_bytes())
    data[len(data) // 2] ^= 1
    (tmp_path / "bad.dp").write_bytes(data)
    with DpReader(quick_drive) as ours:
        count = len(list(ours.records()))
    assert 10 < len(list(reader(tmp_path / "bad.dp"))) < count
