# SPDX-License-Identifier: Apache-2.0
"""Navlib's parameters: the C table, defaults and checks."""

import functools
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from pyharness.clib import ffi, lib
from pyharness.status import Status, status_text


@dataclass(frozen=True, slots=True)
class ParamDefinition:
    """One row of the C table."""

    name: str
    default: float
    minimum: float
    maximum: float
    unit: str
    doc: str

    def fault(self, value: float) -> str | None:
        """Return what is wrong with a value, or None."""
        if self.minimum <= value <= self.maximum:
            return None
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"expected {self.minimum:g} to {self.maximum:g}{unit}, got {value:g}"


@functools.cache
def param_table() -> Mapping[str, ParamDefinition]:
    """Return the definitions by name, in the order of the C struct."""
    rows = (
        ParamDefinition(
            name=ffi.string(row.name).decode(),
            default=float(row.default_value),
            minimum=float(row.min_value),
            maximum=float(row.max_value),
            unit=ffi.string(row.unit).decode(),
            doc=ffi.string(row.doc).decode(),
        )
        for row in lib.nav_param_defs
    )
    return {row.name: row for row in rows}


def param_values(overrides: Mapping[str, float]) -> dict[str, float]:
    """Return all parameters in the order of the C struct: the defaults, replaced where given."""
    return {name: overrides.get(name, row.default) for name, row in param_table().items()}


def params_fault(values: Mapping[str, float]) -> str | None:
    """Ask Navlib whether a full set of parameters is usable; return what is wrong, or None."""
    numbers = np.array([values[name] for name in param_table()], dtype=np.float64)
    index = ffi.new("uint32_t *")
    status = lib.nav_params_check(ffi.from_buffer("nav_params_t *", numbers), index)
    if status == Status.OK:
        return None
    row = list(param_table().values())[index[0]]
    return f"{row.name}: {row.fault(values[row.name]) or status_text(status)}"
