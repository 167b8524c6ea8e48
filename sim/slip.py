# SPDX-License-Identifier: Apache-2.0
"""Wheel slip: less motion up-slope, more down-slope, drift on cross-slopes, and a wandering yaw.

Slip is 1 - actual / commanded motion. SIM: a motion-relative part acts along the commanded motion,
a slope-relative part straight down-slope when driving across it or turning in place; the factor at
a tilt comes from a table, or from a Gaussian around it; yaw slip is a Brownian motion.
"""

import math
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from sim.config import ConfigModel, parse_model
from sim.terrain import CLASS_NAMES

TerrainClass = Literal["bedrock", "cohesive_soil", "sand"]

# a wheel can slide back a little, and run ahead of its rim, but no further than this
SLIP_MIN, SLIP_MAX = -0.5, 1.2
# one draw of the Gaussian holds for this distance: slip changes with the soil, not with the clock
DRAW_DISTANCE_M = 1.0


class SlipConfig(ConfigModel):
    """How the ground slips.

    Attributes:
        enabled: False: the rover moves exactly as commanded.
        terrain_class: Which table, where the terrain's class map does not say.
        mode: table: always the mean; gaussian: drawn around it.
        lateral_share: Drift across the slope per metre, as a share of the slip at that tilt. No
            number is published; "the same order" is, so half.
        yaw_sigma_deg_sqrt_m: Standard deviation of the yaw slip after one metre. Not published.
    """

    enabled: bool = True
    terrain_class: TerrainClass = "cohesive_soil"
    mode: Literal["table", "gaussian"] = "gaussian"
    lateral_share: Annotated[float, Field(ge=0, le=2)] = 0.5
    yaw_sigma_deg_sqrt_m: Annotated[float, Field(ge=0, le=20)] = 0.5


class SlipTable(ConfigModel):
    """Mean and standard deviation of slip at some tilts."""

    terrain_class: TerrainClass
    tilt_deg: tuple[float, ...]
    slip_mean: tuple[float, ...]
    slip_sigma: tuple[float, ...]

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not len(self.tilt_deg) == len(self.slip_mean) == len(self.slip_sigma) >= 1:
            raise ValueError("tilt_deg, slip_mean and slip_sigma must be of one length")
        if list(self.tilt_deg) != sorted(set(self.tilt_deg)):
            raise ValueError("tilt_deg must increase")
        return self

    def at(self, tilt_rad: float) -> tuple[float, float]:
        """Mean and standard deviation at a tilt, linear in between, constant outside."""
        tilt_deg, places = math.degrees(tilt_rad), self.tilt_deg
        after = bisect_right(places, tilt_deg)
        if after == 0 or after == len(places):
            nearest = min(after, len(places) - 1)
            return self.slip_mean[nearest], self.slip_sigma[nearest]
        low, high = after - 1, after
        part = (tilt_deg - places[low]) / (places[high] - places[low])
        return (
            self.slip_mean[low] + part * (self.slip_mean[high] - self.slip_mean[low]),
            self.slip_sigma[low] + part * (self.slip_sigma[high] - self.slip_sigma[low]),
        )


@cache
def load_slip_table(terrain_class: TerrainClass) -> SlipTable:
    """Built-in table of a terrain class."""
    name = f"{terrain_class}.yaml"
    text = resources.files("sim.slip_tables").joinpath(name).read_text("utf-8")
    return parse_model(text, name, SlipTable)


@dataclass(frozen=True, slots=True)
class SlippedStep:
    """What one commanded step becomes."""

    north_m: float
    east_m: float
    yaw_slip_rad: float
    slip: float


@dataclass(frozen=True, slots=True)
class ExpectedSlip:
    """What slip is expected to add to a commanded motion.

    Attributes:
        north_m: Mean of what it adds northward.
        east_m: And eastward.
        sigma_m: Standard deviation of the position around that mean.
        yaw_sigma_rad: Standard deviation of the heading.
    """

    north_m: float
    east_m: float
    sigma_m: float
    yaw_sigma_rad: float


