# SPDX-License-Identifier: Apache-2.0
"""Stereo camera on the mast: point clouds as matching would give them, and shaded pictures."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Annotated, Literal, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator

from sim.camera_model import Cahv, Cahvore, linearised, pinhole
from sim.config import ConfigModel, parse_model
from sim.frames import rotation
from sim.raycast import RayCaster
from sim.settle import SettledState
from sim.stereo_noise import correlated_field, dropouts, slid_points_m
from sim.terrain import Terrain
from sim.vehicle import Vehicle

Array = npt.NDArray[np.float64]
Point = tuple[float, float, float]
AzimuthDeg = Annotated[float, Field(ge=-360, le=360)]

# step of the central difference that shades the pictures
SHADE_STEP_M = 0.05
GREY_SKY, GREY_ROVER = 255, 0
# pointings of the mast whose rays are kept
VIEWS_MAX = 16


class PinholeConfig(ConfigModel):
    """A pair of equal pinholes in the frame of the mast's elevation joint, looking along its x.

    The defaults stand where the NavCams do, with their published field of view (Maki et al. 2020).
    """

    left_center_m: Point = (0.12848, -0.214947, -0.056891)
    right_center_m: Point = (0.130325, 0.209431, -0.057282)
    fov_horizontal_deg: Annotated[float, Field(gt=0, lt=170)] = 96.0
    fov_vertical_deg: Annotated[float, Field(gt=0, lt=170)] = 73.0

    @model_validator(mode="after")
    def _check(self) -> Self:
        if math.dist(self.left_center_m, self.right_center_m) < 1e-3:
            raise ValueError("left_center_m and right_center_m must be at least 1 mm apart")
        return self


class CameraConfig(ConfigModel):
    """The stereo pair and how it is used.

    Attributes:
        model: navcam: the pair of Perseverance, linearised; pinhole: the pair under `pinhole`.
        cloud_width_px: Columns of the point cloud.
        cloud_height_px: Rows of the point cloud.
        elevation_deg: Of the mast head; at -30 the image's near edge is 0.9 m ahead of the mast, so
            the ground under the next arc is seen, and its top is still above the horizon.
        azimuths_deg: One pair of images for each, clockwise from forward.
        stereo_image_width_px: Width of the images that are correlated.
        disparity_sigma_px: Standard deviation of the correlation in those pixels; 0 is no noise.
            0.32 was measured on a JPL stereo system (NPO-42487).
        disparity_correlated_sigma_px: Of a further error that neighbouring pixels share, so that it
            does not average out within a map cell. Off: no number is published.
        dropout_fraction: Share of the image that finds no match, in patches. Off.
        correlation_length_px: In those pixels: where the correlation of both falls to 1/e.
        self_occlusion: Whether rays that hit the rover's deck are lost.
        range_min_m: Nearer points are dropped.
        range_max_m: Further points are dropped; at 25 m the range noise is 0.6 m.
        sun_azimuth_deg: Of the pictures, clockwise from north.
        sun_elevation_deg: Of the pictures, above the horizon.
    """

    model: Literal["navcam", "pinhole"] = "navcam"
    pinhole: PinholeConfig = PinholeConfig()
    cloud_width_px: Annotated[int, Field(ge=1, le=5120)] = 320
    cloud_height_px: Annotated[int, Field(ge=1, le=3840)] = 240
    elevation_deg: Annotated[float, Field(ge=-90, le=90)] = -30.0
    azimuths_deg: Annotated[tuple[AzimuthDeg, ...], Field(min_length=1, max_length=16)] = (0.0,)
    stereo_image_width_px: Annotated[int, Field(ge=16, le=5120)] = 1280
    disparity_sigma_px: Annotated[float, Field(ge=0, le=100)] = 0.32
    disparity_correlated_sigma_px: Annotated[float, Field(ge=0, le=100)] = 0.0
    dropout_fraction: Annotated[float, Field(ge=0, le=1)] = 0.0
    correlation_length_px: Annotated[float, Field(ge=1, le=1000)] = 32.0
    self_occlusion: bool = True
    range_min_m: Annotated[float, Field(ge=0, le=100)] = 0.3
    range_max_m: Annotated[float, Field(gt=0, le=1000)] = 25.0
    sun_azimuth_deg: AzimuthDeg = 300.0
    sun_elevation_deg: Annotated[float, Field(ge=0, le=90)] = 35.0

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.range_min_m >= self.range_max_m:
            raise ValueError("range_min_m must be less than range_max_m")
        return self


class NavCams(ConfigModel):
    """Calibration of a real pair."""

    left: Cahvore
    right: Cahvore


@cache
def load_navcams() -> NavCams:
    """The built-in pair."""
    text = resources.files("sim.cameras").joinpath("navcam.yaml").read_text("utf-8")
    return parse_model(text, "navcam.yaml", NavCams)


def camera_pair(config: CameraConfig) -> tuple[Cahv, Cahv]:
    """Left and right camera in the frame of the mast's elevation joint."""
    if config.model == "navcam":
        pair = load_navcams()
        return linearised(pair.left), linearised(pair.right)
    part, size_px = config.pinhole, (config.cloud_width_px, config.cloud_height_px)
    left, right = (
        pinhole(center_m, part.fov_horizontal_deg, part.fov_vertical_deg, size_px)
        for center_m in (part.left_center_m, part.right_center_m)
    )
    return left, right


