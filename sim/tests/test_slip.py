# SPDX-License-Identifier: Apache-2.0
"""Slip: directions, table values, spread."""

import math
import typing

import numpy as np
import pytest

from sim.slip import SlipConfig, SlipModel, SlippedStep, TerrainClass, load_slip_table

STEP_M = 0.00525
LEVEL = (0.0, 0.0, 0.0)


def model(seed: int = 0, **settings: typing.Any) -> SlipModel:
    config = SlipConfig(**{"mode": "table", "yaw_sigma_deg_sqrt_m": 0.0, **settings})
    return SlipModel(config, np.random.default_rng(seed))


def north_step(slip: SlipModel, roll_deg: float = 0, pitch_deg: float = 0) -> SlippedStep:
    return slip.step((STEP_M, 0.0), STEP_M, (math.radians(roll_deg), math.radians(pitch_deg), 0.0))


def metre(slip: SlipModel, pitch_deg: float = 0, class_number: int = 0) -> SlippedStep:
    """One metre north in one step: a draw of its own."""
    return slip.step((1.0, 0.0), 1.0, (0.0, math.radians(pitch_deg), 0.0), class_number)


@pytest.mark.parametrize("terrain_class", typing.get_args(TerrainClass))
def test_slip_grows_with_tilt_in_every_table(terrain_class: TerrainClass) -> None:
    table = load_slip_table(terrain_class)
    means = [table.at(math.radians(tilt))[0] for tilt in range(40)]
    assert means == sorted(means)
    assert means[-1] <= 1.0


def test_up_slope_holds_back_and_down_slope_runs_ahead() -> None:
    assert north_step(model(), pitch_deg=15).slip == pytest.approx(0.20)
    assert north_step(model(), pitch_deg=-15).slip == pytest.approx(0.04 - 0.16)
    assert north_step(model()).slip == pytest.approx(0.04)
    assert north_step(model(), pitch_deg=15).east_m == pytest.approx(0.0, abs=1e-12)


def test_a_cross_slope_drifts_straight_down() -> None:
    right_down = north_step(model(), roll_deg=10)
    assert right_down.east_m == pytest.approx(0.5 * 0.08 * STEP_M)
    assert right_down.slip == pytest.approx(0.04)
    assert north_step(model(), roll_deg=-10).east_m == pytest.approx(-right_down.east_m)


def test_turning_in_place_drifts_down_slope() -> None:
    step = model().step((0.0, 0.0), STEP_M, (0.0, math.radians(10), math.pi / 2))
    # nose up while heading east: up-slope is east, the drift goes west
    assert step.east_m == pytest.approx(-0.5 * 0.08 * STEP_M)
    assert step.north_m == pytest.approx(0.0, abs=1e-12)
    assert step.slip == 0.0


def test_switched_off_is_exact() -> None:
    step = model(enabled=False).step((0.1, 0.2), 0.3, (0.3, 0.3, 0.3))
    assert step == SlippedStep(0.1, 0.2, 0.0, 0.0)
    assert model(enabled=False).expected(0.3) == 0.0


def test_gaussian_slip_is_drawn_once_per_metre() -> None:
    slip = model(mode="gaussian")
    values = [north_step(slip, pitch_deg=10).slip for _ in range(round(5.0 / STEP_M))]
    assert len(set(values)) == 5


def test_gaussian_slip_has_the_tables_spread() -> None:
    slip = model(mode="gaussian")
    values = np.array([metre(slip, pitch_deg=10).slip for _ in range(4000)])
    assert values.mean() == pytest.approx(0.12, abs=0.004)
    assert values.std() == pytest.approx(0.05, rel=0.06)


def test_yaw_slip_grows_with_the_root_of_the_distance() -> None:
    sigma = {}
    for steps in (100, 400):
        ends = []
        for seed in range(300):
            slip = model(seed, yaw_sigma_deg_sqrt_m=0.5)
            ends.append(sum(slip.step((0.01, 0), 0.01, LEVEL).yaw_slip_rad for _ in range(steps)))
        sigma[steps] = math.degrees(float(np.std(ends)))
    assert sigma[100] == pytest.approx(0.5, rel=0.15)
    assert sigma[400] == pytest.approx(1.0, rel=0.15)


def test_slip_stays_in_bounds_on_sand() -> None:
    slip = model(mode="gaussian", terrain_class="sand")
    values = [metre(slip, pitch_deg=30).slip for _ in range(2000)]
    assert max(values) <= 1.2


@pytest.mark.parametrize("terrain_class", typing.get_args(TerrainClass))
@pytest.mark.parametrize("tilt_deg", [0, 5, 10, 12.5, 20])
def test_long_drives_have_the_statistics_of_their_table(
    terrain_class: TerrainClass, tilt_deg: float
) -> None:
    """Eight kilometres up a slope: means within four standard errors, spreads within 4 per cent."""
    slip, count = model(1, mode="gaussian", terrain_class=terrain_class), 8000
    mean, sigma = load_slip_table(terrain_class).at(math.radians(tilt_deg))
    if mean + 3 * sigma > 1.2:
        pytest.skip("the table's tail lies beyond the largest slip")
    steps = [metre(slip, pitch_deg=tilt_deg) for _ in range(count)]
    values = np.array([step.slip for step in steps])
    assert values.mean() == pytest.approx(mean, abs=4 * sigma / math.sqrt(count))
    assert values.std() == pytest.approx(sigma, rel=0.04)
    # what is missing of the commanded way is the slip
    assert sum(step.north_m for step in steps) == pytest.approx(count - values.sum())