class SlipModel:
    """Turns commanded steps into actual ones."""

    def __init__(self, config: SlipConfig, rng: np.random.Generator) -> None:
        """Start with fresh draws."""
        self._config = config
        self._rng = rng
        # by number in a class map; what the map leaves open is configured
        self._tables = tuple(
            load_slip_table(config.terrain_class if name == CLASS_NAMES[0] else name)
            for name in CLASS_NAMES
        )
        self._distance_m = 0.0
        self._draw_end_m = 0.0
        self._eta = 0.0

    def expected(self, tilt_rad: float, class_number: int = 0) -> float:
        """Mean slip at a tilt when driving straight up it."""
        return self._tables[class_number].at(tilt_rad)[0] if self._config.enabled else 0.0

    def step(
        self,
        motion_m: tuple[float, float],
        wheel_path_m: float,
        attitude_rad: tuple[float, float, float],
        class_number: int = 0,
    ) -> SlippedStep:
        """Actual step for a commanded one (north, east) from a settled (roll, pitch, yaw).

        `wheel_path_m` is what the wheels roll, also when the rover turns in place; `class_number`
        is the terrain class under the rover, as in a class map.
        """
        north_m, east_m = motion_m
        if not self._config.enabled:
            return SlippedStep(north_m, east_m, 0.0, 0.0)
        self._advance(wheel_path_m)
        table = self._tables[class_number]
        eta = self._eta if self._config.mode == "gaussian" else 0.0
        added_north_m, added_east_m, slip = self._added(
            motion_m, wheel_path_m, attitude_rad, lambda tilt_rad: _factor(table, tilt_rad, eta)
        )
        sigma_rad = math.radians(self._config.yaw_sigma_deg_sqrt_m)
        return SlippedStep(
            north_m + added_north_m,
            east_m + added_east_m,
            sigma_rad * math.sqrt(wheel_path_m) * float(self._rng.standard_normal()),
            slip,
        )

    def expect(
        self,
        motion_m: tuple[float, float],
        wheel_path_m: float,
        attitude_rad: tuple[float, float, float],
        class_number: int = 0,
    ) -> ExpectedSlip:
        """What `step` will add to such a motion on ground of this attitude; draws nothing."""
        if not self._config.enabled:
            return ExpectedSlip(0.0, 0.0, 0.0, 0.0)
        table = self._tables[class_number]
        north_m, east_m, _ = self._added(
            motion_m, wheel_path_m, attitude_rad, lambda tilt_rad: _factor(table, tilt_rad, 0.0)
        )
        sigma_m = 0.0
        if self._config.mode == "gaussian":
            # slip is linear in the one number that is drawn: its sigma is the slip of the sigmas
            spread = self._added(
                motion_m, wheel_path_m, attitude_rad, lambda tilt_rad: table.at(tilt_rad)[1]
            )
            sigma_m = math.hypot(spread[0], spread[1])
        yaw_sigma_rad = math.radians(self._config.yaw_sigma_deg_sqrt_m) * math.sqrt(wheel_path_m)
        return ExpectedSlip(north_m, east_m, sigma_m, yaw_sigma_rad)

    def _added(
        self,
        motion_m: tuple[float, float],
        wheel_path_m: float,
        attitude_rad: tuple[float, float, float],
        factor: Callable[[float], float],
    ) -> tuple[float, float, float]:
        """North and east that slip adds to a motion, and the slip along it; factor by tilt."""
        north_m, east_m = motion_m
        uphill_north, uphill_east, tilt_rad = _uphill(*attitude_rad)
        # on the level the whole slip holds back; of what the slope adds, the part along the motion
        level = factor(0.0)
        added = factor(tilt_rad) - level
        length_m = math.hypot(north_m, east_m)
        along, across = 0.0, 1.0
        if length_m > 0.0:
            along = (north_m * uphill_north + east_m * uphill_east) / length_m
            across = math.sqrt(max(0.0, 1.0 - along * along)) if tilt_rad > 0.0 else 0.0
        slip = min(max(level + added * along, SLIP_MIN), SLIP_MAX)
        drift_m = self._config.lateral_share * added * across * wheel_path_m
        return (
            -slip * north_m - drift_m * uphill_north,
            -slip * east_m - drift_m * uphill_east,
            slip if length_m > 0.0 else 0.0,
        )

    def _advance(self, wheel_path_m: float) -> None:
        """Draw anew for every metre."""
        if self._distance_m >= self._draw_end_m:
            self._eta = float(self._rng.standard_normal())
            self._draw_end_m += DRAW_DISTANCE_M
        self._distance_m += wheel_path_m


def _factor(table: SlipTable, tilt_rad: float, eta: float) -> float:
    mean, sigma = table.at(tilt_rad)
    return min(max(mean + sigma * eta, SLIP_MIN), SLIP_MAX)


def _uphill(roll_rad: float, pitch_rad: float, yaw_rad: float) -> tuple[float, float, float]:
    """Unit vector up-slope (north, east) of the body's plane, and its tilt; zeros when level.

    The body's down axis leans up-slope: its horizontal part points there.
    """
    cp, sp = math.cos(pitch_rad), math.sin(pitch_rad)
    cr, sr = math.cos(roll_rad), math.sin(roll_rad)
    cy, sy = math.cos(yaw_rad), math.sin(yaw_rad)
    north, east = cy * sp * cr + sy * sr, sy * sp * cr - cy * sr
    sine = math.hypot(north, east)
    if sine < 1e-9:
        return 0.0, 0.0, 0.0
    return north / sine, east / sine, math.atan2(sine, cp * cr)
