# SPDX-License-Identifier: Apache-2.0
"""Rocks: the size-frequency law, shapes, and what clearing does."""

import math

import numpy as np
import pytest

from sim.errors import TerrainError
from sim.random_streams import rng_for
from sim.rocks import (
    achieved_area_fraction,
    area_fraction,
    draw_rocks,
    number_per_m2,
    outside_strip,
    stamp_rocks,
    thinned,
)

SIZE_M = (120.0, 120.0)


@pytest.mark.parametrize("cfa", [0.03, 0.07, 0.10, 0.15])
def test_covered_area_follows_the_law(cfa: float) -> None:
    rocks = np.concatenate(
        [draw_rocks(cfa, 0.1, 2.0, SIZE_M, rng_for(seed, "r")).rocks for seed in range(6)]
    )
    area_m2 = 6 * SIZE_M[0] * SIZE_M[1]
    for diameter_m in (0.1, 0.2, 0.5):
        large = rocks["diameter_m"][rocks["diameter_m"] >= diameter_m]
        expected = float(area_fraction(cfa, diameter_m) - area_fraction(cfa, 2.0))
        noise = math.sqrt(
            (0.25 * math.pi * large**2 / area_m2) @ (0.25 * math.pi * large**2 / area_m2)
        )
        found = float((0.25 * math.pi * large**2).sum() / area_m2)
        assert found == pytest.approx(expected, abs=4 * noise + 0.002 * expected)


@pytest.mark.parametrize(
    ("cfa", "above_02", "above_05", "above_07"),
    [(0.07, 5167, 391, 102), (0.10, 7576, 719, 216), (0.15, 11364, 1290, 434)],
)
def test_counts_match_the_integrated_law(
    cfa: float, above_02: int, above_05: int, above_07: int
) -> None:
    """Numbers in 120 x 120 m computed from N(>D) = (4 k q / pi) (exp(-qD) / D - q E1(qD))."""
    fields = [draw_rocks(cfa, 0.1, 3.0, SIZE_M, rng_for(seed, "c")).rocks for seed in range(8)]
    for diameter_m, expected in ((0.2, above_02), (0.5, above_05), (0.7, above_07)):
        found = np.mean([(rocks["diameter_m"] > diameter_m).sum() for rocks in fields])
        assert found == pytest.approx(expected, abs=4 * math.sqrt(expected / 8) + 0.01 * expected)


def test_diameters_positions_and_heights_are_in_range() -> None:
    rocks = draw_rocks(0.1, 0.2, 1.5, (30.0, 50.0), rng_for(1, "r")).rocks
    assert rocks["diameter_m"].min() >= 0.2
    assert rocks["diameter_m"].max() <= 1.5
    assert np.abs(rocks["north_m"]).max() <= 15
    assert 15 < np.abs(rocks["east_m"]).max() <= 25
    np.testing.assert_allclose(rocks["height_m"], 0.5 * rocks["diameter_m"])


def test_stamped_area_and_height_are_those_of_the_rock() -> None:
    """On fine ground each outline has the area of the circle of its diameter."""
    field = draw_rocks(0.15, 0.6, 2.0, (40.0, 40.0), rng_for(2, "r"))
    field = field.subset(np.arange(len(field.rocks)) < 40)
    for index in range(12):
        one = field.subset(np.arange(len(field.rocks)) == index)
        north, east = float(one.rocks["north_m"][0]), float(one.rocks["east_m"][0])
        axis = np.zeros((400, 400))
        result = stamp_rocks(axis, 0.01, (north - 2.0, east - 2.0), one, np.zeros_like(axis))
        area_m2 = np.count_nonzero(result < 0) * 1e-4
        diameter_m = float(one.rocks["diameter_m"][0])
        assert area_m2 == pytest.approx(0.25 * math.pi * diameter_m**2, rel=0.02)
        assert -result.min() == pytest.approx(0.5 * diameter_m, rel=0.01)


def test_the_higher_of_rock_and_ground_wins() -> None:
    field = draw_rocks(0.15, 0.5, 2.0, (12.0, 12.0), rng_for(4, "r"))
    axis = (np.arange(120) - 59.5) * 0.1
    ground = -0.3 * axis[:, None] + 0.0 * axis[None, :]
    result = stamp_rocks(ground, 0.1, (axis[0], axis[0]), field, np.zeros_like(ground))
    assert (result <= ground).all()
    assert (result < ground).any()
    # a peak stands half a diameter above the ground under the rock's centre
    largest = field.rocks[np.argmax(field.rocks["diameter_m"])]
    base = -0.3 * largest["north_m"]
    row, col = (round((largest[k] - axis[0]) / 0.1) for k in ("north_m", "east_m"))
    near = result[max(row - 1, 0) : row + 2, max(col - 1, 0) : col + 2].min()
    assert base - near == pytest.approx(largest["height_m"], abs=0.15)


def test_only_high_rocks_that_touch_the_strip_go() -> None:
    field = draw_rocks(0.15, 0.1, 2.0, (40.0, 40.0), rng_for(3, "r"))
    yaw_rad = 0.6
    stays = outside_strip(field, (1.0, -2.0), yaw_rad, (2.5, 8.0, 2.2), 0.10)
    north, east = field.rocks["north_m"] - 1.0, field.rocks["east_m"] + 2.0
    forward = north * math.cos(yaw_rad) + east * math.sin(yaw_rad)
    right = east * math.cos(yaw_rad) - north * math.sin(yaw_rad)
    centre_inside = (forward > -2.5) & (forward < 8) & (np.abs(right) < 2.2)
    high = field.rocks["height_m"] > 0.10
    assert not (stays & centre_inside & high).any()
    assert stays[~high].all()
    far = (forward < -5) | (forward > 11) | (np.abs(right) > 5)
    assert stays[far].all()
    assert (~stays).any()


