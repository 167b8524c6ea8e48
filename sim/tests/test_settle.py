# SPDX-License-Identifier: Apache-2.0
"""Settling: published linkage values, exact planes, symmetries, and an independent oracle."""

import gc
import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from scipy.optimize import least_squares, root
from scipy.spatial.transform import Rotation

from sim.errors import TerrainError
from sim.frames import rotation
from sim.generate import TerrainRecipe, generate
from sim.settle import SettledState, Settler, settle_on_hub_heights
from sim.terrain import Terrain, centred
from sim.tests.conftest import terrain_of
from sim.vehicle import Vehicle, load_vehicle

Array = npt.NDArray[np.float64]
ANGLES = ("roll_rad", "pitch_rad", "rocker_rad", "bogie_left_rad", "bogie_right_rad")

# raised hubs LF LM LR RF RM RR (m): rocker, bogie left, bogie right, nose-down pitch, |roll|, tilt
# in degrees, computed from the published link geometry of Curiosity with point wheels of 0.25 m
GOLDEN = {
    (0.10, 0, 0, 0, 0, 0): (-1.79, 3.67, -0.19, -1.74, 1.18, 2.10),
    (0.25, 0, 0, 0, 0, 0): (-4.45, 9.09, -0.45, -4.32, 2.88, 5.19),
    (0.35, 0, 0, 0, 0, 0): (-6.21, 12.69, -0.62, -6.02, 3.98, 7.21),
    (0.46, 0, 0, 0, 0, 0): (-8.15, 16.65, -0.80, -7.89, 5.16, 9.42),
    (0, 0.35, 0, 0, 0, 0): (3.14, -25.11, -0.39, 3.25, 2.50, 4.09),
    (0, 0, 0.35, 0, 0, 0): (2.13, 14.89, -0.27, 2.20, 1.71, 2.79),
    (0.35, 0, 0, 0.35, 0, 0): (0, 12.05, 12.05, -12.05, 0, 12.05),
    (0, 0.35, 0, 0, 0.35, 0): (0, -25.47, -25.47, 6.47, 0, 6.47),
    (0.35, 0.35, 0.35, 0, 0, 0): (-0.40, 1.45, -1.45, 0, 9.15, 9.15),
    (0.35, 0, 0, -0.35, 0, 0): (-12.90, 13.51, -14.23, 0.36, 8.46, 8.47),
}


def golden_vehicle() -> Vehicle:
    """The vehicle with the wheel radius of the golden table: everything 12.88 mm lower."""
    vehicle = load_vehicle(overrides={"settling.tolerance_m": 1e-9})
    lower = 0.26288 - 0.25
    part = vehicle.geometry
    moved = {
        name: (*getattr(part, name)[:2], getattr(part, name)[2] + lower)
        for name in type(part).model_fields
        if name.endswith("_left_m") or name.startswith("hub_")
    }
    geometry = part.model_copy(update={**moved, "wheel_radius_m": 0.25})
    return vehicle.model_copy(update={"geometry": geometry})


@pytest.mark.parametrize(("raised_m", "expected_deg"), GOLDEN.items())
@pytest.mark.parametrize("yaw_rad", [0.0, 2.0])
def test_linkage_reproduces_the_golden_table(
    raised_m: tuple[float, ...], expected_deg: tuple[float, ...], yaw_rad: float
) -> None:
    state = settle_on_hub_heights(golden_vehicle(), yaw_rad, -0.25 - np.array(raised_m))
    found = np.degrees(
        [
            state.rocker_rad,
            state.bogie_left_rad,
            state.bogie_right_rad,
            -state.pitch_rad,
            abs(state.roll_rad),
            state.tilt_rad,
        ]
    )
    assert state.converged
    # the table has two decimals: nothing but its own rounding
    np.testing.assert_allclose(found, expected_deg, atol=0.005)


def _hub_depths(unknown: Array, vehicle: Vehicle, yaw_rad: float) -> npt.NDArray[np.float64]:
    """SITE z of six hubs: homogeneous transforms, joint after joint."""

    def joint(point: Array, angle: float) -> Array:
        frame = np.eye(4)
        # nose-down is a negative turn about the y axis, which points right
        frame[:3, :3] = Rotation.from_euler("y", -angle).as_matrix()
        frame[:3, 3] = point - frame[:3, :3] @ point
        return frame

    z_m, roll, pitch, rocker, *bogies = unknown
    body = np.eye(4)
    body[:3, :3] = Rotation.from_euler("ZYX", [yaw_rad, pitch, roll]).as_matrix()
    body[2, 3] = z_m
    depths = []
    for wheel, hub in enumerate(vehicle.hubs_m):
        side = wheel // 3
        chain = body @ joint(vehicle.rocker_pivots_m[side], rocker if side == 0 else -rocker)
        if wheel % 3 > 0:
            chain = chain @ joint(vehicle.bogie_pivots_m[side], bogies[side])
        depths.append((chain @ [*hub, 1.0])[2])
    return np.array(depths)


