# SPDX-License-Identifier: Apache-2.0
import itertools
import struct
import zlib

import numpy as np
import pytest

from pyharness.dp import Kind, native_schema
from pyharness.dp_file import DpReader, DpWriter
from pyharness.errors import RerunError
from pyharness.planners import load_planner
from pyharness.planners.enav import Enav
from pyharness.records import Record, RecordStream
from pyharness.rerun import compare, field_at, planner_of, rerun_into, unbroken
from pyharness.tests.byte_order import write_swapped


def circle(north_m, radius_m, kind="keep_out"):
    return {
        "kind": kind,
        "shape": "circle",
        "center_site_m": [north_m, 0.0],
        "radius_m": radius_m,
    }


def ground(**recipe):
    return {"size_m": 40.0, **recipe}


REFUSING = """
from pyharness.planners.enav import Enav
class Refusing(Enav):
    def _select_arc(self, request):
        request["mode"] = 99
        return super()._select_arc(request)
"""

DRIVES = {
    "unguarded": ({"mode": "unguarded"}, "goal_reached"),
    "guarded": ({"mode": "guarded", "terrain": ground()}, "goal_reached"),
    "guarded at a rock": ({"mode": "guarded", "terrain": ground(cfa=0.15)}, "no_path"),
    "avoid_koz": ({"mode": "avoid_koz"}, "goal_reached"),
    "avoid_all": ({"mode": "avoid_all"}, "goal_reached"),
    "rocks": ({"terrain": ground(cfa=0.10)}, "goal_reached"),
    "more rocks": ({"terrain": ground(cfa=0.15), "seed": 2}, "goal_reached"),
    "slope": ({"terrain": ground(slope_deg=20.0)}, "goal_reached"),
    "side slope": ({"terrain": ground(slope_deg=15.0, slope_azimuth_deg=90.0)}, "goal_reached"),
    "no noise": ({"slip.enabled": False}, "goal_reached"),
    "turn": ({"start": [-10.0, 0.0, 60.0]}, "goal_reached"),
    "waypoints": (
        {
            "goal": None,
            "waypoints": [{"goal_site_m": [-3, 3]}, {"goal_site_m": [1, 0], "mode": "guarded"}],
        },
        "goal_reached",
    ),
    "zone": ({"zones": [circle(-3.0, 1.0)]}, "goal_reached"),
    "keep-in zone": ({"zones": [circle(-5.0, 9.0, "keep_in")]}, "goal_reached"),
    "budget": ({"terrain": ground(cfa=0.1), "navlib": {"ace_budget_poses": 20}}, "goal_reached"),
    "all products": ({"records": "full"}, "goal_reached"),
    "gestalt": ({"planner": "gestalt"}, "goal_reached"),
    "rrtsharp": (
        {"planner": "rrtsharp", "seed": 3, "planner_params": {"vertices": 200.0}},
        "goal_reached",
    ),
    "no_path": (
        {
            "terrain": ground(slope_deg=10.0),
            "navlib": {"tilt_max_rad": 0.1},
            "executive.replans_max": 0,
        },
        "no_path",
    ),
    "zone in the way": ({"zones": [circle(-3.0, 1.0)], "mode": "unguarded"}, "no_path"),
    "kioz_violation": ({"zones": [circle(-10.0, 1.0)]}, "kioz_violation"),
    "time_limit": ({"executive.time_limit_s": 150.0}, "time_limit"),
    "left_map": (
        {"start": [17.0, 0.0, 0.0], "goal": [17.5, 10.0], "mode": "unguarded"},
        "left_map",
    ),
    "limit_violation": (
        {"terrain": ground(slope_deg=38.0), "mode": "unguarded"},
        "limit_violation",
    ),
    "planner_error": ({"planner": "refusing.py:Refusing"}, "planner_error"),
}


