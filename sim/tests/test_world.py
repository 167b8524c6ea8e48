# SPDX-License-Identifier: Apache-2.0
"""HDSim as a whole: time, motion, faults, repeatability."""

import dataclasses
import math

import numpy as np
import pytest

from sim.camera import CameraConfig
from sim.generate import TerrainRecipe, generate
from sim.kinematics import Arc, pose_along
from sim.localization import NoiseConfig
from sim.settle import Settler
from sim.slip import SlipConfig
from sim.terrain import CLASS_NAMES, Terrain, centred
from sim.tests.conftest import terrain_of
from sim.vehicle import Vehicle, load_vehicle
from sim.world import TruthState, World, off_map_reason, true_limit_violation

CAMERA = CameraConfig(cloud_width_px=40, cloud_height_px=30)
NO_SLIP = SlipConfig(enabled=False)
NO_NOISE = NoiseConfig(enabled=False)


def finish(world: World) -> TruthState:
    while not world.arc_done:
        world.step()
    return world.truth


@pytest.mark.parametrize(
    "arc", [(1.0, 0.0), (1.0, 0.4), (2.0, -1.0), (0.0, math.pi / 2), (-1.0, 0.2), (1e-6, 0.0)]
)
def test_without_slip_the_end_is_exact(
    flat: Terrain, vehicle: Vehicle, arc: tuple[float, float]
) -> None:
    start = (1.0, -2.0, 0.3)
    world = World(flat, vehicle, CAMERA, NO_NOISE, NO_SLIP, start)
    world.start_arc(*arc)
    truth = finish(world)
    expected = pose_along(start, Arc(*arc), 1.0)
    assert (truth.x_m, truth.y_m, truth.yaw_rad) == expected
    duration_s = world.arc_duration_s(*arc)
    assert duration_s <= world.time_s < duration_s + 0.125 + 1e-9
    assert truth.distance_driven_m == pytest.approx(abs(arc[0]), rel=1e-3)
    assert world.estimate.x_m == truth.x_m


def test_time_is_exact_eighths(flat: Terrain, vehicle: Vehicle) -> None:
    world = World(flat, vehicle, CAMERA)
    world.start_arc(1.0, 0.0)
    for count in range(1, 120):
        assert world.step().time_s == count / 8
    world.wait(10.01)
    assert world.time_s == 119 / 8 + 10.125
    world.wait(0.0)
    assert world.truth.time_s == world.time_s


def test_standing_steps_pass_time_only(flat: Terrain, vehicle: Vehicle) -> None:
    world = World(flat, vehicle, CAMERA)
    assert world.arc_done
    before = world.truth
    assert world.step().x_m == before.x_m
    assert world.time_s == 0.125
    world.start_arc(0.0, 0.0)
    assert world.arc_done


def test_stopping_keeps_the_place(flat: Terrain, vehicle: Vehicle) -> None:
    world = World(flat, vehicle, CAMERA, slip=NO_SLIP)
    world.start_arc(1.0, 0.0)
    for _ in range(60):
        world.step()
    assert 0.2 < world.arc_fraction < 0.5
    x_m = world.truth.x_m
    world.stop()
    assert world.arc_done
    assert world.step().x_m == x_m


def test_arcs_can_follow_each_other_mid_way(flat: Terrain, vehicle: Vehicle) -> None:
    world = World(flat, vehicle, CAMERA, slip=NO_SLIP)
    for _ in range(4):
        world.start_arc(1.0, 0.2)
        for _ in range(40):
            world.step()
    assert world.truth.distance_driven_m == pytest.approx(4 * 40 / 8 * 0.0337, rel=0.1)


@pytest.mark.parametrize(("length_m", "heading"), [(math.nan, 0), (1, math.inf), (math.inf, 0)])
def test_arcs_must_be_finite(
    flat: Terrain, vehicle: Vehicle, length_m: float, heading: float
) -> None:
    with pytest.raises(ValueError, match="not finite"):
        World(flat, vehicle, CAMERA).start_arc(length_m, heading)


@pytest.mark.parametrize("duration_s", [-1.0, math.nan])
def test_waiting_takes_a_duration(flat: Terrain, vehicle: Vehicle, duration_s: float) -> None:
    with pytest.raises(ValueError, match="cannot wait"):
        World(flat, vehicle, CAMERA).wait(duration_s)


def test_two_runs_of_one_seed_are_bit_equal(vehicle: Vehicle) -> None:
    terrain = generate(TerrainRecipe(size_m=30, cfa=0.07, seed=1))

    def run(seed: int) -> list[object]:
        world = World(terrain, vehicle, CAMERA, start=(-5.0, 0.0, 0.1), seed=seed)
        log: list[object] = []
        for _ in range(3):
            world.start_arc(1.0, 0.1)
            finish(world)
            log += [world.visual_odometry(), world.image().tobytes(), world.estimate]
            log += [str(dataclasses.astuple(world.truth))]
        return log

    assert run(4) == run(4)
    assert run(4) != run(5)