@pytest.mark.parametrize("raised_m", [*GOLDEN, (0.1, -0.2, 0.05, 0.3, 0.0, -0.1)])
def test_linkage_agrees_with_an_independent_root_to_a_ten_thousandth_degree(
    raised_m: tuple[float, ...],
) -> None:
    vehicle, hubs = golden_vehicle(), -0.25 - np.array(raised_m)
    answer = root(lambda unknown: _hub_depths(unknown, vehicle, 0.7) - hubs, np.zeros(6), tol=1e-13)
    assert answer.success
    state = settle_on_hub_heights(vehicle, 0.7, hubs)
    found = [state.z_m, *(getattr(state, name) for name in ANGLES)]
    np.testing.assert_allclose(np.degrees(found[1:]), np.degrees(answer.x[1:]), atol=1e-4)
    assert found[0] == pytest.approx(answer.x[0], abs=1e-7)


def test_hub_lifts_add_up_to_the_body_lift() -> None:
    vehicle = golden_vehicle()
    step_m = 1e-4
    lifts = []
    for wheel in range(6):
        hubs = np.full(6, -0.25)
        hubs[wheel] -= step_m
        lifts.append(-settle_on_hub_heights(vehicle, 0.3, hubs).z_m / step_m)
    np.testing.assert_allclose(lifts[:3], [0.1376, 0.2107, 0.1517], atol=2e-4)
    np.testing.assert_allclose(lifts[3:], lifts[:3], atol=1e-6)
    assert sum(lifts) == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("slope_deg", [0, 5, 10, 15, 20, 25, 30])
@pytest.mark.parametrize("wheel", ["point", "disc", "cylinder"])
def test_a_plane_gives_its_own_tilt_at_any_yaw(slope_deg: float, wheel: str) -> None:
    vehicle = load_vehicle(overrides={"settling.wheel": wheel, "settling.tolerance_m": 1e-6})
    rise = math.tan(math.radians(slope_deg))
    plane = terrain_of(lambda n, e: rise * (n * math.cos(0.7) + e * math.sin(0.7)), size_m=10)
    settler = Settler(plane, vehicle)
    for yaw_rad in np.linspace(-3, 3, 7):
        state = settler.settle(0.33, -0.21, float(yaw_rad))
        assert math.degrees(state.tilt_rad) == pytest.approx(slope_deg, abs=1e-3)
        for name in ("rocker_rad", "bogie_left_rad", "bogie_right_rad"):
            assert math.degrees(getattr(state, name)) == pytest.approx(0.0, abs=1e-3)
        if wheel == "disc":
            assert state.clearance_m == pytest.approx(0.60, abs=1e-4)
            assert state.wheel_drop_m == pytest.approx(0.0, abs=1e-4)


def test_pitch_is_positive_nose_up_and_roll_right_side_down(vehicle: Vehicle) -> None:
    north_up = terrain_of(lambda n, _e: 0.2 * n, size_m=10)
    assert Settler(north_up, vehicle).settle(0, 0, 0.0).pitch_rad == pytest.approx(math.atan(0.2))
    assert Settler(north_up, vehicle).settle(0, 0, math.pi / 2).roll_rad == pytest.approx(
        math.atan(0.2), abs=1e-4
    )


@pytest.fixture(scope="module")
def poses() -> Array:
    rng = np.random.default_rng(11)
    return np.column_stack(
        [rng.uniform(-16, 16, 300), rng.uniform(-16, 16, 300), rng.uniform(-3.1, 3.1, 300)]
    )


def test_every_pose_converges_on_rocks(rocky: Terrain, vehicle: Vehicle, poses: Array) -> None:
    settled = Settler(rocky, vehicle).settle_many(poses)
    assert settled["on_map"].all()
    assert settled["converged"].all()
    assert settled["residual_m"].max() <= vehicle.settling.tolerance_m