@pytest.mark.parametrize("name", DRIVES)
def test_a_drive_run_again_is_identical(name, tmp_path, monkeypatch, record_quick_drive):
    (tmp_path / "refusing.py").write_text(REFUSING)
    monkeypatch.chdir(tmp_path)
    overrides, outcome = DRIVES[name]
    path = tmp_path / "drive.dp"
    assert record_quick_drive(path, overrides).outcome == outcome
    with DpReader(path) as reader:
        records = list(reader.records())
        planner_class = planner_of(load_planner(reader.info.planner), reader.info)
        comparison = compare(records, reader.schema, planner_class)
    assert comparison.difference is None
    of_planner = [record for record in records if 0 < record.kind < Kind.TRUTH]
    assert comparison.record_count == len(of_planner)
    assert comparison.call_count == sum("_IN" in Kind(item.kind).name for item in of_planner)


def test_a_file_of_the_other_byte_order_run_again_is_identical(quick_drive, tmp_path):
    write_swapped(quick_drive, tmp_path / "swapped.dp")
    with DpReader(tmp_path / "swapped.dp") as reader:
        comparison = compare(reader.records(), reader.schema, Enav)
        assert reader.damage is None
    assert comparison.difference is None
    assert comparison.record_count > 50


def records_of(path):
    with DpReader(path) as reader:
        return list(reader.records()), reader.schema


def changed(record, offset, bit):
    data = bytearray(record.payload)
    data[offset] ^= bit
    return Record(record.kind, record.time_s, record.sequence, bytes(data))


@pytest.mark.faults
def test_a_flipped_input_with_a_right_checksum_is_found_by_the_first_output_that_differs(
    quick_drive,
):
    records, schema = records_of(quick_drive)
    index = next(i for i, item in enumerate(records) if item.kind == Kind.PROCESS_DISPARITY_IN)
    kind = Kind.PROCESS_DISPARITY_IN
    ahead_m = schema.decode(kind, records[index].payload)["points"]["x_m"]
    near = int(np.flatnonzero((ahead_m >= 4.0) & (ahead_m < 8.0))[0])
    x_offset = schema.kind_dtype(kind).fields["points"][1] + 12 * near
    # a bit of the exponent: four times as far, which is off the map
    records[index] = changed(records[index], x_offset + 3, 0x01)
    difference = compare(records, schema, Enav).difference
    assert difference is not None
    assert difference.sequence in (index + 1, index + 2)
    assert (difference.kind, difference.field) in (
        ("EVR", "args[1]"),
        ("PROCESS_DISPARITY_OUT", "merged_count"),
    )
    assert int(float(difference.recorded)) == int(float(difference.rerun)) + 1


@pytest.mark.parametrize(
    ("kind", "field"),
    [
        (Kind.SELECT_ARC_OUT, "arc.length_m"),
        (Kind.SELECT_ARC_OUT, "bounds.tilt_max_rad"),
        (Kind.EVALUATE_ARC_OUT, "bounds[2].rocker_max_rad"),
        (Kind.ANALYZE_TERRAIN_OUT, "infinite[3]"),
        (Kind.EVR, "args[1]"),
    ],
)
def test_a_changed_output_is_named_with_field_and_both_values(quick_drive, kind, field):
    records, schema = records_of(quick_drive)
    dtype = schema.kind_dtype(kind)
    offset = next(k for k in range(dtype.itemsize) if field_at(dtype, k)[0] == field)
    index = next(
        i
        for i, item in enumerate(records)
        if item.kind == kind and i > 30 and len(item.payload) > offset + 1
    )
    original = records[index]
    records[index] = changed(original, offset + 1, 0x10)
    difference = compare(records, schema, Enav).difference
    assert difference is not None
    assert (difference.sequence, difference.kind) == (index, Kind(kind).name)
    assert difference.field == field
    path, leaf, start = field_at(dtype, offset)
    assert path == field
    value = schema.decode(kind, original.payload).tobytes()[start : start + leaf.itemsize]
    assert difference.rerun == str(struct.unpack(f"={leaf.char}", value)[0])
    assert field in str(difference)


def test_an_output_that_is_missing_or_too_much_is_a_difference(quick_drive):
    records, schema = records_of(quick_drive)
    index = next(i for i, item in enumerate(records) if item.kind == Kind.EVR)
    without = records[:index] + records[index + 1 :]
    assert compare(without, schema, Enav).difference.field == "kind"
    twice = records[: index + 1] + records[index:]
    assert compare(twice, schema, Enav).difference is not None
    last = max(i for i, item in enumerate(records) if 0 < item.kind < Kind.TRUTH)
    without_last = records[:last] + records[last + 1 :]
    assert compare(without_last, schema, Enav).difference.recorded == "nothing"
    assert compare([*records[:-1], records[last]], schema, Enav).difference.rerun == "nothing"


