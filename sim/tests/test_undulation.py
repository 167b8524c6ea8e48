# SPDX-License-Identifier: Apache-2.0
"""Undulation statistics."""

import numpy as np
import pytest
from pydantic import ValidationError

from sim.random_streams import rng_for
from sim.undulation import Undulation, undulation_up_m


@pytest.mark.parametrize("scale_m", [0.05, 0.1, 0.5, 2.0, 10.0])
def test_two_sigma_span_and_zero_mean(scale_m: float) -> None:
    layer = Undulation(horizontal_scale_m=scale_m, height_span_m=0.8)
    heights = undulation_up_m((600, 500), 0.1, layer, rng_for(1, "u"))
    assert heights.shape == (600, 500)
    assert 4 * heights.std() == pytest.approx(0.8, rel=1e-9)
    assert heights.mean() == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("scale_m", [0.5, 1.0, 3.0])
def test_correlation_falls_to_1_e_at_the_horizontal_scale(scale_m: float) -> None:
    layer = Undulation(horizontal_scale_m=scale_m, height_span_m=1.0)
    shift = round(scale_m / 0.1)
    found = []
    for seed in range(4):
        heights = undulation_up_m((900, 900), 0.1, layer, rng_for(seed, "u"))
        found.append((heights[shift:] * heights[:-shift]).mean() / heights.var())
    assert np.mean(found) == pytest.approx(np.exp(-1), abs=0.06)


def test_a_grid_too_small_for_the_scale_is_level_or_finite() -> None:
    layer = Undulation(horizontal_scale_m=1000.0, height_span_m=1.0)
    assert np.isfinite(undulation_up_m((5, 5), 0.1, layer, rng_for(1, "u"))).all()


def test_no_span_is_level() -> None:
    layer = Undulation(horizontal_scale_m=1.0, height_span_m=0.0)
    assert not undulation_up_m((50, 50), 0.1, layer, rng_for(1, "u")).any()


def test_a_gaussian_is_the_same_as_its_scale() -> None:
    by_scale = Undulation(horizontal_scale_m=2.0, height_span_m=1.0)
    by_sigma = Undulation(gaussian_sigma_m=1.0, height_span_m=1.0)
    one = undulation_up_m((200, 200), 0.1, by_scale, rng_for(1, "u"))
    two = undulation_up_m((200, 200), 0.1, by_sigma, rng_for(1, "u"))
    np.testing.assert_array_equal(one, two)


def test_a_cut_off_kernel_forgets_beyond_twice_its_radius() -> None:
    layer = Undulation(gaussian_sigma_m=50.0, gaussian_radius_m=1.0, height_span_m=1.0)
    lags: dict[float, list[float]] = {0.5: [], 1.0: [], 3.0: []}
    for seed in range(6):
        heights = undulation_up_m((800, 800), 0.1, layer, rng_for(seed, "u"))
        for lag_m, found in lags.items():
            shift = round(lag_m / 0.1)
            found.append((heights[shift:] * heights[:-shift]).mean() / heights.var())
    # a flat kernel of width 2: the correlation falls in a straight line to zero at 2 m
    assert np.mean(lags[0.5]) == pytest.approx(0.75, abs=0.06)
    assert np.mean(lags[1.0]) == pytest.approx(0.50, abs=0.06)
    assert np.mean(lags[3.0]) == pytest.approx(0.0, abs=0.06)


@pytest.mark.parametrize(
    "bad",
    [
        {"height_span_m": 1.0},
        {"height_span_m": 1.0, "horizontal_scale_m": 1.0, "gaussian_sigma_m": 0.5},
        {"height_span_m": 1.0, "gaussian_sigma_m": 0.0},
        {"height_span_m": 1.0, "gaussian_sigma_m": 1.0, "gaussian_radius_m": -1.0},
    ],
)
def test_contradictions_are_refused(bad: dict[str, float]) -> None:
    with pytest.raises(ValidationError):
        Undulation.model_validate(bad)