def test_contacts_lie_on_the_ground_and_no_rim_point_below(
    rocky: Terrain, vehicle: Vehicle, poses: Array
) -> None:
    settled = Settler(rocky, vehicle).settle_many(poses[:60])
    angle = np.radians(np.linspace(-84, 84, 2000))
    for state in settled:
        contact = state["contact_site_m"]
        gap = rocky.height_at(contact[:, 0], contact[:, 1]) - contact[:, 2]
        np.testing.assert_allclose(gap, 0.0, atol=1.1e-4)
        axes = rotation(state["roll_rad"], state["pitch_rad"], state["yaw_rad"])
        radius = vehicle.geometry.wheel_radius_m
        rim = radius * (np.outer(np.cos(angle), axes[:, 2]) + np.outer(np.sin(angle), axes[:, 0]))
        points = state["hub_site_m"][:, None, :] + rim
        below = points[..., 2] - rocky.height_at(points[..., 0], points[..., 1])
        assert below.max() < 2e-4


def test_body_pitch_is_the_mean_of_the_rockers(
    rocky: Terrain, vehicle: Vehicle, poses: Array
) -> None:
    """The differential: left and right rocker turn by opposite angles against the body."""
    hubs, pivots = vehicle.hubs_m, vehicle.rocker_pivots_m
    for state in Settler(rocky, vehicle).settle_many(poses[:40]):
        axes = rotation(state["roll_rad"], state["pitch_rad"], state["yaw_rad"])
        origin = np.array([state["x_m"], state["y_m"], state["z_m"]])
        body = (state["hub_site_m"] - origin) @ axes
        turned = []
        for side, front in enumerate((0, 3)):
            arm, rest = body[front] - pivots[side], hubs[front] - pivots[side]
            turned.append(math.atan2(arm[2], arm[0]) - math.atan2(rest[2], rest[0]))
        assert turned[0] == pytest.approx(state["rocker_rad"], abs=1e-9)
        assert turned[0] + turned[1] == pytest.approx(0.0, abs=1e-9)


def test_mirrored_terrain_gives_the_mirrored_rover(vehicle: Vehicle) -> None:
    terrain = generate(TerrainRecipe(size_m=16, cfa=0.12, seed=2))
    mirror = centred(terrain.z_site_m[:, ::-1], terrain.resolution_m)
    here = Settler(terrain, vehicle).settle(0.4, 0.7, 0.5)
    there = Settler(mirror, vehicle).settle(0.4, -0.7, -0.5)
    assert there.z_m == pytest.approx(here.z_m, abs=2e-4)
    assert there.roll_rad == pytest.approx(-here.roll_rad, abs=2e-4)
    assert there.pitch_rad == pytest.approx(here.pitch_rad, abs=2e-4)
    assert there.rocker_rad == pytest.approx(-here.rocker_rad, abs=2e-4)
    assert there.bogie_left_rad == pytest.approx(here.bogie_right_rad, abs=1e-3)
    assert there.clearance_m == pytest.approx(here.clearance_m, abs=2e-4)
    assert there.wheel_drop_m == pytest.approx(here.wheel_drop_m, abs=2e-3)


def test_a_quarter_turn_of_terrain_and_rover_changes_nothing(vehicle: Vehicle) -> None:
    terrain = generate(TerrainRecipe(size_m=16, cfa=0.12, seed=2))
    turned = centred(np.ascontiguousarray(np.rot90(terrain.z_site_m, -1)), terrain.resolution_m)
    here = Settler(terrain, vehicle).settle(0.4, 0.7, 0.5)
    # what was at (north, east) is now at (east, -north)
    there = Settler(turned, vehicle).settle(0.7, -0.4, 0.5 - math.pi / 2)
    for name in ("z_m", *ANGLES):
        assert getattr(there, name) == pytest.approx(getattr(here, name), abs=2e-3)


def test_sum_of_ground_lifts_is_the_lift(rocky: Terrain, vehicle: Vehicle) -> None:
    lifted = centred(rocky.z_site_m - np.float32(0.25), rocky.resolution_m)
    here = Settler(rocky, vehicle).settle(1.0, 2.0, 0.3)
    there = Settler(lifted, vehicle).settle(1.0, 2.0, 0.3)
    assert here.z_m - there.z_m == pytest.approx(0.25, abs=3e-4)
    assert there.clearance_m == pytest.approx(here.clearance_m, abs=3e-4)


