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
from sim.terrain import Terrain
from sim.tests.conftest import terrain_of
from sim.vehicle import Vehicle, load_vehicle
from sim.world import TruthState, World, true_limit_violation

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
