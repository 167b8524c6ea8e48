# SPDX-License-Identifier: Apache-2.0
"""The vehicle file: geometry, drive rates and limits, shared by the simulator and Navlib."""

import math
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator

from sim.config import ConfigModel, load_model, parse_model

VEHICLE_DEFAULT = "perseverance"

Point = tuple[float, float, float]
PositiveM = Annotated[float, Field(gt=0, le=100)]
AngleLimitDeg = Annotated[float, Field(gt=0, lt=90)]


class Geometry(ConfigModel):
    """Joints and hubs of the left side in the rover frame, all joints at zero, metres."""

    rocker_pivot_left_m: Point
    bogie_pivot_left_m: Point
    hub_left_front_m: Point
    hub_left_middle_m: Point
    hub_left_rear_m: Point
    mast_azimuth_m: Point
    wheel_radius_m: PositiveM
    wheel_width_m: PositiveM

    @model_validator(mode="after")
    def _check(self) -> Self:
        left = (self.hub_left_front_m, self.hub_left_middle_m, self.hub_left_rear_m)
        if not left[0][0] > left[1][0] > left[2][0]:
            raise ValueError("the hubs must lie front, middle, rear along x")
        if any(hub[1] >= 0 for hub in left):
            raise ValueError("the left hubs must have a negative y (y points right)")
        return self


class Belly(ConfigModel):
    """The belly pan as a box: its lower face, `height_m` above the frame's origin plane."""

    front_m: float
    rear_m: float
    half_width_m: PositiveM
    height_m: PositiveM

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.rear_m >= self.front_m:
            raise ValueError("rear_m must be less than front_m")
        return self


class Deck(ConfigModel):
    """The body as the cameras see it: a box from the belly pan up to the deck."""

    front_m: float
    rear_m: float
    half_width_m: PositiveM
    height_m: PositiveM

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.rear_m >= self.front_m:
            raise ValueError("rear_m must be less than front_m")
        return self


class Settling(ConfigModel):
    """How wheels touch the ground, and when settling has converged."""

    wheel: Literal["point", "disc", "cylinder"] = "disc"
    tolerance_m: Annotated[float, Field(ge=1e-9, le=0.01)] = 1e-4
    iterations_max: Annotated[int, Field(ge=1, le=1000)] = 40


class Drive(ConfigModel):
    """Rates of the actuators."""

    wheel_speed_max_m_s: PositiveM
    steering_rate_deg_s: Annotated[float, Field(gt=0, le=360)]


class FaultLimits(ConfigModel):
    """What the true rover must keep; beyond it operators would call a fault."""

    clearance_min_m: float
    tilt_max_deg: AngleLimitDeg
    rocker_max_deg: AngleLimitDeg
    bogie_max_deg: AngleLimitDeg
    wheel_drop_max_m: PositiveM


class NavlibLimits(ConfigModel):
    """What the navigation software keeps."""

    clearance_margin_m: PositiveM
    tilt_max_deg: AngleLimitDeg
    rocker_max_deg: AngleLimitDeg
    bogie_max_deg: AngleLimitDeg
    wheel_drop_max_m: PositiveM


class Vehicle(ConfigModel):
    """One vehicle, as its YAML file says.

    Attributes:
        deck: What hides the ground from the cameras; without it nothing does.
    """

    name: str
    geometry: Geometry
    belly: Belly
    deck: Deck | None = None
    settling: Settling = Settling()
    drive: Drive
    fault_limits: FaultLimits
    navlib_limits: NavlibLimits

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.deck is not None and self.deck.height_m <= self.belly.height_m:
            raise ValueError("deck.height_m must be more than belly.height_m")
        return self

    @property
    def hubs_m(self) -> npt.NDArray[np.float64]:
        """Hubs [6, 3] in the rover frame: LF, LM, LR, RF, RM, RR."""
        part = self.geometry
        left = np.array([part.hub_left_front_m, part.hub_left_middle_m, part.hub_left_rear_m])
        return np.vstack([left, left * [1.0, -1.0, 1.0]])

    @property
    def rocker_pivots_m(self) -> npt.NDArray[np.float64]:
        """Rocker pivots [2, 3] in the rover frame: left, right."""
        left = np.array(self.geometry.rocker_pivot_left_m)
        return np.vstack([left, left * [1.0, -1.0, 1.0]])

    @property
    def bogie_pivots_m(self) -> npt.NDArray[np.float64]:
        """Bogie pivots [2, 3] in the rover frame: left, right."""
        left = np.array(self.geometry.bogie_pivot_left_m)
        return np.vstack([left, left * [1.0, -1.0, 1.0]])

    @property
    def steering_rate_rad_s(self) -> float:
        """Steering rate of a corner wheel."""
        return math.radians(self.drive.steering_rate_deg_s)


def load_vehicle(
    name_or_path: str | Path = VEHICLE_DEFAULT, overrides: Mapping[str, object] | None = None
) -> Vehicle:
    """Vehicle from a file, or a built-in one by its bare name."""
    if str(name_or_path) == VEHICLE_DEFAULT:
        text = (
            resources.files("sim.vehicles").joinpath(f"{VEHICLE_DEFAULT}.yaml").read_text("utf-8")
        )
        return parse_model(text, f"{VEHICLE_DEFAULT}.yaml", Vehicle, overrides)
    return load_model(name_or_path, Vehicle, overrides)
