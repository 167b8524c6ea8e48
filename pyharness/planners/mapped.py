# SPDX-License-Identifier: Apache-2.0
"""Planners that read Navlib's maps and choose arcs in a way of their own."""

from abc import abstractmethod
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from pyharness.clib import ffi, lib
from pyharness.dp import Kind, Message, new_message
from pyharness.layout import dtype_of
from pyharness.planner import Planner
from pyharness.planners.arcs import Floats
from pyharness.planners.enav import Enav
from pyharness.planners.goodness import Heights
from pyharness.status import Mode, Reason, Status

OWN_CALLS = (Kind.SELECT_ARC_IN, Kind.EVALUATE_ARC_IN)


class MappedPlanner(Enav):
    """Leaves zones, images and terrain analysis to Navlib, and makes the two calls about arcs."""

    @abstractmethod
    def _select_arc(self, request: Message) -> Message: ...

    @abstractmethod
    def _evaluate_arc(self, request: Message) -> Message: ...

    def _recorded(
        self,
        kind_in: int,
        kind_out: int,
        request: Message,
        function: Callable[[Message], Message],
    ) -> Message:
        """Navlib records its calls, the base class the planner's own."""
        recorded = Planner._recorded if kind_in in OWN_CALLS else Enav._recorded
        return recorded(self, kind_in, kind_out, request, function)

    @property
    def _is_analyzed(self) -> bool:
        return bool(self._navlib.context.is_analyzed)

    def _heights(self) -> Heights:
        """Return the heightmap as of the last analysis, small gaps closed."""
        surface = _record("nav_surface_t", self._navlib.context.surface)
        side = int(lib.NAV_HEIGHTMAP_SIZE)
        z_m = surface["z_site_m"].reshape(side, side).astype(np.float64)
        z_m[np.abs(z_m) >= UNKNOWN_M] = np.nan
        origin = int(surface["origin_row"]), int(surface["origin_col"])
        return Heights(z_m, *origin, float(surface["cell_m"]))

    def _costmap(self) -> Message:
        """Return Navlib's costmap, cells and all."""
        return _record("nav_costmap_t", self._navlib.context.costmap)

    def _forbidden(self, points_m: Floats, margin_m: float) -> npt.NDArray[np.bool_]:
        """Tell for points [..., north and east] whether zones with the margin forbid them."""
        kioz = ffi.addressof(self._navlib.context, "kioz")
        if not kioz.zone_count:
            return np.zeros(points_m.shape[:-1], dtype=np.bool_)
        flags = [
            lib.nav_kioz_forbids(kioz, north_m, east_m, margin_m)
            for north_m, east_m in points_m.reshape(-1, 2).tolist()
        ]
        return np.array(flags, dtype=np.bool_).reshape(points_m.shape[:-1])


UNKNOWN_M = 1.0e9
"""NAV_SURFACE_UNKNOWN_M: heights of unknown cells."""


def _record(type_name: str, struct: object) -> Message:
    """Return the memory of a C struct as a record."""
    memory = ffi.buffer(ffi.addressof(struct))
    return np.frombuffer(memory, dtype=dtype_of(type_name)).reshape(())


def plans_round_terrain(mode: int) -> bool:
    """Whether paths of this mode lead round hazards."""
    return mode == int(Mode.AVOID_ALL)


def plans_round_zones(mode: int) -> bool:
    """Whether paths of this mode lead round zones."""
    return mode in {int(Mode.AVOID_KOZ), int(Mode.AVOID_ALL)}


def checks_terrain(mode: int) -> bool:
    """Whether what is driven in this mode must be safe ground; zones are checked in every mode."""
    return mode in {int(Mode.GUARDED), int(Mode.AVOID_ALL)}


def refusal(kind: int) -> Message:
    """Return the answer to a call that comes before the terrain has been analyzed."""
    answer = new_message(kind)
    answer["status"] = Status.ORDER
    return answer


def verdict(reasons: npt.NDArray[np.uint8], along: Floats) -> Message:
    """Return the answer of evaluate_arc from the reason at each pose, and where the poses lie."""
    answer = new_message(Kind.EVALUATE_ARC_OUT)
    count = len(reasons)
    failing = np.flatnonzero(reasons != Reason.NONE)
    index = int(failing[0]) if len(failing) else count
    answer["is_safe"] = index == count
    answer["failing_index"] = index
    answer["pose_count"] = count
    if index < count:
        answer["reason"] = reasons[index]
        answer["failing_at"] = along[index]
    return answer


def put_points(answer: Message, field: str, points_m: Floats) -> None:
    """Write points [n, north and east] into an array of a select_arc answer, as many as fit."""
    used = points_m[: len(answer[field])]
    answer[field]["x_m"][: len(used)] = used[:, 0]
    answer[field]["y_m"][: len(used)] = used[:, 1]
    answer[f"{field.removesuffix('s')}_count"] = len(used)