def test_long_drives_down_and_across_a_slope_have_the_statistics_of_their_table() -> None:
    count, tilt = 8000, math.radians(15)
    level, steep = (load_slip_table("cohesive_soil").at(angle) for angle in (0.0, tilt))
    added = (steep[0] - level[0], steep[1] - level[1])
    slip = model(2, mode="gaussian")
    down = np.array([slip.step((1.0, 0.0), 1.0, (0.0, -tilt, 0.0)).slip for _ in range(count)])
    assert down.mean() == pytest.approx(level[0] - added[0], abs=4 * 0.07 / math.sqrt(count))
    assert down.std() == pytest.approx(abs(level[1] - added[1]), rel=0.04)
    across = [slip.step((1.0, 0.0), 1.0, (tilt, 0.0, 0.0)) for _ in range(count)]
    drift = np.array([step.east_m for step in across])
    assert drift.mean() == pytest.approx(0.5 * added[0], abs=4 * 0.02 / math.sqrt(count))
    assert drift.std() == pytest.approx(0.5 * added[1], rel=0.04)
    assert np.mean([step.slip for step in across]) == pytest.approx(level[0], abs=0.002)


@pytest.mark.parametrize("distance_m", [1.0, 10.0, 80.0])
def test_yaw_wanders_with_the_root_of_a_long_drives_distance(distance_m: float) -> None:
    """A Brownian motion: Gaussian, variance in proportion to distance, increments independent."""
    count, steps = 1500, 16
    slip = model(3, yaw_sigma_deg_sqrt_m=0.5)
    step_m = distance_m / steps
    moves = np.array(
        [
            [slip.step((step_m, 0), step_m, LEVEL).yaw_slip_rad for _ in range(steps)]
            for _ in range(count)
        ]
    )
    ends = np.degrees(moves.sum(axis=1))
    sigma = 0.5 * math.sqrt(distance_m)
    assert ends.std() == pytest.approx(sigma, rel=0.08)
    assert ends.mean() == pytest.approx(0.0, abs=4 * sigma / math.sqrt(count))
    assert np.mean(np.abs(ends) < sigma) == pytest.approx(0.683, abs=0.05)
    neighbours = np.mean(moves[:, 1:] * moves[:, :-1]) / np.mean(moves**2)
    assert neighbours == pytest.approx(0.0, abs=0.03)


def test_a_class_map_chooses_the_table() -> None:
    slip = model(terrain_class="sand")
    found = [metre(slip, pitch_deg=10, class_number=number).slip for number in range(4)]
    assert found == pytest.approx([0.25, 0.04, 0.12, 0.25])
    assert slip.expected(math.radians(20), 1) == pytest.approx(0.09)
    assert slip.expected(math.radians(20)) == pytest.approx(0.85)


def test_between_tilts_the_table_is_linear_and_outside_it_constant() -> None:
    table = load_slip_table("sand")
    for tilt in np.linspace(-5, 40, 91):
        expected = (
            np.interp(tilt, table.tilt_deg, table.slip_mean),
            np.interp(tilt, table.tilt_deg, table.slip_sigma),
        )
        assert table.at(math.radians(tilt)) == pytest.approx(expected)


@pytest.mark.parametrize(("roll_deg", "pitch_deg"), [(0, 0), (0, 15), (0, -10), (12, 0), (-8, 6)])
def test_what_is_expected_is_the_mean_of_what_happens(roll_deg: float, pitch_deg: float) -> None:
    slip = model(seed=4, mode="gaussian", yaw_sigma_deg_sqrt_m=0.5)
    attitude = (math.radians(roll_deg), math.radians(pitch_deg), 0.3)
    motion = (math.cos(0.3), math.sin(0.3))
    steps = [slip.step(motion, 1.0, attitude) for _ in range(4000)]
    added = np.array([(s.north_m - motion[0], s.east_m - motion[1]) for s in steps])
    expected = slip.expect(motion, 1.0, attitude)
    assert added.mean(axis=0) == pytest.approx((expected.north_m, expected.east_m), abs=0.005)
    assert np.hypot(*added.std(axis=0)) == pytest.approx(expected.sigma_m, rel=0.05)
    yaw_rad = np.array([s.yaw_slip_rad for s in steps])
    assert yaw_rad.std() == pytest.approx(expected.yaw_sigma_rad, rel=0.05)


def test_expecting_draws_nothing() -> None:
    asked, other = model(mode="gaussian"), model(mode="gaussian")
    asked.expect((1.0, 0.0), 1.0, LEVEL)
    assert metre(asked) == metre(other)
