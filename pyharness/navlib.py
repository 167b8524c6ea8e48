# SPDX-License-Identifier: Apache-2.0
"""Navlib from Python: one context, its six calls, and what it sent meanwhile."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from pyharness.clib import ffi, lib
from pyharness.dp import Kind, Message, init_request, new_message
from pyharness.layout import dtype_of
from pyharness.status import Status, status_text


class NavlibError(RuntimeError):
    """Navlib refused a call that only a defect of its host can cause."""


class Navlib:
    """One context of the C library.

    The calls take and return the structs of the C interface; the answer's `status` says whether
    the call was refused. What Navlib sends goes to one buffer in the library: drain it after each
    call, before another context is used.
    """

    def __init__(self, params: Mapping[str, float], time_s: float = 0.0) -> None:
        """Start a context with a full set of parameters.

        Raises:
            NavlibError: The parameters are refused.
        """
        self._ctx = ffi.new("nav_ctx_t *")
        lib.nav_stub_clear()
        request = init_request(params, time_s)
        answer = self._call(lib.nav_init, "init", Kind.INIT_OUT, request)
        if answer["status"] != Status.OK:
            raise NavlibError(f"nav_init: {status_text(int(answer['status']))}")

    @property
    def context(self) -> Any:
        """The C context, to look at."""
        return self._ctx

    def set_kioz(self, request: Message) -> Message:
        """Replace the keep-in and keep-out zones."""
        return self._call(lib.nav_set_kioz, "set_kioz", Kind.SET_KIOZ_OUT, request)

    def process_disparity(self, request: Message) -> Message:
        """Merge a chunk of a point cloud."""
        return self._call(
            lib.nav_process_disparity, "process_disparity", Kind.PROCESS_DISPARITY_OUT, request
        )

    def analyze_terrain(self, request: Message) -> Message:
        """Recompute the costmap."""
        return self._call(
            lib.nav_analyze_terrain, "analyze_terrain", Kind.ANALYZE_TERRAIN_OUT, request
        )

    def select_arc(self, request: Message) -> Message:
        """Choose the next arc."""
        return self._call(lib.nav_select_arc, "select_arc", Kind.SELECT_ARC_OUT, request)

    def evaluate_arc(self, request: Message) -> Message:
        """Check one arc."""
        return self._call(lib.nav_evaluate_arc, "evaluate_arc", Kind.EVALUATE_ARC_OUT, request)

    def drain(self) -> Iterator[tuple[int, float, bytes]]:
        """Take what Navlib has sent since the last time: kind, time and payload, in order.

        Raises:
            NavlibError: The buffer was too small for it.
        """
        lost_count = int(lib.nav_stub_lost_count())
        data = bytes(ffi.buffer(lib.nav_stub_data(), lib.nav_stub_size()))
        lib.nav_stub_clear()
        if lost_count:
            raise NavlibError(f"{lost_count} data products did not fit the buffer")
        header = dtype_of("nav_stub_header_t")
        offset = 0
        while offset < len(data):
            entry = np.frombuffer(data, header, count=1, offset=offset)[0]
            start = offset + header.itemsize
            end = start + int(entry["size_bytes"])
            yield int(entry["kind"]), float(entry["time_s"]), data[start:end]
            offset = end + -end % 8

    def _call(self, function: Any, name: str, answer_kind: int, request: Message) -> Message:
        type_in = f"nav_{name}_in_t"
        if request.dtype != dtype_of(type_in):
            raise NavlibError(f"nav_{name} takes a {type_in}, got {request.dtype}")
        answer = new_message(answer_kind)
        function(
            self._ctx,
            ffi.from_buffer(f"{type_in} *", request),
            ffi.from_buffer(f"nav_{name}_out_t *", answer, require_writable=True),
        )
        return answer


class Zones:
    """Keep-in and keep-out zones as Navlib understands them, for checks of the true position."""

    def __init__(self, request: Message) -> None:
        """Take the zones of a checked SET_KIOZ_IN record."""
        self._kioz = ffi.new("nav_kioz_t *")
        source = ffi.from_buffer("nav_set_kioz_in_t *", request)
        lib.nav_kioz_set(self._kioz, source.zones, source.zone_count)

    def forbids(self, north_m: float, east_m: float) -> bool:
        """Whether a point lies in a keep-out zone, or outside every keep-in zone."""
        return bool(lib.nav_kioz_forbids(self._kioz, north_m, east_m, 0.0))


def zone_fault(zone: Message) -> str | None:
    """Ask Navlib whether a zone is usable; return what is wrong, or None."""
    status = lib.nav_kioz_check(ffi.from_buffer("nav_zone_t *", zone))
    return None if status == Status.OK else status_text(status)
