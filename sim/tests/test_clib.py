# SPDX-License-Identifier: Apache-2.0
"""The seam to C."""

import numpy as np
import pytest

from sim.clib import dtype_of, ffi, pointer


def test_layouts_come_from_the_compiler() -> None:
    dtype = dtype_of("sim_settled_t")
    assert dtype.itemsize == ffi.sizeof("sim_settled_t")
    assert dtype["contact_site_m"].shape == (6, 3)
    assert dtype["converged"] == np.int32


def test_wrong_arrays_are_refused() -> None:
    with pytest.raises(ValueError, match="not contiguous"):
        pointer(np.zeros((4, 4))[:, ::2], "const double *")
    with pytest.raises(ValueError, match="items of 4 bytes"):
        pointer(np.zeros(4, np.float32), "const double *")
