# SPDX-License-Identifier: Apache-2.0
"""What ends a drive before its goal: the faults, and the watch over the true rover."""

from collections.abc import Callable
from dataclasses import dataclass

from pyharness.protocols import Truth
from pyharness.status import HostEvr

FAULT_PREFIX = "FAULT_"
FAULTS = tuple(
    event.name.removeprefix(FAULT_PREFIX).lower()
    for event in HostEvr
    if event.name.startswith(FAULT_PREFIX)
)


class FaultError(Exception):
    """Ends a drive.

    Attributes:
        name: One of `FAULTS`.
        detail: What happened, for people.
        values: Arguments of the event report of that fault.
    """

    def __init__(self, name: str, detail: str, *values: float) -> None:
        """Take a fault's name, the details and the arguments of its event report."""
        super().__init__(name, detail)
        self.name = name
        self.detail = detail
        self.values = values

    @property
    def event(self) -> int:
        """The event report of this fault."""
        return int(HostEvr[FAULT_PREFIX + self.name.upper()])


@dataclass(frozen=True, slots=True)
class SafetyWatch:
    """Looks at the true rover as operators would, who call some states a fault.

    Attributes:
        limit_violation: Names the limit a truth violates, with value and limit; None if it is well.
        is_forbidden: Whether a true position, north and east, violates a zone.
        off_map_reason: Says why a truth has no pose.
    """

    limit_violation: Callable[[Truth], str | None]
    is_forbidden: Callable[[float, float], bool]
    off_map_reason: Callable[[Truth], str]

    def check(self, truth: Truth, verdict: str) -> None:
        """Raise the fault that a true state is, with what the planner last thought of the arc."""
        place = f"true position north {truth.x_m:.2f} m, east {truth.y_m:.2f} m"
        position = (truth.x_m, truth.y_m)
        if not truth.on_map:
            raise FaultError("left_map", f"{self.off_map_reason(truth)}; {place}", *position)
        violation = self.limit_violation(truth)
        if violation is not None:
            raise FaultError("limit_violation", f"{violation}; {place}; {verdict}", *position)
        if self.is_forbidden(*position):
            raise FaultError("kioz_violation", f"{place}; {verdict}", *position)