def test_imaging_does_not_change_the_drive(vehicle: Vehicle) -> None:
    terrain = generate(TerrainRecipe(size_m=30, cfa=0.07, seed=1))
    ends = []
    for pictures in (0, 3):
        world = World(terrain, vehicle, CAMERA, start=(-5.0, 0.0, 0.1), seed=2)
        for _ in range(pictures):
            world.image()
        world.start_arc(1.0, 0.1)
        ends.append(finish(world).x_m)
    assert ends[0] == ends[1]


def test_slip_shortens_the_way_up(vehicle: Vehicle) -> None:
    slope = terrain_of(lambda n, _e: math.tan(math.radians(15)) * n, size_m=20)
    world = World(slope, vehicle, CAMERA, NO_NOISE, SlipConfig(mode="table"), seed=1)
    world.start_arc(2.0, 0.0)
    truth = finish(world)
    assert truth.x_m == pytest.approx(2.0 * 0.8, rel=0.01)
    assert truth.slip == pytest.approx(0.2, abs=0.005)
    assert world.expected_slip(math.radians(15)) == pytest.approx(0.2)


def test_odometry_overshoots_what_slip_took(vehicle: Vehicle) -> None:
    slope = terrain_of(lambda n, _e: math.tan(math.radians(15)) * n, size_m=20)
    world = World(slope, vehicle, CAMERA, slip=SlipConfig(mode="table"), seed=1)
    world.start_arc(2.0, 0.0)
    truth = finish(world)
    assert world.estimate.x_m == pytest.approx(2.0, abs=0.02)
    assert world.visual_odometry()
    assert world.estimate.x_m == pytest.approx(truth.x_m, abs=0.12)


def test_driving_off_the_map_raises_a_flag_not_an_error(flat: Terrain, vehicle: Vehicle) -> None:
    world = World(flat, vehicle, CAMERA, slip=NO_SLIP, start=(18.0, 0.0, 0.0))
    world.start_arc(2.0, 0.0)
    truth = finish(world)
    assert not truth.on_map
    assert math.isnan(truth.z_m)
    assert world.image().shape == (0, 3)
    assert world.visual_odometry()
    assert true_limit_violation(truth, vehicle) is None
    assert math.isfinite(world.estimate.x_m)


def test_a_start_off_the_map_is_a_flag(flat: Terrain, vehicle: Vehicle) -> None:
    world = World(flat, vehicle, CAMERA, start=(99.0, 0.0, 0.0))
    assert not world.truth.on_map
    world.start_arc(1.0, 0.0)
    finish(world)


def test_steps_are_continuous_on_rough_ground(vehicle: Vehicle) -> None:
    terrain = generate(TerrainRecipe(size_m=30, cfa=0.0, seed=1))
    world = World(terrain, vehicle, CAMERA, start=(-5.0, 0.0, 0.0), seed=2)
    world.start_arc(3.0, 0.3)
    last = world.truth
    while not world.arc_done:
        truth = world.step()
        assert truth.converged
        assert abs(truth.z_m - last.z_m) < 0.01
        assert abs(truth.pitch_rad - last.pitch_rad) < 0.02
        last = truth


@pytest.mark.parametrize(
    ("limit", "value", "expected"),
    [
        ("tilt_max_deg", 5.0, "tilt"),
        ("rocker_max_deg", 0.01, "rocker"),
        ("bogie_max_deg", 0.01, "bogie"),
        ("clearance_min_m", 0.59, "clearance"),
        ("wheel_drop_max_m", 0.01, "wheel drop"),
    ],
)
def test_violations_name_limit_and_value(
    rocky: Terrain, limit: str, value: float, expected: str
) -> None:
    loose = {
        "tilt_max_deg": 89,
        "rocker_max_deg": 89,
        "bogie_max_deg": 89,
        "clearance_min_m": -9,
        "wheel_drop_max_m": 9,
    }
    overrides = {f"fault_limits.{key}": number for key, number in {**loose, limit: value}.items()}
    vehicle = load_vehicle(overrides=overrides)
    state = Settler(rocky, vehicle).settle(0.0, 0.0, 1.0)
    found = true_limit_violation(state, vehicle)
    assert found is not None
    assert found.startswith(expected)
    assert limit in found


def test_flat_ground_violates_nothing(flat: Terrain, vehicle: Vehicle) -> None:
    state = Settler(flat, vehicle).settle(0.0, 0.0, 1.0)
    assert true_limit_violation(state, vehicle) is None
    assert np.isfinite(state.contact_site_m).all()


