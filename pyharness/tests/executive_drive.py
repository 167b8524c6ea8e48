# SPDX-License-Identifier: Apache-2.0
"""One drive of an executive against a world and a planner that do as they are told."""

from pyharness.dp import Kind, native_schema, new_message
from pyharness.executive import Executive
from pyharness.executive_config import ExecutiveConfig
from pyharness.faults import SafetyWatch
from pyharness.params import param_values
from pyharness.records import RecordStream, Waypoint
from pyharness.status import HostEvr
from pyharness.thinker import Thinker

ARC_S = 20.0  # 1 m in the fake world
FAR = Waypoint(15.0, 0.0, 1.0, "avoid_all")


class Drive:
    """One drive with everything about it at hand."""

    def __init__(
        self, world, planner_class, waypoints=(FAR,), arcs=(), safety=None, prior_m=0.0, **settings
    ):
        self.records = []
        stream = RecordStream([self.records.append])
        self.world = world
        self.planner = planner_class(param_values({}), stream.publish)
        self.config = ExecutiveConfig(**settings)
        self.prior_m = prior_m
        self.executive = Executive(
            world,
            Thinker(self.planner, self.config.compute),
            arcs,
            waypoints,
            self.config,
            safety or SafetyWatch(lambda _: None, lambda *_: False, lambda _: "gone"),
            stream.publish,
        )

    def run(self):
        self.executive.start(new_message(Kind.SET_KIOZ_IN), self.prior_m)
        return self.executive.finish()

    @property
    def outcome(self):
        return self.executive.outcome

    def events(self):
        schema = native_schema()
        items = [item for item in self.records if item.kind == Kind.HOST_EVR]
        return [HostEvr(int(schema.decode(item.kind, item.payload)["id"])) for item in items]

    def calls(self, name):
        return [
            (time_s, request) for called, time_s, request in self.planner.calls if called == name
        ]

    def timeline(self, activity):
        schema = native_schema()
        items = (
            schema.decode(item.kind, item.payload)
            for item in self.records
            if item.kind == Kind.TIMELINE
        )
        return [
            (float(item["start_s"]), float(item["end_s"]), int(item["cycle"]))
            for item in items
            if item["activity"] == activity
        ]
