# SPDX-License-Identifier: Apache-2.0
"""Stereo camera on the mast: point clouds with range noise, and shaded pictures."""

import math
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Annotated, Literal, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator

from sim.config import ConfigModel, parse_model
from sim.frames import rotation
from sim.raycast import RayCaster
from sim.settle import SettledState
from sim.terrain import Terrain
from sim.vehicle import Vehicle

Array = npt.NDArray[np.float64]
Point = tuple[float, float, float]

# step of the central difference that shades the pictures
SHADE_STEP_M = 0.05


class CameraConfig(ConfigModel):
    """The stereo pair and how it is used.

    Attributes:
        model: Which pair.
        cloud_width_px: Columns of the point cloud.
        cloud_height_px: Rows of the point cloud.
        elevation_deg: Of the mast head; at -30 the image's near edge is 0.9 m ahead of the mast, so
            the ground under the next arc is seen, and its top is still above the horizon.
        azimuths_deg: One pair of images for each, clockwise from forward.
        stereo_image_width_px: Width of the images that are correlated.
        disparity_sigma_px: Standard deviation of the correlation in those pixels; 0 is no noise.
            0.32 was measured on a JPL stereo system (NPO-42487).
        range_min_m: Nearer points are dropped.
        range_max_m: Further points are dropped; at 25 m the range noise is 0.6 m.
    """

    model: Literal["navcam"] = "navcam"
    cloud_width_px: Annotated[int, Field(ge=1, le=5120)] = 320
    cloud_height_px: Annotated[int, Field(ge=1, le=3840)] = 240
    elevation_deg: Annotated[float, Field(ge=-90, le=90)] = -30.0
    azimuths_deg: Annotated[tuple[float, ...], Field(min_length=1, max_length=16)] = (0.0,)
    stereo_image_width_px: Annotated[int, Field(ge=16, le=5120)] = 1280
    disparity_sigma_px: Annotated[float, Field(ge=0, le=100)] = 0.32
    range_min_m: Annotated[float, Field(ge=0, le=100)] = 0.3
    range_max_m: Annotated[float, Field(gt=0, le=1000)] = 25.0

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.range_min_m >= self.range_max_m:
            raise ValueError("range_min_m must be less than range_max_m")
        return self


class StereoPair(ConfigModel):
    """Pinhole pair in the frame of the mast's elevation joint; both look along its x axis."""

    left_center_m: Point
    right_center_m: Point
    fov_horizontal_deg: Annotated[float, Field(gt=0, lt=180)]
    fov_vertical_deg: Annotated[float, Field(gt=0, lt=180)]


@cache
def load_stereo_pair(model: str) -> StereoPair:
    """Built-in pair."""
    text = resources.files("sim.cameras").joinpath(f"{model}.yaml").read_text("utf-8")
    return parse_model(text, f"{model}.yaml", StereoPair)


def pixel_directions(pair: StereoPair, width_px: int, height_px: int) -> Array:
    """Unit vectors [rows * columns, 3] through the pixel centres: x forward, y right, z down."""
    right = math.tan(math.radians(pair.fov_horizontal_deg) / 2)
    down = math.tan(math.radians(pair.fov_vertical_deg) / 2)
    y = right * ((2 * np.arange(width_px) + 1) / width_px - 1)
    z = down * ((2 * np.arange(height_px) + 1) / height_px - 1)
    grid = np.empty((height_px, width_px, 3))
    grid[..., 0] = 1.0
    grid[..., 1] = y[None, :]
    grid[..., 2] = z[:, None]
    directions: Array = grid.reshape(-1, 3)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return directions


def range_sigma_m(
    ranges_m: Array,
    directions: Array,
    baseline_m: Array,
    pixel_sigma_rad: float,
) -> Array:
    """Standard deviation [n] of the range along the left ray, SIM equation (1).

    sigma = pixel_sigma * d / sin(theta), with d the distance to the right camera and theta the
    angle between the cameras seen from the point. By the sine rule d / sin(theta) equals
    d^2 / |baseline x ray|, which stays exact for far points.

    Args:
        ranges_m: Distances [n] from the left camera.
        directions: Unit vectors [n, 3] of the left rays.
        baseline_m: Right minus left camera centre [3], same frame.
        pixel_sigma_rad: Correlation error as an angle: sigma_px / width_px * field of view.
    """
    along = directions @ baseline_m
    baseline2 = float(baseline_m @ baseline_m)
    distance2 = ranges_m**2 - 2.0 * ranges_m * along + baseline2
    height = np.sqrt(np.maximum(baseline2 - along**2, 1e-12))
    sigma: Array = pixel_sigma_rad * distance2 / height
    return sigma


