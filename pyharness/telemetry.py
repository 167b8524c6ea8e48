# SPDX-License-Identifier: Apache-2.0
"""The executive's own records: truth, estimate, timeline, events."""

from dataclasses import dataclass

from pyharness import messages
from pyharness.dp import Kind, Message, new_message, used_bytes
from pyharness.evr import evr_table
from pyharness.messages import Arc, Uncertainty
from pyharness.protocols import Truth, World
from pyharness.records import Sink
from pyharness.status import Severity

NO_ARC = Arc(0.0, 0.0)


@dataclass(slots=True)
class Telemetry:
    """Sends records at the world's time; `cycle` is the planning cycle they belong to."""

    world: World
    sink: Sink
    cycle: int = 0

    def truth(self, truth: Truth) -> None:
        """Send the ground truth of this tick."""
        self._send(Kind.TRUTH, messages.truth_record(self.world.time_s, truth))

    def estimate(self, uncertainty: Uncertainty) -> None:
        """Send what the rover believes now."""
        record = messages.estimate_record(self.world.time_s, self.world.estimate, uncertainty)
        self._send(Kind.ESTIMATE, record)

    def activity(self, activity: int, start_s: float, end_s: float, arc: Arc = NO_ARC) -> None:
        """Send one activity of the timeline."""
        record = messages.timeline_record(activity, start_s, end_s, self.cycle, arc)
        self._send(Kind.TIMELINE, record)

    def event(self, event: int, *values: float) -> None:
        """Send an event report."""
        row = evr_table()[event]
        if len(values) != row.arg_count:
            raise ValueError(f"{row.name}: expected {row.arg_count} arguments, got {len(values)}")
        record = new_message(Kind.HOST_EVR)
        record["time_s"] = self.world.time_s
        record["id"] = event
        record["severity"] = Severity[row.severity]
        record["arg_count"] = len(values)
        record["args"][: len(values)] = values
        self._send(Kind.HOST_EVR, record)

    def _send(self, kind: int, record: Message) -> None:
        self.sink(kind, self.world.time_s, used_bytes(kind, record))
