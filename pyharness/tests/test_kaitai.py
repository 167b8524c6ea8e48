# SPDX-License-Identifier: Apache-2.0
"""Kaitai Struct's own reader, compiled from navlib_c/enav_dp.ksy, against real files."""

import hashlib
import importlib.util
import lzma
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

from pyharness._build.make_ksy import KSY, ksy_text
from pyharness.dp_file import DpReader

ROOT = Path(__file__).parents[2]
DATA = Path(__file__).with_name("data")
COMPILED = DATA / "enav_dp.py"


def load(path):
    spec = importlib.util.spec_from_file_location("enav_dp", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.EnavDp


@pytest.fixture(scope="module")
def kaitai():
    pytest.importorskip("kaitaistruct")
    compiled_from = re.match(r"# ksy sha256 (\w+)", COMPILED.read_text())[1]
    if compiled_from != hashlib.sha256(KSY.read_bytes()).hexdigest():
        pytest.skip("enav_dp.ksy is newer than its compiled reader: make kaitai")
    return load(COMPILED)


def test_the_description_is_that_of_the_c_tables():
    assert KSY.read_text() == ksy_text(), "run: make docs"


def assert_same(found, expected, name=""):
    """Compare an object of Kaitai with a record of numpy, field by field."""
    if expected.dtype.names:
        for field in expected.dtype.names:
            value, inner = getattr(found, field), expected[field]
            if inner.ndim:
                inner = inner[: len(value)]
                if inner.dtype.names is None:
                    assert np.array_equal(value, inner, equal_nan=True), f"{name}.{field}"
                else:
                    for index, item in enumerate(value):
                        assert_same(item, inner[index], f"{name}.{field}[{index}]")
            else:
                assert_same(value, inner, f"{name}.{field}")
    else:
        assert found == expected.item(), name


def compare(kaitai, path):
    with DpReader(path) as reader:
        records = list(reader.records())
        assert reader.damage is None
        file = kaitai.from_file(str(path))
        assert [item.sequence for item in file.body.records] == [r.sequence for r in records]
        for item, record in zip(file.body.records, records, strict=True):
            assert item.kind == record.kind
            assert item.time_s == record.time_s
            if record.kind:
                assert_same(item.payload, reader.schema.decode(record.kind, record.payload))
            else:
                assert item.payload.outcome.encode() == record.payload
        file.close()
    return {record.kind for record in records}


def test_a_drive_of_this_machine_is_read(kaitai, tmp_path, record_quick_drive):
    settings = {
        "records": "display",
        "camera": {"cloud_width_px": 32, "cloud_height_px": 24},
        "goal": [-2.0, 0.0],
    }
    record_quick_drive(tmp_path / "drive.dp", settings)
    assert len(compare(kaitai, tmp_path / "drive.dp")) >= 18


def test_a_drive_of_a_big_endian_machine_is_read(kaitai, tmp_path):
    (tmp_path / "powerpc.dp").write_bytes(lzma.decompress((DATA / "powerpc.dp.xz").read_bytes()))
    assert len(compare(kaitai, tmp_path / "powerpc.dp")) >= 17


@pytest.mark.verify
def test_the_compiled_reader_is_what_the_compiler_makes_of_the_description(tmp_path):
    packages = ["kaitai-struct-compiler@0.11.0", "js-yaml@4"]
    subprocess.run(["npm", "install", "--silent", *packages], cwd=tmp_path, check=True)
    command = ["node", ROOT / ".ci/compile_ksy.js", KSY, tmp_path / "enav_dp.py"]
    subprocess.run(command, cwd=tmp_path, check=True)
    assert (tmp_path / "enav_dp.py").read_text() == COMPILED.read_text(), "run: make kaitai"
