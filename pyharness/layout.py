# SPDX-License-Identifier: Apache-2.0
"""NumPy dtypes from the compiled layouts of C types: none is ever typed by hand."""

import functools
from typing import Any

import numpy as np

from pyharness.clib import ffi


@functools.cache
def dtype_of(type_name: str) -> np.dtype[Any]:
    """Return the dtype with the layout that the compiler gave to a C type.

    `type_name` is a C type as written in C, e.g. `nav_pose_t` or `float[3]`.
    """
    return _dtype(ffi.typeof(type_name))


def implicit_padding(dtype: np.dtype[Any]) -> int:
    """Count the bytes of a dtype that belong to no field, at any depth.

    A record that has none is written and compared byte for byte without stray memory contents.
    """
    if dtype.subdtype is not None:
        item, shape = dtype.subdtype
        return int(np.prod(shape)) * implicit_padding(item)
    if dtype.fields is None:
        return 0
    fields = [field[0] for field in dtype.fields.values()]
    own = dtype.itemsize - sum(field.itemsize for field in fields)
    return own + sum(implicit_padding(field) for field in fields)


def _dtype(ctype: Any) -> np.dtype[Any]:
    if ctype.kind == "struct":
        fields = ctype.fields
        return np.dtype(
            {
                "names": [name for name, _ in fields],
                "formats": [_dtype(field.type) for _, field in fields],
                "offsets": [field.offset for _, field in fields],
                "itemsize": ffi.sizeof(ctype),
            }
        )
    if ctype.kind == "array":
        shape = []
        while ctype.kind == "array":
            shape.append(ctype.length)
            ctype = ctype.item
        return np.dtype((_dtype(ctype), tuple(shape)))
    if ctype.kind == "enum":
        sign = "i" if min(ctype.elements) < 0 else "u"
        return np.dtype(f"{sign}{ffi.sizeof(ctype)}")
    if ctype.kind == "primitive":
        return _primitive(ctype)
    raise TypeError(f"{ctype.cname}: a {ctype.kind} has no place in a data product")


def _primitive(ctype: Any) -> np.dtype[Any]:
    size = ffi.sizeof(ctype)
    if ctype.cname == "_Bool":
        return np.dtype(np.bool_)
    if ctype.cname == "char":
        return np.dtype("S1")
    if ctype.cname in ("float", "double"):
        return np.dtype(f"f{size}")
    sign = "i" if int(ffi.cast(ctype, -1)) < 0 else "u"
    return np.dtype(f"{sign}{size}")