@dataclass(frozen=True, slots=True, eq=False)
class _View:
    """One pointing of the mast, in the rover frame: left centre, baseline, rays [n, 3]."""

    center_m: Array
    baseline_m: Array
    directions: Array


class StereoCamera:
    """A stereo pair on one vehicle on one terrain."""

    def __init__(self, terrain: Terrain, vehicle: Vehicle, config: CameraConfig) -> None:
        """Prepare rays in the rover frame for every azimuth."""
        self._config = config
        self._caster = RayCaster(terrain)
        self._pair = load_stereo_pair(config.model)
        mast_m = np.array(vehicle.geometry.mast_azimuth_m)
        pixels = pixel_directions(self._pair, config.cloud_width_px, config.cloud_height_px)
        elevation_rad = math.radians(config.elevation_deg)
        self._views: list[_View] = []
        for azimuth_deg in config.azimuths_deg:
            mount = rotation(0.0, elevation_rad, math.radians(azimuth_deg))
            left = mast_m + mount @ np.array(self._pair.left_center_m)
            right = mast_m + mount @ np.array(self._pair.right_center_m)
            self._views.append(_View(left, right - left, pixels @ mount.T))

    def image(self, state: SettledState, rng: np.random.Generator) -> npt.NDArray[np.float32]:
        """Point cloud float32 [n, 3] in the true rover frame; empty when the rover is off the map.

        Occlusion is that of the left camera. With noise, points slide along their left rays;
        those that would come out behind the camera are dropped.
        """
        return np.concatenate([self._cloud(state, view, rng) for view in self._views])

    def _ranges_m(self, state: SettledState, view: _View) -> npt.NDArray[np.float32]:
        """Distances along the rays of a view, NaN without ground."""
        attitude = rotation(state.roll_rad, state.pitch_rad, state.yaw_rad)
        origin = np.array([state.x_m, state.y_m, state.z_m]) + attitude @ view.center_m
        return self._caster.ranges_m(origin, view.directions, self._config.range_max_m, attitude)

    def _cloud(
        self, state: SettledState, view: _View, rng: np.random.Generator
    ) -> npt.NDArray[np.float32]:
        config = self._config
        seen_m = self._ranges_m(state, view)
        hit = seen_m >= config.range_min_m  # NaN is no hit
        directions, ranges = view.directions[hit], seen_m[hit].astype(np.float64)
        if config.disparity_sigma_px > 0.0:
            pixel_sigma_rad = (
                config.disparity_sigma_px
                / config.stereo_image_width_px
                * math.radians(self._pair.fov_horizontal_deg)
            )
            sigma = range_sigma_m(ranges, directions, view.baseline_m, pixel_sigma_rad)
            ranges = ranges + sigma * rng.standard_normal(len(ranges))
            directions, ranges = directions[ranges > 0.0], ranges[ranges > 0.0]
        cloud: npt.NDArray[np.float32] = (view.center_m + ranges[:, None] * directions).astype(
            np.float32
        )
        return cloud

    def picture(
        self, state: SettledState, sun_azimuth_deg: float = 300.0, sun_elevation_deg: float = 35.0
    ) -> npt.NDArray[np.uint8]:
        """Shaded grey picture uint8 [rows, columns] of the first azimuth; sky is 255.

        Lambert shading of the terrain's slope, without cast shadows.
        """
        view = self._views[0]
        ranges = self._ranges_m(state, view)
        attitude = rotation(state.roll_rad, state.pitch_rad, state.yaw_rad)
        site = (view.center_m + ranges[:, None] * view.directions) @ attitude.T + [
            state.x_m,
            state.y_m,
            state.z_m,
        ]
        north, east = site[:, 0], site[:, 1]
        height = self._caster.terrain.height_at
        step = SHADE_STEP_M
        down_north = (height(north + step, east) - height(north - step, east)) / (2 * step)
        down_east = (height(north, east + step) - height(north, east - step)) / (2 * step)
        azimuth, elevation = math.radians(sun_azimuth_deg), math.radians(sun_elevation_deg)
        # upward normal of z = f(north, east), z down
        facing = (
            down_north * math.cos(azimuth) * math.cos(elevation)
            + down_east * math.sin(azimuth) * math.cos(elevation)
            + math.sin(elevation)
        ) / np.sqrt(1.0 + down_north**2 + down_east**2)
        grey = 20.0 + 220.0 * np.clip(facing, 0.0, 1.0)
        grey = np.where(np.isnan(grey), 255.0, grey)
        shape = (self._config.cloud_height_px, self._config.cloud_width_px)
        return grey.astype(np.uint8).reshape(shape)
