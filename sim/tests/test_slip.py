# SPDX-License-Identifier: Apache-2.0
"""Slip: directions, table values, spread."""

import math
import typing

import numpy as np
import pytest

from sim.slip import SlipConfig, SlipModel, SlippedStep, TerrainClass, load_slip_table

STEP_M = 0.00525


def model(seed: int = 0, **settings: typing.Any) -> SlipModel:
    config = SlipConfig(**{"mode": "table", "yaw_sigma_deg_sqrt_m": 0.0, **settings})
    return SlipModel(config, np.random.default_rng(seed))


def north_step(slip: SlipModel, roll_deg: float = 0, pitch_deg: float = 0) -> SlippedStep:
    return slip.step(STEP_M, 0.0, STEP_M, math.radians(roll_deg), math.radians(pitch_deg), 0.0)


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
    step = model().step(0.0, 0.0, STEP_M, 0.0, math.radians(10), math.pi / 2)
    # nose up while heading east: up-slope is east, the drift goes west
    assert step.east_m == pytest.approx(-0.5 * 0.08 * STEP_M)
    assert step.north_m == pytest.approx(0.0, abs=1e-12)
    assert step.slip == 0.0


def test_switched_off_is_exact() -> None:
    step = model(enabled=False).step(0.1, 0.2, 0.3, 0.3, 0.3, 0.3)
    assert step == SlippedStep(0.1, 0.2, 0.0, 0.0)
    assert model(enabled=False).expected(0.3) == 0.0


def test_gaussian_slip_is_drawn_once_per_metre() -> None:
    slip = model(mode="gaussian")
    values = [north_step(slip, pitch_deg=10).slip for _ in range(round(5.0 / STEP_M))]
    assert len(set(values)) == 5


def test_gaussian_slip_has_the_tables_spread() -> None:
    slip = model(mode="gaussian")
    values = np.array([slip.step(1.0, 0, 1.0, 0, math.radians(10), 0).slip for _ in range(4000)])
    assert values.mean() == pytest.approx(0.12, abs=0.004)
    assert values.std() == pytest.approx(0.05, rel=0.06)


def test_yaw_slip_grows_with_the_root_of_the_distance() -> None:
    sigma = {}
    for steps in (100, 400):
        ends = []
        for seed in range(300):
            slip = model(seed, yaw_sigma_deg_sqrt_m=0.5)
            ends.append(sum(slip.step(0.01, 0, 0.01, 0, 0, 0).yaw_slip_rad for _ in range(steps)))
        sigma[steps] = math.degrees(float(np.std(ends)))
    assert sigma[100] == pytest.approx(0.5, rel=0.15)
    assert sigma[400] == pytest.approx(1.0, rel=0.15)


def test_slip_stays_in_bounds_on_sand() -> None:
    slip = model(mode="gaussian", terrain_class="sand")
    values = [slip.step(1.0, 0, 1.0, 0, math.radians(30), 0).slip for _ in range(2000)]
    assert max(values) <= 1.2