# rocks larger than 0.2, 0.5, 0.7 m in 120 x 120 m, from the published law integrated by hand
COUNTS = {
    0.07: (5167, 391, 102), 0.10: (7576, 719, 216), 0.12: (9116, 946, 301), 0.15: (11364, 1291, 434)
}  # fmt: skip


@pytest.mark.parametrize("cfa", COUNTS)
def test_fifty_seeds_follow_the_law_at_every_diameter(cfa: float) -> None:
    seeds, area_m2 = 50, 50 * SIZE_M[0] * SIZE_M[1]
    fields = [draw_rocks(cfa, 0.1, 2.0, SIZE_M, rng_for(seed, "rocks")) for seed in range(seeds)]
    diameters_m = np.concatenate([field.rocks["diameter_m"] for field in fields])
    steps_m = np.arange(0.1, 0.7001, 0.02)
    achieved = achieved_area_fraction(diameters_m, area_m2, steps_m)
    # the law itself, of rocks of all sizes, although none over 2 m is made
    np.testing.assert_allclose(achieved, area_fraction(cfa, steps_m), rtol=0.05)
    for diameter_m in np.arange(0.7, 1.81, 0.1):
        large = diameters_m[diameters_m >= diameter_m]
        sigma = math.sqrt(((0.25 * math.pi * large**2) ** 2).sum()) / area_m2
        found = float(achieved_area_fraction(diameters_m, area_m2, diameter_m))
        law = float(area_fraction(cfa, diameter_m) - area_fraction(cfa, 2.0))
        assert abs(found - law) < 3 * sigma
    for diameter_m, expected in zip((0.2, 0.5, 0.7), COUNTS[cfa], strict=True):
        count = np.count_nonzero(diameters_m > diameter_m)
        assert abs(count - seeds * expected) < 3 * math.sqrt(seeds * expected) + 0.005 * count
        assert number_per_m2(cfa, diameter_m) * 14_400 == pytest.approx(expected, abs=0.6)


def test_area_fraction_of_a_list() -> None:
    achieved = achieved_area_fraction(np.array([2.0, 1.0, 1.0]), 10.0, [0.0, 1.0, 1.01, 2.0, 3.0])
    quarter = 0.25 * math.pi / 10
    np.testing.assert_allclose(achieved, quarter * np.array([6, 6, 4, 4, 0]))
    assert achieved_area_fraction(np.zeros(0), 10.0, 0.1) == 0.0


def test_thinned_rocks_follow_the_law_of_their_own_cfa() -> None:
    kept = []
    for seed in range(12):
        field = draw_rocks(0.15, 0.1, 2.0, SIZE_M, rng_for(seed, "rocks"))
        local = np.full(len(field.rocks), 0.06)
        kept.append(thinned(field, 0.15, local, rng_for(seed, "thin")).rocks["diameter_m"])
    diameters_m, area_m2 = np.concatenate(kept), 12 * SIZE_M[0] * SIZE_M[1]
    for diameter_m, tolerance in ((0.1, 0.02), (0.3, 0.05), (0.6, 0.12)):
        found = float(achieved_area_fraction(diameters_m, area_m2, diameter_m))
        assert found == pytest.approx(float(area_fraction(0.06, diameter_m)), rel=tolerance)
    assert len(thinned(field, 0.15, 0 * local, rng_for(1, "thin")).rocks) == 0


def test_too_many_rocks_are_refused_before_they_are_drawn() -> None:
    with pytest.raises(TerrainError, match="expected at most 5000000"):
        draw_rocks(0.4, 0.02, 2.0, (3000.0, 3000.0), rng_for(1, "r"))


@pytest.mark.slow
def test_a_million_rocks_are_drawn_and_stamped() -> None:
    field = draw_rocks(0.4, 0.03, 2.0, (250.0, 250.0), rng_for(1, "r"))
    assert len(field.rocks) > 1_000_000
    level = np.zeros((500, 500))
    covered = stamp_rocks(level, 0.5, (-124.75, -124.75), field, level) < 0
    assert 0.2 < covered.mean() < 0.4


def test_slope_and_hills_do_not_bend_a_rock() -> None:
    """What stands above the ground on an incline is what stands on level ground, moved up."""
    field = draw_rocks(0.15, 0.8, 2.0, (30.0, 30.0), rng_for(7, "r"))
    one = field.subset(np.arange(len(field.rocks)) == int(np.argmax(field.rocks["diameter_m"])))
    north, east = float(one.rocks["north_m"][0]), float(one.rocks["east_m"][0])
    origin = (north - 3.0, east - 3.0)
    level = np.zeros((121, 121))
    axis = (np.arange(121) - 60) * 0.05
    incline = -math.tan(math.radians(20)) * axis[:, None] + level
    on_level = stamp_rocks(level, 0.05, origin, one, level)
    on_incline = stamp_rocks(incline, 0.05, origin, one, level)
    rock = on_incline < incline
    # the centre of the rock lies in the middle of the grid, where the incline is at zero
    np.testing.assert_allclose(on_incline[rock], on_level[rock], atol=1e-12)
    assert (on_incline[~rock] == incline[~rock]).all()
