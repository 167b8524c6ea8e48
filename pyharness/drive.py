# SPDX-License-Identifier: Apache-2.0
"""One drive from a scenario: world, planner and executive together."""

from pyharness.command_server import CommandServer
from pyharness.dp import native_schema
from pyharness.executive import Executive
from pyharness.faults import SafetyWatch
from pyharness.live import LiveDrive
from pyharness.navlib import Zones
from pyharness.planner import Planner
from pyharness.records import KIND_END, Outcome, RecordStream, Sink, end_payload
from pyharness.scenario import (
    Scenario,
    directed_arcs,
    drive_info,
    is_on_terrain,
    navlib_params,
    zones_request,
)
from pyharness.session import RecordFeed, Session
from pyharness.thinker import Thinker
from sim.random_streams import rng_for
from sim.terrain import Terrain
from sim.vehicle import Vehicle
from sim.world import World, off_map_reason, true_limit_violation


def drive(
    scenario: Scenario,
    terrain: Terrain,
    planner_class: type[Planner],
    stream: RecordStream,
    server: CommandServer | None = None,
) -> Outcome:
    """Run one drive of a resolved scenario; everything about it goes into the stream.

    With a server its clients see the stream and control the drive.
    """
    vehicle = scenario.vehicle
    assert isinstance(vehicle, Vehicle)
    info = drive_info(scenario)
    if server is not None:
        stream.subscribers.append(RecordFeed(server, native_schema(), info).take)
    world = World(
        terrain,
        vehicle,
        scenario.camera,
        scenario.noise,
        scenario.slip,
        (info.start_north_m, info.start_east_m, info.start_yaw_rad),
        scenario.seed,
    )
    zones = zones_request(scenario)
    executive = Executive(
        world,
        Thinker(make_planner(scenario, planner_class, stream.publish), scenario.executive.compute),
        directed_arcs(scenario),
        info.waypoints if scenario.waypoints else (),
        scenario.executive,
        SafetyWatch(
            lambda truth: true_limit_violation(truth, vehicle),  # type: ignore[arg-type]
            Zones(zones).forbids,
            lambda truth: off_map_reason(truth, terrain),  # type: ignore[arg-type]
        ),
        stream.publish,
    )
    executive.start(zones, scenario.prior_map_radius_m)
    if server is not None:
        live = LiveDrive(executive, world, lambda *place: is_on_terrain(terrain, *place))
        Session(live, server).run()
    outcome = executive.finish()
    stream.publish(KIND_END, world.time_s, end_payload(outcome))
    return outcome


def make_planner(scenario: Scenario, planner_class: type[Planner], sink: Sink) -> Planner:
    """Start a planner with the parameters and the random stream of a resolved scenario."""
    rng = rng_for(scenario.seed, "planner")
    return planner_class(navlib_params(scenario), sink, scenario.planner_params, rng)
