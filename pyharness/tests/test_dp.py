# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest

from pyharness.dp import (
    FieldDefinition,
    Kind,
    RecordDefinition,
    Schema,
    layout_difference,
    native_schema,
    new_message,
    used_bytes,
)
from pyharness.layout import dtype_of


@pytest.mark.parametrize("kind", list(Kind), ids=lambda kind: kind.name)
def test_the_described_layout_is_the_compiled_one(kind):
    schema = native_schema()
    assert schema.kind_dtype(kind) == dtype_of(schema.kinds[kind].type)


def test_an_unused_end_is_cut_off_and_comes_back_as_zero():
    cloud = new_message(Kind.PROCESS_DISPARITY_IN)
    cloud["point_count"] = 2
    cloud["points"]["x_m"][:2] = [1.0, 2.0]
    data = used_bytes(Kind.PROCESS_DISPARITY_IN, cloud)
    assert len(data) == cloud.dtype.fields["points"][1] + 2 * 12
    assert native_schema().decode(Kind.PROCESS_DISPARITY_IN, data).tobytes() == cloud.tobytes()


@pytest.mark.parametrize("kind", [Kind.EVR, Kind.INIT_IN, Kind.TRUTH, Kind.COSTMAP])
def test_records_without_a_count_of_records_are_whole(kind):
    record = new_message(kind)
    assert len(used_bytes(kind, record)) == record.nbytes


def test_a_payload_longer_than_its_record_is_refused():
    with pytest.raises(ValueError, match="expected at most"):
        native_schema().decode(Kind.ESTIMATE, bytes(10_000))


def test_the_other_byte_order_gives_the_same_numbers():
    native = native_schema()
    other = "big" if native.byte_order == "little" else "little"
    swapped = Schema(other, native.records, native.kinds)
    record = new_message(Kind.ESTIMATE)
    record["pose"]["x_site_m"] = 12.5
    data = record.astype(swapped.kind_dtype(Kind.ESTIMATE)).tobytes()
    assert data != record.tobytes()
    assert float(swapped.decode(Kind.ESTIMATE, data)["pose"]["x_site_m"]) == 12.5


def test_a_schema_that_refers_to_itself_or_to_nothing_is_refused():
    native = native_schema()
    records = dict(native.records)
    pose = records["nav_pose_t"]
    loop = type(pose)(pose.type, pose.size_bytes, (records["nav_host_estimate_t"].fields[1],))
    records["nav_pose_t"] = loop
    with pytest.raises(ValueError, match="unknown type 'nav_pose_t'"):
        Schema("little", records, native.kinds).dtype("nav_pose_t")
    del records["nav_pose_t"]
    with pytest.raises(ValueError, match="unknown type 'nav_pose_t'"):
        Schema("little", records, native.kinds).dtype("nav_host_estimate_t")


def test_a_new_message_is_all_zero():
    assert not np.any(np.frombuffer(new_message(Kind.SELECT_ARC_IN).tobytes(), np.uint8))


def test_a_schema_that_would_fill_the_memory_is_refused():
    row = RecordDefinition("big_t", 1 << 30, (FieldDefinition("x", "uint8_t", 1 << 30, 0, "", ""),))
    with pytest.raises(ValueError, match="expected at most 16777216"):
        Schema("little", {"big_t": row}, {}).dtype("big_t")


def test_a_schema_of_many_levels_is_read_at_once():
    rows = {"t0": RecordDefinition("t0", 1, (FieldDefinition("x", "uint8_t", 1, 0, "", ""),))}
    for level in range(1, 25):
        inner, size = f"t{level - 1}", 2**level
        fields = tuple(
            FieldDefinition(name, inner, 1, offset, "", "")
            for name, offset in (("a", 0), ("b", size // 2))
        )
        rows[f"t{level}"] = RecordDefinition(f"t{level}", size, fields)
    assert Schema("little", rows, {}).dtype("t24").itemsize == 2**24


def test_layouts_that_differ_are_named():
    native = native_schema()
    assert layout_difference(native) is None
    assert layout_difference(replace(native, parameters=())) == "Navlib had other parameters"
    kinds = {**native.kinds, 11: replace(native.kinds[11], name="OTHER")}
    assert (
        layout_difference(replace(native, kinds=kinds, _dtypes={}))
        == "EVALUATE_ARC_IN has another layout"
    )
    pose = native.records["nav_pose_t"]
    renamed = replace(pose, fields=(replace(pose.fields[0], name="x_m"), *pose.fields[1:]))
    changed = replace(native, records={**native.records, pose.type: renamed}, _dtypes={})
    assert layout_difference(changed) == "PROCESS_DISPARITY_IN has another layout"
