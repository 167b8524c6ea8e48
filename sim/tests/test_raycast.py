# SPDX-License-Identifier: Apache-2.0
"""Ray casting against marching along the ray in small steps."""

import math

import numpy as np
import numpy.typing as npt
import pytest

from sim.frames import rotation
from sim.raycast import RayCaster
from sim.terrain import Terrain, centred

Array = npt.NDArray[np.float64]


def march_m(
    terrain: Terrain, origin: Array, direction: Array, range_max_m: float, step_m: float = 0.002
) -> float:
    """First crossing, found by small steps and linear interpolation."""
    steps = np.arange(0.0, range_max_m, step_m)
    points = origin + steps[:, None] * direction
    above = terrain.height_at(points[:, 0], points[:, 1]) - points[:, 2]
    under = np.nonzero(above <= 0)[0]
    if len(under) == 0:
        return math.nan
    i = int(under[0])
    if i == 0:
        return 0.0
    return float(steps[i - 1] + step_m * above[i - 1] / (above[i - 1] - above[i]))


def unit_vectors(rng: np.random.Generator, count: int, down: float) -> Array:
    vectors = rng.normal(size=(count, 3)) * [1, 1, 0.5] + [0, 0, down]
    directions: Array = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    return directions


def test_agrees_with_brute_force_to_a_millimetre(rocky: Terrain) -> None:
    rng = np.random.default_rng(1)
    caster = RayCaster(rocky)
    for north, east in ((0.0, 0.0), (-12.3, 8.8), (17.7, -17.2)):
        origin = np.array([north, east, float(rocky.height_at(north, east)) - 1.9])
        directions = unit_vectors(rng, 250, down=0.3)
        found = caster.ranges_m(origin, directions, 20.0)
        expected = [march_m(rocky, origin, direction, 20.0) for direction in directions]
        np.testing.assert_array_equal(np.isnan(found), np.isnan(expected))
        np.testing.assert_allclose(found, expected, atol=1e-3)


def test_a_plane_is_hit_where_it_lies(flat: Terrain) -> None:
    directions = np.array([[1.0, 0, 1], [0, -1, 1], [0, 0, 1], [0.6, 0.8, 1]])
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    found = RayCaster(flat).ranges_m([0, 0, -2], directions, 100)
    np.testing.assert_allclose(found, 2.0 / directions[:, 2], rtol=1e-6)


def test_attitude_turns_the_rays(rocky: Terrain) -> None:
    turn = rotation(0.1, -0.2, 1.3)
    directions = unit_vectors(np.random.default_rng(2), 100, down=0.5)
    caster = RayCaster(rocky)
    origin = [0, 0, float(rocky.height_at(0, 0)) - 2]
    np.testing.assert_allclose(
        caster.ranges_m(origin, directions, 30, turn),
        caster.ranges_m(origin, directions @ turn.T, 30),
        atol=1e-5,
    )


def test_the_order_of_the_rays_does_not_matter(rocky: Terrain) -> None:
    rng = np.random.default_rng(3)
    directions = unit_vectors(rng, 5000, down=0.3)
    order = rng.permutation(len(directions))
    caster = RayCaster(rocky)
    origin = [3, -4, float(rocky.height_at(3, -4)) - 1.9]
    ranges = caster.ranges_m(origin, directions, 25)
    np.testing.assert_array_equal(caster.ranges_m(origin, directions[order], 25), ranges[order])


def test_no_ground_is_nan(flat: Terrain) -> None:
    caster = RayCaster(flat)
    up = np.array([[0.0, 0, -1], [1, 0, 0], [0.6, 0, -0.8]])
    assert np.isnan(caster.ranges_m([0, 0, -1], up, 1000)).all()
    down = np.array([[0.0, 0, 1]])
    assert np.isnan(caster.ranges_m([0, 0, -10], down, 9.99)).all()
    assert np.isnan(caster.ranges_m([100, 0, -10], down, 99)).all()
    assert np.isnan(caster.ranges_m([math.nan, 0, -10], down, 99)).all()


def test_a_ray_from_outside_enters_the_map(flat: Terrain) -> None:
    direction = np.array([[-1.0, 0, 0.1]]) / math.hypot(1, 0.1)
    found = RayCaster(flat).ranges_m([25, 0, -1], direction, 100)
    assert found[0] == pytest.approx(10 * math.hypot(1, 0.1), rel=1e-5)


def test_a_ray_from_below_the_ground_has_range_zero(flat: Terrain) -> None:
    assert RayCaster(flat).ranges_m([0, 0, 1], [[0.0, 0, 1]], 10)[0] == 0.0


def test_holes_are_seen_through() -> None:
    z = np.zeros((50, 50), np.float32)
    z[20:30, 20:30] = np.nan
    caster = RayCaster(centred(z, 0.1))
    down = np.array([[0.0, 0, 1]])
    assert np.isnan(caster.ranges_m([0, 0, -1], down, 10))[0]
    assert caster.ranges_m([1.5, 0, -1], down, 10)[0] == pytest.approx(1.0)


