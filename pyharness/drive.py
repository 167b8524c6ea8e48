# SPDX-License-Identifier: Apache-2.0
"""One drive from a scenario: world, planner and executive together."""

from pyharness.executive import Executive, SafetyWatch
from pyharness.navlib import Zones
from pyharness.planner import Planner
from pyharness.records import KIND_END, Outcome, RecordStream, Sink, end_payload
from pyharness.scenario import Scenario, drive_info, navlib_params, zones_request
from pyharness.thinker import Thinker
from sim.random_streams import rng_for
from sim.terrain import Terrain
from sim.vehicle import Vehicle
from sim.world import World, true_limit_violation


def drive(
    scenario: Scenario, terrain: Terrain, planner_class: type[Planner], stream: RecordStream
) -> Outcome:
    """Run one drive of a resolved scenario; everything about it goes into the stream."""
    vehicle = scenario.vehicle
    assert isinstance(vehicle, Vehicle)
    info = drive_info(scenario)
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
        lambda: world.image(scenario.executive.look_around_deg),
        Thinker(make_planner(scenario, planner_class, stream.publish), scenario.executive.compute),
        info.waypoints,
        scenario.executive,
        SafetyWatch(
            lambda truth: true_limit_violation(truth, vehicle),  # type: ignore[arg-type]
            Zones(zones).forbids,
        ),
        stream.publish,
    )
    outcome = executive.run(zones)
    stream.publish(KIND_END, world.time_s, end_payload(outcome))
    return outcome


def make_planner(scenario: Scenario, planner_class: type[Planner], sink: Sink) -> Planner:
    """Start a planner with the parameters and the random stream of a resolved scenario."""
    rng = rng_for(scenario.seed, "planner")
    return planner_class(navlib_params(scenario), sink, scenario.planner_params, rng)
