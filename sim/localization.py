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
from sim.frames import turned, turned_back
from sim.settle import SettledState

Array = npt.NDArray[np.float64]
Vector = tuple[float, float, float]


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
        errors = (sigma_rad * rng.standard_normal(3)).tolist()
        self._roll_error, self._pitch_error, self._yaw_error = errors
        self._truth = start
        self._position: Vector = (start.x_m, start.y_m, start.z_m)
        self._fix_truth = start
        self._fix_position = self._position
        self._fix_yaw_error = self._yaw_error
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
        x_m, y_m, z_m = self._position
        local_m = self._config.odometry_sigma_fraction * self._fix_distance_m
        return PoseEstimate(
            x_m=x_m,
            y_m=y_m,
            z_m=z_m,
            roll_rad=truth.roll_rad + self._roll_error,
            pitch_rad=truth.pitch_rad + self._pitch_error,
            yaw_rad=truth.yaw_rad + self._yaw_error,
            sigma_position_m=self.sigma_position_after_m(0.0),
            sigma_local_m=local_m,
            sigma_yaw_rad=math.sqrt(self._covariance[2, 2]),
        )

    def sigma_position_after_m(self, distance_m: float) -> float:
        """What `sigma_position_m` grows to over so much more motion without a fix."""
        if not self._config.enabled:
            return 0.0
        local_m = self._config.odometry_sigma_fraction * (self._fix_distance_m + distance_m)
        return math.sqrt(_largest_variance(self._covariance) + local_m**2)

    def move(self, truth: SettledState, north_m: float, east_m: float, elapsed_s: float) -> None:
        """Follow one step: the commanded motion as the wheels felt it, the attitude of the IMU.

        A step off the map cannot be followed and leaves the estimate where it is.
        """
        if not self._config.enabled:
            self._truth = truth
            return
        if not (truth.on_map and self._truth.on_map):
            return
        felt = (north_m, east_m, truth.z_m - self._truth.z_m)
        self._truth = truth
        drift_rad = math.radians(self._config.heading_drift_deg_sqrt_h) * math.sqrt(
            elapsed_s / 3600.0
        )
        self._yaw_error += drift_rad * float(self._rng.standard_normal())
        self._covariance[2, 2] += drift_rad**2
        self._position = _sum(self._position, self._believed(truth, self._yaw_error, felt))
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
        noise = self._rng.standard_normal(4).tolist()
        succeeds = chance >= config.vo_failure_probability
        if succeeds:
            here, there = self._truth, self._fix_truth
            measured = (here.x_m - there.x_m, here.y_m - there.y_m, here.z_m - there.z_m)
            sigma_m = config.vo_sigma_fraction * distance_m
            self._position = _sum(
                _sum(self._fix_position, self._believed(there, self._fix_yaw_error, measured)),
                (sigma_m * noise[0], sigma_m * noise[1], sigma_m * noise[2]),
            )
            yaw_sigma_rad = math.radians(config.vo_yaw_sigma_deg) if distance_m > 0 else 0.0
            self._yaw_error = self._fix_yaw_error + yaw_sigma_rad * noise[3]
            self._covariance[2, 2] += yaw_sigma_rad**2
        sigma_fraction = config.vo_sigma_fraction if succeeds else config.odometry_sigma_fraction
        self._grow(sigma_fraction * distance_m)
        self._fix_truth = self._truth
        self._fix_position = self._position
        self._fix_yaw_error = self._yaw_error
        self._fix_distance_m = 0.0
        return succeeds

    def _grow(self, sigma_m: float) -> None:
        """Carry the covariance over the stretch since the last fix: heading error swings it."""
        north_m = self._position[0] - self._fix_position[0]
        east_m = self._position[1] - self._fix_position[1]
        swing = np.array([[1.0, 0.0, -east_m], [0.0, 1.0, north_m], [0.0, 0.0, 1.0]])
        self._covariance = swing @ self._covariance @ swing.T
        self._covariance[[0, 1], [0, 1]] += sigma_m**2

    def _believed(self, truth: SettledState, yaw_error: float, vector: Vector) -> Vector:
        """What a true SITE vector becomes when it is laid out with a wrong attitude."""
        body = turned_back(truth.roll_rad, truth.pitch_rad, truth.yaw_rad, vector)
        return turned(
            truth.roll_rad + self._roll_error,
            truth.pitch_rad + self._pitch_error,
            truth.yaw_rad + yaw_error,
            body,
        )


def _largest_variance(covariance: Array) -> float:
    """Position variance [m2] along the worst horizontal direction."""
    a, b, c = covariance[0, 0], covariance[0, 1], covariance[1, 1]
    return float(0.5 * (a + c) + math.hypot(0.5 * (a - c), b))


def _sum(one: Vector, other: Vector) -> Vector:
    return one[0] + other[0], one[1] + other[1], one[2] + other[2]