def drive_north(terrain: Terrain, vehicle: Vehicle, length_m: float) -> list[TruthState]:
    """Truths until the first fault or the end of the arc."""
    world = World(terrain, vehicle, CAMERA, NO_NOISE, NO_SLIP)
    world.start_arc(length_m, 0.0)
    truths = [world.truth]
    while not world.arc_done and fault_of(truths[-1], vehicle) is None:
        truths.append(world.step())
        world.image()
    return truths


def fault_of(truth: TruthState, vehicle: Vehicle) -> str | None:
    return true_limit_violation(truth, vehicle) if truth.on_map else "off the map"


def holed(flat: Terrain, north_m: tuple[float, float], east_m: tuple[float, float]) -> Terrain:
    """The flat terrain without ground in a rectangle."""
    z = flat.z_site_m.copy()
    rows = (flat.north_m > north_m[0]) & (flat.north_m < north_m[1])
    cols = (flat.east_m > east_m[0]) & (flat.east_m < east_m[1])
    z[np.ix_(rows, cols)] = np.nan
    return centred(z, flat.resolution_m)


@pytest.mark.parametrize("east_m", [(-5.0, 5.0), (0.9, 1.2), (-1.2, -1.1)])
def test_a_wheel_over_a_hole_ends_the_drive_and_says_why(
    flat: Terrain, vehicle: Vehicle, east_m: tuple[float, float]
) -> None:
    terrain = holed(flat, (3.0, 6.0), east_m)
    truths = drive_north(terrain, vehicle, 4.0)
    last = truths[-1]
    # the front wheels' rims reach the hole when the rover is this far
    assert last.x_m == pytest.approx(3.0 - 1.185 - 0.26, abs=0.15)
    if last.on_map:
        assert str(fault_of(last, vehicle)).startswith("not settled: a wheel is")
    else:
        assert math.isnan(last.z_m)
        reason = off_map_reason(last, terrain)
        assert reason == "a wheel over the edge of the map or over a hole in the terrain"
    assert all(truth.residual_m <= 0.01 for truth in truths[:-1])


def test_over_the_edge_says_why(flat: Terrain, vehicle: Vehicle) -> None:
    world = World(flat, vehicle, CAMERA, start=(99.0, 0.0, 0.0))
    assert off_map_reason(world.truth, flat) == "over the edge of the map"


def test_a_hole_under_the_whole_belly_is_a_fault(flat: Terrain, vehicle: Vehicle) -> None:
    terrain = holed(flat, (-1.6, 1.3), (-0.79, 0.79))
    truth = World(terrain, vehicle, CAMERA).truth
    assert truth.on_map
    found = true_limit_violation(truth, vehicle)
    assert found is not None
    assert "hole in the terrain" in found


@pytest.mark.parametrize("height_m", [1.0, 3.0, 50.0, -1.0, -3.0, -50.0])
def test_a_cliff_ends_the_drive_with_a_reason(vehicle: Vehicle, height_m: float) -> None:
    cliff = terrain_of(lambda n, _e: np.where(n > 2, height_m, 0.0), size_m=40)
    truths = drive_north(cliff, vehicle, 5.0)
    found = fault_of(truths[-1], vehicle)
    assert found is not None
    assert truths[-1].x_m < 1.5
    # until then every pose was a settled one
    assert all(truth.residual_m <= 0.01 for truth in truths[:-1])


def test_ground_too_steep_to_settle_on_is_never_a_silent_pose(vehicle: Vehicle) -> None:
    """Noise of ten metres from node to node: what is not settled says so."""
    rng = np.random.default_rng(0)
    spikes = terrain_of(lambda n, _e: rng.uniform(-5, 5, n.shape), size_m=30)
    places = rng.uniform(-10, 10, (100, 2))
    settler = Settler(spikes, vehicle)
    states = [settler.settle(north, east, 0.3) for north, east in places.tolist()]
    bad = [state for state in states if state.residual_m > 1e-3]
    assert len(bad) > 10
    for state in bad:
        assert not state.converged
        found = true_limit_violation(state, vehicle)
        assert found is not None
        if state.residual_m > 0.01:
            assert found.startswith("not settled")


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_broken_nodes_do_no_harm(flat: Terrain, vehicle: Vehicle, bad: float) -> None:
    z = flat.z_site_m.copy()
    z[np.random.default_rng(1).random(z.shape) < 0.01] = bad
    terrain = centred(z, flat.resolution_m)
    truths = drive_north(terrain, vehicle, 6.0)
    assert fault_of(truths[-1], vehicle) is not None


