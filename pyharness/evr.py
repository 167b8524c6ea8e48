# SPDX-License-Identifier: Apache-2.0
"""The tables of event reports, Navlib's and the executive's, and the text of one."""

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pyharness.clib import ffi, lib
from pyharness.status import Severity


@dataclass(frozen=True, slots=True)
class EvrDefinition:
    """One row of the C table."""

    evr_id: int
    name: str
    severity: str
    arg_count: int
    text: str
    cause: str
    args: str


@functools.cache
def evr_table() -> Mapping[int, EvrDefinition]:
    """Return the definitions by id, in the order of the C tables."""
    rows = (
        EvrDefinition(
            evr_id=int(row.id),
            name=ffi.string(row.name).decode(),
            severity=Severity(int(row.severity)).name,
            arg_count=int(row.arg_count),
            text=ffi.string(row.text).decode(),
            cause=ffi.string(row.cause).decode(),
            args=ffi.string(row.args).decode(),
        )
        for row in (*lib.nav_evr_defs, *lib.nav_host_evr_defs)
    )
    return {row.evr_id: row for row in rows}


def evr_text(evr_id: int, args: Sequence[float]) -> str:
    """Return the report's text with its arguments filled in; an unknown id is shown as it is."""
    definition = evr_table().get(evr_id)
    if definition is None:
        return f"unknown event with arguments {list(args)}"
    shown = (f"{value:.6g}" for value in args[: definition.arg_count])
    return definition.text.format(*shown)


def evr_line(evr: Any) -> str:
    """Return one line of a log for a decoded EVR record."""
    evr_id = int(evr["id"])
    definition = evr_table().get(evr_id)
    severity, name = (definition.severity, definition.name) if definition else ("UNKNOWN", "?")
    args = [float(value) for value in evr["args"]]
    return f"{float(evr['time_s']):12.3f}  {severity:<13}  {name:<21}  {evr_text(evr_id, args)}"