@pytest.mark.parametrize("shape", [(2, 2), (2, 300), (5, 17), (257, 33)])
def test_any_map_shape_works(shape: tuple[int, int]) -> None:
    rng = np.random.default_rng(3)
    terrain = centred(rng.normal(0, 0.1, shape).astype(np.float32), 0.5)
    caster = RayCaster(terrain)
    origin = np.array([0.01, 0.02, -1.0])
    directions = unit_vectors(rng, 60, down=0.4)
    found = caster.ranges_m(origin, directions, 30)
    expected = [march_m(terrain, origin, direction, 30) for direction in directions]
    np.testing.assert_allclose(found, expected, atol=1e-3)


def test_rays_along_grid_lines_end() -> None:
    """Directions exactly along rows, columns and diagonals, from exactly on a node."""
    terrain = centred(np.zeros((101, 101), np.float32), 0.1)
    caster = RayCaster(terrain)
    directions = np.array(
        [[n, e, d] for n in (-1, 0, 1) for e in (-1, 0, 1) for d in (0, 0.5, 1)][1:], float
    )
    directions /= np.maximum(np.linalg.norm(directions, axis=1, keepdims=True), 1e-9)
    found = caster.ranges_m([0, 0, -0.5], directions, 50)
    down = directions[:, 2] > 0
    np.testing.assert_allclose(found[down], 0.5 / directions[down, 2], rtol=1e-5)
    assert np.isnan(found[~down]).all()


def sampled_m(terrain: Terrain, origin: Array, directions: Array, range_max_m: float) -> Array:
    """First crossings [n]: all rays stepped by a centimetre, then halved to a micrometre."""
    found = np.full(len(directions), np.nan)
    alive = np.arange(len(directions))
    near = 0.0
    while len(alive) and near < range_max_m:
        far = min(near + 0.01, range_max_m)
        points = origin + far * directions[alive]
        under = terrain.height_at(points[:, 0], points[:, 1]) <= points[:, 2]
        hit = alive[under]
        low, high = np.full(len(hit), near), np.full(len(hit), far)
        for _ in range(14):
            middle = 0.5 * (low + high)
            points = origin + middle[:, None] * directions[hit]
            is_under = terrain.height_at(points[:, 0], points[:, 1]) <= points[:, 2]
            low, high = np.where(is_under, low, middle), np.where(is_under, middle, high)
        found[hit] = high
        alive = alive[~under]
        near = far
    return found


@pytest.mark.slow
def test_a_hundred_thousand_ranges_equal_an_independent_computation(rocky: Terrain) -> None:
    rng = np.random.default_rng(9)
    caster = RayCaster(rocky)
    grazing = 0
    for _ in range(10):
        north, east = rng.uniform(-10, 10, 2)
        origin = np.array([north, east, float(rocky.height_at(north, east)) - 1.98])
        directions = unit_vectors(rng, 10_000, down=0.6)
        found = caster.ranges_m(origin, directions, 12.0)
        expected = sampled_m(rocky, origin, directions, 12.0)
        same = np.isclose(found, expected, rtol=0, atol=1e-3, equal_nan=True)
        # what a centimetre steps over: a ray that dips into an edge for less than that
        for ray in np.flatnonzero(~same):
            expected[ray] = march_m(rocky, origin, directions[ray], float(found[ray]) + 0.02, 2e-5)
        grazing += int(np.count_nonzero(~same))
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-3)
    assert grazing < 100


@pytest.mark.parametrize("range_max_m", [3.0, 14.0, 60.0, 5000.0])
def test_far_and_near_limits_see_the_same(rocky: Terrain, range_max_m: float) -> None:
    caster = RayCaster(rocky)
    directions = unit_vectors(np.random.default_rng(6), 3000, down=0.15)
    origin = np.array([3.0, -2.0, float(rocky.height_at(3.0, -2.0)) - 2.0])
    expected = caster.ranges_m(origin, directions, 100.0)
    expected[expected > range_max_m] = np.nan
    np.testing.assert_array_equal(caster.ranges_m(origin, directions, range_max_m), expected)


def test_a_hit_does_not_depend_on_the_rays_beside_it(rocky: Terrain) -> None:
    caster = RayCaster(rocky)
    directions = unit_vectors(np.random.default_rng(7), 500, down=0.2)
    origin = np.array([0.0, 0.0, float(rocky.height_at(0.0, 0.0)) - 2.0])
    together = caster.ranges_m(origin, directions, 30.0)
    alone = [caster.ranges_m(origin, one, 30.0)[0] for one in directions[::-1]][::-1]
    np.testing.assert_array_equal(together, alone)


def test_ground_is_seen_from_high_above_and_outside_the_map(rocky: Terrain) -> None:
    caster = RayCaster(rocky)
    rng = np.random.default_rng(8)
    for _ in range(200):
        place = rng.uniform(-15, 15, 2)
        target = np.array([*place, float(rocky.height_at(*place))])
        origin = np.array([*rng.uniform(30, 60, 2) * rng.choice([-1, 1], 2), target[2] - 90.0])
        ray = target - origin
        distance = float(np.linalg.norm(ray))
        found = float(caster.ranges_m(origin, ray / distance, 200.0)[0])
        expected = march_m(rocky, origin, ray / distance, distance + 0.1)
        assert found == pytest.approx(expected, abs=1e-3)


def test_broken_directions_hit_nothing(flat: Terrain) -> None:
    directions = np.array([[math.nan, 0, 1], [0, 0, math.nan], [0, 0, 0], [math.inf, 0, 1]])
    assert np.isnan(RayCaster(flat).ranges_m([0, 0, -2], directions, 10)).all()
