# SPDX-License-Identifier: Apache-2.0
"""The enumerations of the C headers as Python enumerations: asked of C, never typed again."""

from enum import IntEnum
from typing import Any

from pyharness.clib import ffi, lib


def _enumeration(name: str, type_name: str, prefix: str, sentinel: str = "") -> Any:
    """Make an IntEnum of a C enum; members lose the prefix, the counting sentinel is left out."""
    values = ffi.typeof(type_name).relements
    names = sorted((value, key) for key, value in values.items() if key != sentinel)
    members = {key.removeprefix(prefix): value for value, key in names}
    return IntEnum(name, members)


Status = _enumeration("Status", "nav_status_t", "NAV_", "NAV_STATUS_COUNT")
Reason = _enumeration("Reason", "nav_reason_t", "NAV_REASON_", "NAV_REASON_COUNT")
Mode = _enumeration("Mode", "nav_mode_t", "NAV_MODE_", "NAV_MODE_COUNT")
Activity = _enumeration("Activity", "nav_host_activity_t", "NAV_HOST_", "NAV_HOST_ACTIVITY_COUNT")
ZoneKind = _enumeration("ZoneKind", "nav_zone_kind_t", "NAV_ZONE_")
ZoneShape = _enumeration("ZoneShape", "nav_zone_shape_t", "NAV_ZONE_")
HostEvr = _enumeration("HostEvr", "nav_host_evr_id_t", "NAV_HOST_EVR_", "NAV_HOST_EVR_COUNT")
Severity = _enumeration("Severity", "nav_evr_severity_t", "NAV_EVR_")


def status_text(status: int) -> str:
    """Return what a status means."""
    return str(ffi.string(lib.nav_status_text(status)).decode())


def reason_text(reason: int) -> str:
    """Return what a rejection reason means."""
    return str(ffi.string(lib.nav_reason_text(reason)).decode())