@dataclass(frozen=True, slots=True, eq=False)
class _View:
    """One pointing of the mast, in the rover frame.

    Attributes:
        center_m: Left centre [3].
        baseline_m: Right minus left centre [3].
        pixels: Indices [n] of the pixels that the rover does not hide.
        directions: Their unit vectors [n, 3].
    """

    center_m: Array
    baseline_m: Array
    pixels: npt.NDArray[np.intp]
    directions: Array


class StereoCamera:
    """A stereo pair on one vehicle on one terrain."""

    def __init__(self, terrain: Terrain, vehicle: Vehicle, config: CameraConfig) -> None:
        """Prepare the terrain for rays; those of a pointing are made when it is first used."""
        self._config = config
        self._vehicle = vehicle
        self._caster = RayCaster(terrain)
        self._left, self._right = camera_pair(config)
        self._views: dict[float, _View] = {}

    def image(
        self,
        state: SettledState,
        rng: np.random.Generator,
        azimuths_deg: Sequence[float] | None = None,
    ) -> npt.NDArray[np.float32]:
        """Point cloud float32 [n, 3] in the true rover frame; empty when the rover is off the map.

        Of all pairs of images together, one for each azimuth; those of the configuration when None.
        Occlusion is that of the left camera. With noise, points slide along their left rays;
        those that would come out behind the camera are dropped.
        """
        azimuths_deg = self._config.azimuths_deg if azimuths_deg is None else azimuths_deg
        clouds = [self._cloud(state, self._view(azimuth_deg), rng) for azimuth_deg in azimuths_deg]
        return np.concatenate(clouds) if clouds else np.empty((0, 3), dtype=np.float32)

    def picture(
        self,
        state: SettledState,
        azimuth_deg: float | None = None,
        sun_azimuth_deg: float | None = None,
        sun_elevation_deg: float | None = None,
    ) -> npt.NDArray[np.uint8]:
        """Shaded grey picture uint8 [rows, columns] of the left camera; what is None is configured.

        Lambert shading of the terrain's slope, without cast shadows. Sky is 255, the rover 0.
        """
        config = self._config
        view = self._view(config.azimuths_deg[0] if azimuth_deg is None else azimuth_deg)
        site = self._seen_site_m(state, view)
        facing = self._facing(
            site,
            math.radians(config.sun_azimuth_deg if sun_azimuth_deg is None else sun_azimuth_deg),
            math.radians(
                config.sun_elevation_deg if sun_elevation_deg is None else sun_elevation_deg
            ),
        )
        grey = 20.0 + 220.0 * np.clip(facing, 0.0, 1.0)
        picture = np.full(config.cloud_height_px * config.cloud_width_px, GREY_ROVER, np.uint8)
        picture[view.pixels] = np.where(np.isnan(grey), GREY_SKY, grey).astype(np.uint8)
        return picture.reshape(config.cloud_height_px, config.cloud_width_px)

    def _view(self, azimuth_deg: float) -> _View:
        view = self._views.get(azimuth_deg)
        if view is None:
            if len(self._views) >= VIEWS_MAX:
                self._views.clear()
            view = self._views[azimuth_deg] = self._new_view(azimuth_deg)
        return view

    def _new_view(self, azimuth_deg: float) -> _View:
        """Rays of one pointing, without those that end on the rover."""
        config = self._config
        mast_m = np.array(self._vehicle.geometry.mast_azimuth_m)
        mount = rotation(0.0, math.radians(config.elevation_deg), math.radians(azimuth_deg))
        left = self._left.turned(mount, mast_m)
        right = self._right.turned(mount, mast_m)
        directions = left.directions(config.cloud_width_px, config.cloud_height_px)
        seen = np.ones(len(directions), dtype=np.bool_)
        if config.self_occlusion:
            seen = ~_hits_deck(left.c, directions, self._vehicle)
        return _View(left.c, right.c - left.c, np.flatnonzero(seen), directions[seen])

    def _ranges_m(self, state: SettledState, view: _View) -> npt.NDArray[np.float32]:
        """Distances along the rays of a view, NaN without ground."""
        attitude = rotation(state.roll_rad, state.pitch_rad, state.yaw_rad)
        origin = np.array([state.x_m, state.y_m, state.z_m]) + attitude @ view.center_m
        return self._caster.ranges_m(origin, view.directions, self._config.range_max_m, attitude)

    def _cloud(
        self, state: SettledState, view: _View, rng: np.random.Generator
    ) -> npt.NDArray[np.float32]:
        config = self._config
        ranges = self._ranges_m(state, view)
        ranges[ranges < config.range_min_m] = np.nan
        if config.dropout_fraction > 0.0:
            lost = dropouts(config.dropout_fraction, self._shape, self._correlation_length_px, rng)
            ranges[lost.ravel()[view.pixels]] = np.nan
        return slid_points_m(
            ranges,
            view.directions,
            view.center_m,
            view.baseline_m,
            self._left.fov_rad[0] / config.stereo_image_width_px,
            self._error_px(view.pixels, ~np.isnan(ranges), rng),
        )

    def _error_px(
        self,
        pixels: npt.NDArray[np.intp],
        seen: npt.NDArray[np.bool_],
        rng: np.random.Generator,
    ) -> Array | None:
        """Error of matching of those pixels that are seen; None without one."""
        config = self._config
        error_px: Array | None = None
        if config.disparity_correlated_sigma_px > 0.0:
            field = correlated_field(self._shape, self._correlation_length_px, rng).ravel()
            error_px = config.disparity_correlated_sigma_px * field[pixels[seen]]
        if config.disparity_sigma_px > 0.0:
            own_px = config.disparity_sigma_px * rng.standard_normal(np.count_nonzero(seen))
            error_px = own_px if error_px is None else error_px + own_px
        return error_px

    @property
    def _shape(self) -> tuple[int, int]:
        return self._config.cloud_height_px, self._config.cloud_width_px

    @property
    def _correlation_length_px(self) -> tuple[float, float]:
        """Down and across, in pixels of the cloud; the images that are matched have its shape."""
        config = self._config
        share = config.correlation_length_px / config.stereo_image_width_px
        across = share * config.cloud_width_px
        squeeze = (self._left.height_px / config.cloud_height_px) / (
            self._left.width_px / config.cloud_width_px
        )
        return across / squeeze, across

    def _seen_site_m(self, state: SettledState, view: _View) -> Array:
        """Points [n, 3] that the pixels of a view see, in SITE."""
        attitude = rotation(state.roll_rad, state.pitch_rad, state.yaw_rad)
        ranges = self._ranges_m(state, view).astype(np.float64)
        rover: Array = view.center_m + ranges[:, None] * view.directions
        site: Array = rover @ attitude.T + [state.x_m, state.y_m, state.z_m]
        return site

    def _facing(self, site_m: Array, sun_azimuth_rad: float, sun_elevation_rad: float) -> Array:
        """Cosine [n] between the ground's normal and the sun."""
        north, east = site_m[:, 0], site_m[:, 1]
        height, step = self._caster.terrain.height_at, SHADE_STEP_M
        down_north = (height(north + step, east) - height(north - step, east)) / (2 * step)
        down_east = (height(north, east + step) - height(north, east - step)) / (2 * step)
        # upward normal of z = f(north, east), z down
        facing: Array = (
            down_north * math.cos(sun_azimuth_rad) * math.cos(sun_elevation_rad)
            + down_east * math.sin(sun_azimuth_rad) * math.cos(sun_elevation_rad)
            + math.sin(sun_elevation_rad)
        ) / np.sqrt(1.0 + down_north**2 + down_east**2)
        return facing


def _hits_deck(center_m: Array, directions: Array, vehicle: Vehicle) -> npt.NDArray[np.bool_]:
    """Rays [n] from a point that enter the box between belly and deck."""
    deck = vehicle.deck
    if deck is None:
        return np.zeros(len(directions), dtype=np.bool_)
    low = np.array([deck.rear_m, -deck.half_width_m, -deck.height_m])
    high = np.array([deck.front_m, deck.half_width_m, -vehicle.belly.height_m])
    with np.errstate(divide="ignore", invalid="ignore"):
        one, other = (low - center_m) / directions, (high - center_m) / directions
    enters = np.fmin(one, other).max(axis=1)
    leaves = np.fmax(one, other).min(axis=1)
    hits: npt.NDArray[np.bool_] = (leaves >= enters) & (leaves > 0.0)
    return hits