def test_slip_follows_the_class_map(flat: Terrain, vehicle: Vehicle) -> None:
    classes = np.where(flat.north_m > 0.0, CLASS_NAMES.index("sand"), 0).astype(np.uint8)
    terrain = dataclasses.replace(
        flat, classes=np.broadcast_to(classes[:, None], flat.z_site_m.shape)
    )
    slip = SlipConfig(mode="table", terrain_class="bedrock", yaw_sigma_deg_sqrt_m=0.0)
    world = World(terrain, vehicle, CAMERA, NO_NOISE, slip, start=(-1.0, 0.0, 0.0))
    assert world.expected_slip(0.0) == pytest.approx(0.02)
    world.start_arc(2.0, 0.0)
    found = []
    while not world.arc_done:
        on_sand = world.truth.x_m > 0.05
        is_clear = abs(world.truth.x_m) > 0.06
        truth = world.step()
        if is_clear:
            found.append((on_sand, round(truth.slip, 6)))
    assert set(found) == {(False, 0.02), (True, 0.08)}
    assert world.expected_slip(0.0) == pytest.approx(0.08)


def test_the_mast_looks_where_it_is_told(flat: Terrain, vehicle: Vehicle) -> None:
    world = World(flat, vehicle, CAMERA, NO_NOISE, NO_SLIP)
    ahead, back = world.image([0.0]), world.image([180.0])
    assert np.median(ahead[:, 0]) > 2.0
    assert np.median(back[:, 0]) < -2.0
    assert len(world.image([-60.0, 0.0, 60.0])) > 2.5 * len(ahead)
    assert world.picture(90.0, 10.0, 20.0).shape == (30, 40)


@pytest.mark.slow
def test_a_long_drives_error_stays_within_what_is_reported(vehicle: Vehicle) -> None:
    """Forty runs of 20 m with failing VO: position errors have the size of the reported sigma."""
    terrain = terrain_of(lambda n, _e: 0.05 * n, size_m=60)
    noise = NoiseConfig(vo_failure_probability=0.05)
    scaled = []
    for seed in range(40):
        world = World(terrain, vehicle, CAMERA, noise, start=(-10.0, 0.0, 0.0), seed=seed)
        sigmas = [world.estimate.sigma_position_m]
        for _ in range(20):
            world.start_arc(1.0, 0.0)
            finish(world)
            world.visual_odometry()
            sigmas.append(world.estimate.sigma_position_m)
        assert sigmas == sorted(sigmas)
        error = (world.estimate.x_m - world.truth.x_m, world.estimate.y_m - world.truth.y_m)
        scaled.append(np.array(error) / sigmas[-1])
    # sigma is that of the worst direction: the mean square of two axes is at most 2
    square = float(np.mean(np.sum(np.square(scaled), axis=1)))
    assert 0.5 < square < 2.5


def test_slip_ahead_is_that_of_the_slope_under_the_rover(vehicle: Vehicle) -> None:
    slope = terrain_of(lambda north, _east: math.tan(math.radians(15)) * north)
    world = World(slope, vehicle, CAMERA, NO_NOISE, SlipConfig(mode="table"))
    ahead = world.slip_ahead(2.0, 0.0)
    assert ahead.north_m == pytest.approx(-0.2 * 2.0, rel=0.02)
    assert ahead.sigma_m == 0.0
    turning = world.slip_ahead(0.0, 1.0)
    assert turning.north_m < -0.01
    assert turning.yaw_sigma_rad > 0.0


def test_a_rover_set_down_elsewhere_knows_where_it_is(vehicle: Vehicle) -> None:
    flat = terrain_of(lambda north, _east: 0.0 * north, size_m=40.0)
    world = World(flat, vehicle, CAMERA)
    world.start_arc(2.0, 0.0)
    finish(world)
    time_s = world.time_s
    truth = world.place(5.0, -3.0, 1.0)
    assert (truth.x_m, truth.y_m, truth.yaw_rad, world.time_s) == (5.0, -3.0, 1.0, time_s)
    assert (world.estimate.x_m, world.estimate.y_m) == (5.0, -3.0)
    assert world.arc_done


def test_the_ground_around_is_the_terrain_in_the_rover_frame(vehicle: Vehicle) -> None:
    slope = terrain_of(lambda north, east: 0.1 * north + 0.05 * east)
    world = World(slope, vehicle, CAMERA, NO_NOISE, start=(1.0, 2.0, 0.7))
    points = world.ground_around(3.0)
    assert len(points) == pytest.approx(math.pi * 9 / 0.01, rel=0.02)
    # on the plane that the rover stands on
    assert np.abs(points[:, 2]).max() < 1e-3
    assert np.hypot(points[:, 0], points[:, 1]).max() < 3.02
