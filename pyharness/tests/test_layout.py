# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from pyharness.clib import ffi, lib
from pyharness.layout import dtype_of, implicit_padding


def record_types():
    """Return the C type of every record, as the compiled tables name them."""
    tables = [*lib.nav_record_defs, *lib.nav_host_record_defs]
    return sorted({ffi.string(row.type).decode() for row in tables})


def test_every_data_product_has_a_record():
    tables = [*lib.nav_dp_defs, *lib.nav_host_dp_defs]
    assert {ffi.string(row.type).decode() for row in tables} <= set(record_types())


@pytest.mark.parametrize("type_name", record_types())
def test_every_record_has_the_size_that_the_compiler_gave_it(type_name):
    tables = [*lib.nav_record_defs, *lib.nav_host_record_defs]
    sizes = {ffi.string(row.type).decode(): row.size for row in tables}
    assert dtype_of(type_name).itemsize == ffi.sizeof(type_name) == sizes[type_name]


@pytest.mark.parametrize("type_name", record_types())
def test_no_record_has_bytes_without_a_name(type_name):
    assert implicit_padding(dtype_of(type_name)) == 0


@pytest.mark.parametrize("type_name", record_types())
def test_every_field_lies_where_the_compiler_put_it(type_name):
    dtype = dtype_of(type_name)
    assert dtype.names is not None
    for name in dtype.names:
        assert dtype.fields[name][1] == ffi.offsetof(type_name, name)


def test_numbers_keep_their_kind_and_size():
    kinds = {
        "bool": "?",
        "char": "S1",
        "double": "f8",
        "float": "f4",
        "int32_t": "i4",
        "int8_t": "i1",
        "uint16_t": "u2",
        "uint64_t": "u8",
    }
    assert {name: dtype_of(name) for name in kinds} == {
        name: np.dtype(kind) for name, kind in kinds.items()
    }


def test_an_enum_is_an_integer_of_its_size():
    dtype = dtype_of("nav_status_t")
    assert dtype.kind in "iu"
    assert dtype.itemsize == ffi.sizeof("nav_status_t")


def test_an_array_keeps_its_shape():
    assert dtype_of("float[2][3]").shape == (2, 3)


def test_a_pointer_has_no_place_in_a_record():
    with pytest.raises(TypeError, match="no place in a data product"):
        dtype_of("double *")


def test_c_memory_is_seen_and_written_without_a_copy():
    pose = ffi.new("nav_pose_t *")
    view = np.frombuffer(ffi.buffer(pose), dtype_of("nav_pose_t"))[0:1]
    pose.yaw_rad = 0.25
    assert view["yaw_rad"][0] == 0.25
    view["yaw_rad"][0] = 0.5
    assert pose.yaw_rad == 0.5


def test_numpy_memory_is_read_by_c_without_a_copy():
    poses = np.zeros(3, dtype_of("nav_pose_t"))
    poses["x_site_m"] = [1.0, 2.0, 3.0]
    seen = ffi.from_buffer("nav_pose_t[]", poses)
    assert [seen[index].x_site_m for index in range(3)] == [1.0, 2.0, 3.0]


def test_implicit_padding_is_found_at_any_depth():
    inner = np.dtype({"names": ["a", "b"], "formats": ["u1", "f8"], "offsets": [0, 8]})
    outer = np.dtype([("many", inner, (2, 3)), ("tail", "u4")])
    assert implicit_padding(np.dtype("f8")) == 0
    assert implicit_padding(inner) == 7
    assert implicit_padding(outer) == 6 * 7