def _oracle_gaps(unknown: Array, terrain: Terrain, vehicle: Vehicle, pose: Array) -> Array:
    """Gaps of six disc wheels, written anew: link by link rotation matrices, dense rim samples."""
    z_m, roll, pitch, rocker, *bogies = unknown
    axes = rotation(roll, pitch, pose[2])
    origin = np.array([pose[0], pose[1], z_m])
    angle = np.radians(np.linspace(-84, 84, 1500))
    gaps = []
    for wheel in range(6):
        side = wheel // 3
        turn = (1 - 2 * side) * rocker
        pivot, bogie = vehicle.rocker_pivots_m[side], vehicle.bogie_pivots_m[side]
        hub = vehicle.hubs_m[wheel]
        if wheel % 3 == 0:
            body = pivot + rotation(0, -turn, 0) @ (hub - pivot)
        else:
            joint = pivot + rotation(0, -turn, 0) @ (bogie - pivot)
            body = joint + rotation(0, -(turn + bogies[side]), 0) @ (hub - bogie)
        rim = vehicle.geometry.wheel_radius_m * (
            np.outer(np.cos(angle), axes[:, 2]) + np.outer(np.sin(angle), axes[:, 0])
        )
        points = origin + axes @ body + rim
        gaps.append((terrain.height_at(points[:, 0], points[:, 1]) - points[:, 2]).min())
    return np.array(gaps)


def test_an_independent_solver_finds_the_same_rover(
    rocky: Terrain, vehicle: Vehicle, poses: Array
) -> None:
    settler = Settler(rocky, vehicle)
    for pose in poses[:12]:
        state = settler.settle(*pose)
        found = np.array([state.z_m, *(getattr(state, name) for name in ANGLES)])
        assert np.abs(_oracle_gaps(found, rocky, vehicle, pose)).max() < 5e-4
        start = found + np.array([0.02, 0.01, -0.01, 0.01, -0.02, 0.02])
        oracle = least_squares(_oracle_gaps, start, args=(rocky, vehicle, pose), xtol=1e-12)
        if np.abs(oracle.fun).max() < 1e-4:
            np.testing.assert_allclose(found, oracle.x, atol=5e-3)


def test_a_warm_drive_agrees_with_cold_settling(vehicle: Vehicle) -> None:
    terrain = generate(TerrainRecipe(size_m=30, cfa=0.07, seed=8))
    steps = np.arange(0, 12, 0.00525)
    path = np.column_stack([steps - 6, 0 * steps + 0.4, 0 * steps])
    settler = Settler(terrain, vehicle)
    warm, cold = settler.settle_many(path, chained=True), settler.settle_many(path)
    # a wheel that hops over a rock's edge may stall above the tolerance, by less than a millimetre
    assert warm["converged"].mean() > 0.999
    assert warm["residual_m"].max() < 1e-3
    # most steps are foretold to the tolerance
    assert warm["iterations"].mean() < 0.5
    # where several rests exist they may differ; hardly any do
    same = np.abs(warm["z_m"] - cold["z_m"]) < 1e-3
    assert same.mean() > 0.98


@pytest.mark.parametrize("wheel", ["point", "disc", "cylinder"])
def test_a_foretold_posture_is_as_exact_as_one_iterated_further(wheel: str) -> None:
    terrain = generate(TerrainRecipe(size_m=30, cfa=0.10, seed=8))
    yaw = np.arange(0, 1.0, 0.00525 / 10)
    path = np.column_stack([10 * np.sin(yaw) - 4, 10 * (1 - np.cos(yaw)) - 4, yaw])
    settled = {}
    for tolerance_m in (1e-4, 2e-6):
        vehicle = load_vehicle(
            overrides={"settling.wheel": wheel, "settling.tolerance_m": tolerance_m}
        )
        settled[tolerance_m] = Settler(terrain, vehicle).settle_many(path, chained=True)
    coarse, fine = settled[1e-4], settled[2e-6]
    assert coarse["iterations"].mean() < 0.7
    both = (coarse["converged"] == 1) & (fine["converged"] == 1)
    assert both.mean() > 0.95
    # a body angle is a height over a wheel base of metres, a bogie's over one metre
    lift_m, turn_rad = (np.abs(coarse[name] - fine[name])[both] for name in ("z_m", "pitch_rad"))
    assert np.quantile(lift_m, 0.99) < 1e-4
    assert np.quantile(turn_rad, 0.99) < 2e-4


