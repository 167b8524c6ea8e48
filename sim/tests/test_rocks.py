# SPDX-License-Identifier: Apache-2.0
"""Rocks: the size-frequency law, shapes, and what clearing does."""

import math

import numpy as np
import pytest

from sim.random_streams import rng_for
from sim.rocks import area_fraction, draw_rocks, outside_strip, stamp_rocks

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
