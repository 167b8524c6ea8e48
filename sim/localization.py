# SPDX-License-Identifier: Apache-2.0
"""Where the rover believes it is: wheel odometry and IMU between visual odometry (VO) fixes.

Wheels do not feel slip, so between fixes the estimate moves as commanded. A fix measures the motion
since the last one with a few per cent of error and is laid on the estimate of that time, so errors
of position and heading grow from fix to fix as they do without a global reference.
"""

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
import numpy.typing as npt
from pydantic import Field

from sim.config import ConfigModel
from sim.frames import rotation
from sim.settle import SettledState

Array = npt.NDArray[np.float64]


class NoiseConfig(ConfigModel):
    """Errors of localisation.

    Attributes:
        enabled: False: the estimate is the truth.
        attitude_sigma_deg: Constant error of roll, pitch and initial yaw, drawn once per run.
        heading_drift_deg_sqrt_h: Angle random walk of the gyro; 0.07 is an LN-200-class unit.
        vo_sigma_fraction: VO error per axis as a share of the distance since the last fix; tests
            of the Mars rovers saw 1 to 2.5 %.
        vo_yaw_sigma_deg: VO error of yaw at each fix.
        vo_failure_probability: Share of fixes that fail; Spirit and Opportunity had 3 to 5 %.
        odometry_sigma_fraction: Error of wheel odometry that is reported as sigma, a share of the
            distance since the last fix. It stands for the slip that the wheels do not feel.
    """

    enabled: bool = True
    attitude_sigma_deg: Annotated[float, Field(ge=0, le=10)] = 0.1
    heading_drift_deg_sqrt_h: Annotated[float, Field(ge=0, le=100)] = 0.07
    vo_sigma_fraction: Annotated[float, Field(ge=0, le=1)] = 0.015
    vo_yaw_sigma_deg: Annotated[float, Field(ge=0, le=10)] = 0.1
    vo_failure_probability: Annotated[float, Field(ge=0, le=1)] = 0.0
    odometry_sigma_fraction: Annotated[float, Field(ge=0, le=1)] = 0.1


@dataclass(frozen=True, slots=True)
class PoseEstimate:
    """Estimated pose in SITE.

    Attributes:
        sigma_position_m: Standard deviation of the position in SITE, along its worst direction.
        sigma_local_m: Of the motion since the last fix.
        sigma_yaw_rad: Of the heading.
    """

    x_m: float
    y_m: float
    z_m: float
    roll_rad: float
    pitch_rad: float
    yaw_rad: float
    sigma_position_m: float
    sigma_local_m: float
    sigma_yaw_rad: float