@pytest.mark.parametrize("shift_m", [0.004, 0.04, 0.4])
def test_a_guess_in_python_serves_like_one_in_a_chain(
    rocky: Terrain, vehicle: Vehicle, shift_m: float
) -> None:
    settler = Settler(rocky, vehicle)
    poses = np.array([[1.0, 2.0, 0.3], [1.0 + shift_m, 2.0, 0.3]])
    chained = settler.settle_many(poses, chained=True)[1]
    guessed = settler.settle(1.0 + shift_m, 2.0, 0.3, guess=settler.settle(1.0, 2.0, 0.3))
    assert (guessed.z_m, guessed.iterations) == (chained["z_m"], chained["iterations"])


def test_a_guess_that_knows_nothing_of_the_ground_is_a_start_all_the_same(
    rocky: Terrain, vehicle: Vehicle
) -> None:
    settler = Settler(rocky, vehicle)
    known = settler.settle(1.0, 2.0, 0.3)
    blind = replace(known, contact_site_m=np.full((6, 3), np.nan))
    hanging = replace(known, contact_site_m=np.zeros((6, 3)))
    for guess in (blind, hanging):
        state = settler.settle(1.004, 2.0, 0.3, guess=guess)
        assert state.converged
        assert state.z_m == pytest.approx(settler.settle(1.004, 2.0, 0.3).z_m, abs=2e-4)


def test_single_and_batch_calls_agree(rocky: Terrain, vehicle: Vehicle, poses: Array) -> None:
    settler = Settler(rocky, vehicle)
    batch = settler.settle_many(poses[:5])
    for pose, row in zip(poses[:5], batch, strict=True):
        assert settler.settle(*pose).z_m == row["z_m"]


@pytest.mark.parametrize(
    ("north_m", "east_m"), [(math.nan, 0), (0, math.inf), (30, 0), (19.5, 0), (-1e300, 0)]
)
def test_off_the_map_is_a_flag(
    flat: Terrain, vehicle: Vehicle, north_m: float, east_m: float
) -> None:
    state = Settler(flat, vehicle).settle(north_m, east_m, 0.0)
    assert not state.on_map
    assert not state.converged
    assert math.isnan(state.z_m)
    assert math.isnan(state.clearance_m)


def test_a_nan_yaw_is_a_flag(flat: Terrain, vehicle: Vehicle) -> None:
    assert not Settler(flat, vehicle).settle(0, 0, math.nan).on_map


def test_a_hole_under_a_wheel_is_no_ground(flat: Terrain, vehicle: Vehicle) -> None:
    z = flat.z_site_m.copy()
    z[205:215, 185:195] = np.nan
    holed = centred(z, flat.resolution_m)
    assert not Settler(holed, vehicle).settle(0, 0, 0).on_map
    assert Settler(holed, vehicle).settle(10, 0, 0).on_map


def test_a_bad_guess_does_no_harm(rocky: Terrain, vehicle: Vehicle) -> None:
    settler = Settler(rocky, vehicle)
    cold = settler.settle(2, 3, 1)
    far = settler.settle(-9, -9, 0)
    warm = settler.settle(2, 3, 1, guess=far)
    assert warm.converged
    assert warm.z_m == pytest.approx(cold.z_m, abs=0.05)
    off = settler.settle(1e6, 0, 0)
    assert settler.settle(2, 3, 1, guess=off).z_m == cold.z_m


def test_coarse_nodes_are_refused(vehicle: Vehicle) -> None:
    with pytest.raises(TerrainError, match="too coarse"):
        Settler(centred(np.zeros((9, 9), np.float32), 2.0), vehicle)


def test_states_are_frozen(flat: Terrain, vehicle: Vehicle) -> None:
    state: SettledState = Settler(flat, vehicle).settle(0, 0, 0)
    with pytest.raises(AttributeError):
        state.z_m = 1.0  # type: ignore[misc]


def test_a_chain_keeps_alive_what_it_settles_on(vehicle: Vehicle) -> None:
    terrain = generate(TerrainRecipe(size_m=20, cfa=0.1, seed=4))
    expected = Settler(terrain, vehicle).settle(1.0, 2.0, 0.3)
    chain = Settler(terrain, vehicle).chain()
    gc.collect()
    # whatever takes the memory that was freed too early
    fillers = [np.full((40, 40, 2), 9.0, dtype=np.float32) for _ in range(64)]
    wheel_drop_m = SettledState(*chain.settle(1.0, 2.0, 0.3)).wheel_drop_m
    assert len(fillers) == 64
    assert wheel_drop_m == pytest.approx(expected.wheel_drop_m, abs=1e-9)
