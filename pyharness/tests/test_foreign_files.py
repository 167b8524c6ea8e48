# SPDX-License-Identifier: Apache-2.0
"""Files that were not written by this program on this machine: C hosts, PowerPC, old versions."""

import json
import lzma
import subprocess
from dataclasses import asdict
from pathlib import Path

import pytest

from pyharness import metrics
from pyharness.arc_check import check_on_drive
from pyharness.clib import ffi, lib
from pyharness.dp import to_native
from pyharness.dp_file import DpReader
from pyharness.messages import Arc
from pyharness.planners.enav import Enav
from pyharness.replay import read_history
from pyharness.rerun import compare

ROOT = Path(__file__).parents[2]
DATA = Path(__file__).with_name("data")
POWERPC = DATA / "powerpc.dp.xz"
OLD = {1: DATA / "drive_v1.dp.xz"}  # by format version; a file stays when a new one joins it


def unpacked(packed, folder):
    path = folder / packed.stem
    path.write_bytes(lzma.decompress(packed.read_bytes()))
    return path


# ------------------------------------------------------------------ the writer in C


def test_the_writer_in_c_writes_the_same_bytes(quick_drive, tmp_path):
    with DpReader(quick_drive) as reader:
        drive = json.dumps(asdict(reader.info), separators=(",", ":"), ensure_ascii=False)
        file = ffi.new("nav_dp_file_t *")
        assert lib.nav_dp_file_open(file, str(tmp_path / "c.dp").encode(), drive.encode())
        for record in reader.records():
            payload = ffi.from_buffer(record.payload)
            assert lib.nav_dp_file_write(
                file, record.kind, record.time_s, payload, len(record.payload)
            )
        assert lib.nav_dp_file_close(file)
    assert (tmp_path / "c.dp").read_bytes() == quick_drive.read_bytes()


# ------------------------------------------------------------------ a big-endian 32-bit machine


def test_a_file_of_a_powerpc_is_read_like_one_of_this_machine(tmp_path):
    path = unpacked(POWERPC, tmp_path)
    history, damage = read_history(path)
    assert damage is None
    assert history.schema.byte_order == "big"
    summary = metrics.summarize(history)
    assert summary["outcome"] == "goal_reached"
    assert summary["distance_driven_m"] == pytest.approx(4.75)
    assert summary["planning_cycles"] == 7
    assert len(metrics.cycles_csv(history).splitlines()) == 8
    assert "arc" in metrics.evr_log(history)
    assert history.params["belly_height_m"] == 0.6


def test_a_file_of_a_powerpc_run_again_is_identical(tmp_path):
    """Navlib answers here as it did there; when its answers were changed: `make golden`."""
    with DpReader(unpacked(POWERPC, tmp_path)) as reader:
        comparison = compare(reader.records(), reader.schema, Enav)
    assert comparison.difference is None, f"{comparison.difference} (if intended: make golden)"
    assert comparison.call_count == 30


def test_an_arc_is_evaluated_on_a_drive_of_a_powerpc(tmp_path):
    path = unpacked(POWERPC, tmp_path)
    assert check_on_drive(path, Arc(1.0, 0.0), place=(0.0, 0.0, 0.0)).is_safe
    assert not check_on_drive(path, Arc(3.0, 0.0), place=(0.0, 0.0, 0.0)).is_safe


@pytest.mark.verify
def test_powerpc_and_this_machine_record_the_same_drive(tmp_path):
    """Built and run now: all records have the same bits, and are those of the golden file."""
    foreign, native = tmp_path / "powerpc.dp", tmp_path / "native.dp"
    subprocess.run([ROOT / ".ci/powerpc_drive", foreign], check=True)
    sources = [*(ROOT / "navlib_c/src").glob("*.c"), *(ROOT / "navlib_c/stubs").glob("*.c")]
    folders = [f"-I{ROOT / 'navlib_c' / name}" for name in ("include", "stubs")]
    program = tmp_path / "record_drive"
    main = ROOT / "navlib_c/tests/record_drive.c"
    flags = ["-std=c11", "-O2", "-ffp-contract=off"]
    subprocess.run(["gcc", *flags, *folders, *sources, main, "-lm", "-o", program], check=True)
    subprocess.run([program, native], check=True)
    with DpReader(foreign) as there, DpReader(native) as here:
        pairs = list(zip(there.records(), here.records(), strict=True))
        assert there.damage is None
        assert here.damage is None
        assert (there.schema.byte_order, here.schema.byte_order) == ("big", "little")
        for one, two in pairs:
            payload = to_native(there.schema, one.kind, one.payload) if one.kind else one.payload
            assert (one.kind, one.time_s, payload) == (two.kind, two.time_s, two.payload)
    assert foreign.read_bytes() == lzma.decompress(POWERPC.read_bytes())


# ------------------------------------------------------------------ old versions


@pytest.mark.parametrize("version", OLD)
def test_a_file_of_every_version_can_be_read(tmp_path, version):
    path = unpacked(OLD[version], tmp_path)
    history, damage = read_history(path)
    assert damage is None
    expected = json.loads(OLD[version].with_suffix("").with_suffix(".json").read_text())
    summary = metrics.summarize(history)
    assert {name: summary[name] for name in expected} == expected
    assert metrics.truth_csv(history).count("\n") == len(history.truth) + 1
    assert len(history.schema.parameters) == len(set(history.schema.parameters)) > 50
