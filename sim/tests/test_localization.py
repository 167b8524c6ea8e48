# SPDX-License-Identifier: Apache-2.0
"""Localisation errors have the sizes they are told to have."""

import math

import numpy as np
import pytest

from sim.localization import Localization, NoiseConfig, PoseEstimate
from sim.settle import SettledState

QUIET = {
    "attitude_sigma_deg": 0.0,
    "heading_drift_deg_sqrt_h": 0.0,
    "vo_sigma_fraction": 0.0,
    "vo_yaw_sigma_deg": 0.0,
}


def at(x_m: float, y_m: float = 0.0, z_m: float = 0.0, on_map: bool = True) -> SettledState:
    return SettledState(
        x_m, y_m, z_m, 0.02, -0.03, 0.4, 0, 0, 0, 0.03, 0.6, 0, np.zeros((6, 3)), 0, 1, on_map,
        on_map,
    )  # fmt: skip


def drive(
    seed: int, metres: int, slip: float = 0.0, **settings: object
) -> tuple[Localization, PoseEstimate]:
    """Drive north in steps of 0.1 m with a fix every metre."""
    config = NoiseConfig.model_validate({**QUIET, **settings})
    where = Localization(config, at(0.0), np.random.default_rng(seed))
    for step in range(1, 10 * metres + 1):
        where.move(at(0.1 * step * (1 - slip)), 0.1, 0.0, 2.4)
        if step % 10 == 0:
            where.fix()
    return where, where.estimate


def test_switched_off_is_the_truth() -> None:
    where, estimate = drive(0, 3, slip=0.3, enabled=False)
    assert estimate.x_m == pytest.approx(2.1)
    assert estimate.sigma_position_m == 0.0
    assert where.fix()


def test_odometry_does_not_feel_slip_and_a_fix_does() -> None:
    config = NoiseConfig.model_validate(QUIET)
    where = Localization(config, at(0.0), np.random.default_rng(0))
    for step in range(1, 11):
        where.move(at(0.08 * step), 0.1, 0.0, 2.4)
    assert where.estimate.x_m == pytest.approx(1.0)
    assert where.estimate.sigma_local_m == pytest.approx(0.1)
    assert where.fix()
    assert where.estimate.x_m == pytest.approx(0.8)
    assert where.estimate.sigma_local_m == 0.0


def test_a_fix_errs_by_its_share_of_the_distance() -> None:
    errors = [drive(seed, 1, vo_sigma_fraction=0.015)[1] for seed in range(400)]
    x = np.array([[e.x_m - 1, e.y_m, e.z_m] for e in errors])
    np.testing.assert_allclose(x.std(axis=0), 0.015, rtol=0.12)
    np.testing.assert_allclose(x.mean(axis=0), 0.0, atol=0.003)


def test_position_sigma_tells_the_truth_after_many_fixes() -> None:
    settings = {"vo_sigma_fraction": 0.015, "vo_yaw_sigma_deg": 0.1, "attitude_sigma_deg": 0.1}
    ends = [drive(seed, 40, **settings)[1] for seed in range(120)]
    across = np.std([end.y_m for end in ends])
    assert ends[0].sigma_position_m == pytest.approx(across, rel=0.2)
    yaw = np.std([end.yaw_rad - 0.4 for end in ends])
    assert ends[0].sigma_yaw_rad == pytest.approx(yaw, rel=0.2)
    assert math.degrees(ends[0].sigma_yaw_rad) == pytest.approx(0.1 * math.sqrt(41), rel=1e-6)


def test_sigma_grows() -> None:
    sigmas = [drive(1, m, vo_sigma_fraction=0.015)[1].sigma_position_m for m in (1, 5, 20)]
    assert sigmas == sorted(sigmas)
    assert sigmas[0] == pytest.approx(0.015)


def test_attitude_error_is_constant_and_of_its_size() -> None:
    rolls = [drive(seed, 2, attitude_sigma_deg=0.1)[1].roll_rad - 0.02 for seed in range(300)]
    assert math.degrees(np.std(rolls)) == pytest.approx(0.1, rel=0.12)
    assert drive(5, 1, attitude_sigma_deg=0.1)[1].roll_rad == pytest.approx(
        drive(5, 4, attitude_sigma_deg=0.1)[1].roll_rad
    )


def test_gyro_drift_grows_with_time() -> None:
    ends = []
    for seed in range(300):
        config = NoiseConfig.model_validate({**QUIET, "heading_drift_deg_sqrt_h": 2.0})
        where = Localization(config, at(0.0), np.random.default_rng(seed))
        where.move(at(0.0), 0.0, 0.0, 900.0)
        ends.append(where.estimate.yaw_rad - 0.4)
    assert math.degrees(np.std(ends)) == pytest.approx(1.0, rel=0.12)


def test_failed_fixes_keep_odometry_and_say_so() -> None:
    where, estimate = drive(0, 3, slip=0.2, vo_failure_probability=1.0)
    assert estimate.x_m == pytest.approx(3.0)
    assert estimate.sigma_position_m == pytest.approx(0.1 * math.sqrt(3))
    assert not where.fix()


def test_failures_happen_at_their_rate() -> None:
    config = NoiseConfig.model_validate({**QUIET, "vo_failure_probability": 0.05})
    where = Localization(config, at(0.0), np.random.default_rng(1))
    assert np.mean([not where.fix() for _ in range(4000)]) == pytest.approx(0.05, abs=0.012)


def test_off_the_map_the_estimate_stands_still() -> None:
    where, before = drive(0, 1)
    where.move(at(math.nan, on_map=False), 0.1, 0.0, 0.1)
    assert where.estimate == before
    where.fix()
    assert math.isfinite(where.estimate.x_m)
