# SPDX-License-Identifier: Apache-2.0
"""The one seam to the compiled kernels: nothing else imports `_simkernels`."""

from typing import Any

import _simkernels
import numpy as np
import numpy.typing as npt

ffi: Any = _simkernels.ffi
lib: Any = _simkernels.lib


def dtype_of(struct_name: str) -> np.dtype[np.void]:
    """NumPy layout of a C struct of doubles, int32 and arrays of doubles, asked of the compiler."""
    names: list[str] = []
    formats: list[Any] = []
    offsets: list[int] = []
    for name, field in ffi.typeof(struct_name).fields:
        shape: list[int] = []
        item = field.type
        while item.kind == "array":
            shape.append(item.length)
            item = item.item
        names.append(name)
        formats.append((np.dtype({"double": "f8", "int32_t": "i4"}[item.cname]), tuple(shape)))
        offsets.append(field.offset)
    size = ffi.sizeof(struct_name)
    return np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": size})


def pointer(array: npt.NDArray[Any], ctype: str) -> Any:
    """C pointer to a contiguous array; the array must outlive the call."""
    if not array.flags["C_CONTIGUOUS"]:
        raise ValueError(f"array for {ctype} is not contiguous")
    item_size = ffi.sizeof(ffi.typeof(ctype).item)
    if array.itemsize != item_size:
        raise ValueError(f"array for {ctype} has items of {array.itemsize} bytes, not {item_size}")
    return ffi.cast(ctype, array.ctypes.data)