class Localization:
    """Keeps the estimate of one run; the start pose is known but for the attitude error."""

    def __init__(self, config: NoiseConfig, start: SettledState, rng: np.random.Generator) -> None:
        """Draw the constant attitude error."""
        self._config = config
        self._rng = rng
        sigma_rad = math.radians(config.attitude_sigma_deg)
        self._attitude_error = sigma_rad * rng.standard_normal(3)
        self._truth = start
        self._position = _position(start)
        self._fix_truth = start
        self._fix_position = self._position
        self._fix_yaw_error = float(self._attitude_error[2])
        self._fix_distance_m = 0.0
        # covariance of north, east and yaw at the last fix
        self._covariance = np.diag([0.0, 0.0, sigma_rad**2])

    @property
    def estimate(self) -> PoseEstimate:
        """The present estimate."""
        truth = self._truth
        if not self._config.enabled:
            return PoseEstimate(
                truth.x_m, truth.y_m, truth.z_m, truth.roll_rad, truth.pitch_rad, truth.yaw_rad,
                0.0, 0.0, 0.0,
            )  # fmt: skip
        x_m, y_m, z_m = self._position.tolist()
        roll_error, pitch_error, yaw_error = self._attitude_error.tolist()
        local_m = self._config.odometry_sigma_fraction * self._fix_distance_m
        return PoseEstimate(
            x_m=x_m,
            y_m=y_m,
            z_m=z_m,
            roll_rad=truth.roll_rad + roll_error,
            pitch_rad=truth.pitch_rad + pitch_error,
            yaw_rad=truth.yaw_rad + yaw_error,
            sigma_position_m=math.sqrt(_largest_variance(self._covariance) + local_m**2),
            sigma_local_m=local_m,
            sigma_yaw_rad=math.sqrt(self._covariance[2, 2]),
        )

    def move(self, truth: SettledState, north_m: float, east_m: float, elapsed_s: float) -> None:
        """Follow one step: the commanded motion as the wheels felt it, the attitude of the IMU.

        A step off the map cannot be followed and leaves the estimate where it is.
        """
        if not self._config.enabled:
            self._truth = truth
            return
        if not (truth.on_map and self._truth.on_map):
            return
        felt = np.array([north_m, east_m, truth.z_m - self._truth.z_m])
        self._truth = truth
        drift_rad = math.radians(self._config.heading_drift_deg_sqrt_h) * math.sqrt(
            elapsed_s / 3600.0
        )
        self._attitude_error[2] += drift_rad * float(self._rng.standard_normal())
        self._covariance[2, 2] += drift_rad**2
        self._position = self._position + self._turn(truth, self._attitude_error) @ felt
        self._fix_distance_m += math.hypot(north_m, east_m)

    def fix(self) -> bool:
        """Visual odometry: measure the motion since the last fix. False when it did not converge.

        After a failure the odometry of this stretch stays in the estimate.
        """
        config, distance_m = self._config, self._fix_distance_m
        if not config.enabled:
            return True
        # always the same number of draws, so that a failure does not shift the stream
        chance = float(self._rng.random())
        noise = self._rng.standard_normal(4)
        succeeds = chance >= config.vo_failure_probability
        if succeeds:
            error = self._attitude_error.copy()
            error[2] = self._fix_yaw_error
            measured = _position(self._truth) - _position(self._fix_truth)
            self._position = (
                self._fix_position
                + self._turn(self._fix_truth, error) @ measured
                + config.vo_sigma_fraction * distance_m * noise[:3]
            )
            yaw_sigma_rad = math.radians(config.vo_yaw_sigma_deg) if distance_m > 0 else 0.0
            self._attitude_error[2] = self._fix_yaw_error + yaw_sigma_rad * float(noise[3])
            self._covariance[2, 2] += yaw_sigma_rad**2
        sigma_fraction = config.vo_sigma_fraction if succeeds else config.odometry_sigma_fraction
        self._grow(sigma_fraction * distance_m)
        self._fix_truth = self._truth
        self._fix_position = self._position
        self._fix_yaw_error = float(self._attitude_error[2])
        self._fix_distance_m = 0.0
        return succeeds

    def _grow(self, sigma_m: float) -> None:
        """Carry the covariance over the stretch since the last fix: heading error swings it."""
        north_m, east_m, _ = (self._position - self._fix_position).tolist()
        swing = np.array([[1.0, 0.0, -east_m], [0.0, 1.0, north_m], [0.0, 0.0, 1.0]])
        self._covariance = swing @ self._covariance @ swing.T
        self._covariance[[0, 1], [0, 1]] += sigma_m**2

    @staticmethod
    def _turn(truth: SettledState, error: Array) -> Array:
        """Rotation from true SITE directions to those that a wrong attitude makes of them."""
        estimated = rotation(
            truth.roll_rad + error[0], truth.pitch_rad + error[1], truth.yaw_rad + error[2]
        )
        turn: Array = estimated @ rotation(truth.roll_rad, truth.pitch_rad, truth.yaw_rad).T
        return turn


def _largest_variance(covariance: Array) -> float:
    """Position variance [m2] along the worst horizontal direction."""
    a, b, c = covariance[0, 0], covariance[0, 1], covariance[1, 1]
    return float(0.5 * (a + c) + math.hypot(0.5 * (a - c), b))


def _position(state: SettledState) -> Array:
    return np.array([state.x_m, state.y_m, state.z_m])