def test_records_that_end_within_a_call_are_no_difference(quick_drive):
    records, schema = records_of(quick_drive)
    for end in range(0, len(records) - 1, 29):
        assert compare(records[:end], schema, Enav).difference is None


def test_nothing_behind_a_gap_is_run_again(quick_drive):
    records, _ = records_of(quick_drive)
    assert list(unbroken(records[:20] + records[21:])) == records[:20]


def test_records_of_another_version_are_refused(quick_drive):
    records, schema = records_of(quick_drive)
    schema.enums.clear()
    assert compare(records[:3], schema, Enav).difference is None
    object.__setattr__(schema, "parameters", ("other", *schema.parameters[1:]))
    with pytest.raises(RerunError, match="Navlib had other parameters; readable"):
        compare(records, schema, Enav)


def test_inputs_without_parameters_are_refused(quick_drive):
    records, schema = records_of(quick_drive)
    with pytest.raises(RerunError, match="INIT_IN"):
        compare(records[3:], schema, Enav)


def test_a_run_with_products_added_keeps_everything_else(quick_drive):
    """The inputs alone are enough for the tree, the surface and the costmap of every cycle."""
    records, schema = records_of(quick_drive)
    again = []
    rerun_into(RecordStream([again.append]), records, schema, Enav, {"product_level": 2.0})
    added = {Kind.TREE, Kind.SURFACE, Kind.COSTMAP}
    assert added <= {record.kind for record in again}
    kept = [item for item in again if item.kind not in added and item.kind != Kind.INIT_IN]
    old = [item for item in records if item.kind != Kind.INIT_IN]
    assert [(item.kind, item.payload) for item in kept] == [
        (item.kind, item.payload) for item in old
    ]


def test_a_drive_of_a_planner_of_ones_own_is_run_again(fake_planner, quick_drive):
    inputs, schema = records_of(quick_drive)
    records = []
    rerun_into(RecordStream([records.append]), inputs, schema, fake_planner, {})
    assert compare(records, native_schema(), fake_planner).difference is None
    assert compare(records, native_schema(), Enav).difference is not None


def test_the_checksum_names_a_flipped_input(quick_drive, tmp_path):
    data = bytearray(quick_drive.read_bytes())
    records, _ = records_of(quick_drive)
    sizes = [32 + len(item.payload) + -len(item.payload) % 8 for item in records]
    starts = list(itertools.accumulate(sizes, initial=len(data) - sum(sizes)))
    index = next(i for i, item in enumerate(records) if item.kind == Kind.PROCESS_DISPARITY_IN)
    data[starts[index] + 5000] ^= 1
    bad = tmp_path / "bad.dp"
    bad.write_bytes(data)
    with DpReader(bad) as reader:
        comparison = compare(unbroken(reader.records()), reader.schema, Enav)
        assert comparison.difference is None
        assert reader.damage.offset == starts[index]
        named = f"the checksum of record {index}, PROCESS_DISPARITY_IN, does not match"
        assert reader.damage.reason.startswith(named)
    # the same with the checksum mended
    start, size = starts[index], len(records[index].payload)
    payload = bytes(data[start + 32 : start + 32 + size])
    data[start + 28 : start + 32] = struct.pack("=I", zlib.crc32(payload))
    bad.write_bytes(data)
    with DpReader(bad) as reader:
        list(reader.records())
        assert reader.damage is None


def test_a_writer_takes_what_a_run_again_gives(quick_drive, tmp_path):
    """A re-run of a drive written to a file is that drive, byte for byte."""
    with DpReader(quick_drive) as reader, DpWriter(tmp_path / "again.dp", reader.info) as writer:
        rerun_into(RecordStream([writer.write]), reader.records(), reader.schema, Enav, {})
    assert (tmp_path / "again.dp").read_bytes() == quick_drive.read_bytes()
