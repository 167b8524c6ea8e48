# SPDX-License-Identifier: Apache-2.0
"""Camera models of the CAHV family, and how a wide-angle one becomes a linear one.

CAHV (Yakimovsky and Cunningham 1978) is a pinhole: a point P at d = P - C is seen at column
d.H / d.A and row d.V / d.A. CAHVORE (Gennery 2006) adds the radial distortion R about an axis O, an
entrance pupil E that moves with the angle, and a linearity L between a perspective lens (1) and one
that is even in angle (0). Pixel (0, 0) is the middle of the first pixel.

Rovers match linearised images. `linearised` makes their model as follows: the centre stays; the
axis is the real ray through the middle of the image; image right is where the real right half of
the middle row points; and the linear image takes as much of the scene, in angle, as the real one
along its middle row and its middle column. The pupil's wandering, under 5 mm, is left out.
"""

import math
from dataclasses import dataclass
from typing import Annotated, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator

from sim.config import ConfigModel

Array = npt.NDArray[np.float64]
Vector = tuple[float, float, float]
Pixels = Annotated[int, Field(ge=2, le=100_000)]

NEWTON_STEPS = 20


class Cahvore(ConfigModel):
    """A CAHVORE model as its calibration file has it, in the frame of what carries the camera."""

    c: Vector
    a: Vector
    h: Vector
    v: Vector
    o: Vector
    r: Vector
    e: Vector
    linearity: Annotated[float, Field(gt=0, le=1)]
    width_px: Pixels
    height_px: Pixels

    @model_validator(mode="after")
    def _check(self) -> Self:
        for name, axis in (("a", self.a), ("o", self.o)):
            if abs(math.hypot(*axis) - 1.0) > 1e-3:
                raise ValueError(f"{name} must be a unit vector")
        return self


@dataclass(frozen=True, slots=True, eq=False)
class Cahv:
    """A linear camera."""

    c: Array
    a: Array
    h: Array
    v: Array
    width_px: int
    height_px: int

    @property
    def fov_rad(self) -> tuple[float, float]:
        """Angles across the middle row and the middle column, edge to edge."""
        angles = []
        for axis, size_px in ((self.h, self.width_px), (self.v, self.height_px)):
            middle_px = float(axis @ self.a)
            focal_px = float(np.linalg.norm(np.cross(self.a, axis)))
            low, high = middle_px + 0.5, size_px - 0.5 - middle_px
            angles.append(math.atan(low / focal_px) + math.atan(high / focal_px))
        return angles[0], angles[1]

    def directions(self, width_px: int, height_px: int) -> Array:
        """Unit vectors [rows * columns, 3] of the same view in another number of pixels."""
        col = (np.arange(width_px, dtype=np.float64) + 0.5) * (self.width_px / width_px) - 0.5
        row = (np.arange(height_px, dtype=np.float64) + 0.5) * (self.height_px / height_px) - 0.5
        rays = _cahv_rays(self.a, self.h, self.v, col[None, :, None], row[:, None, None])
        directions: Array = np.ascontiguousarray(rays.reshape(-1, 3))
        return directions

    def turned(self, rotation: Array, origin_m: Array) -> "Cahv":
        """The same camera in the frame that `rotation` and `origin_m` lead to."""
        return Cahv(
            origin_m + rotation @ self.c,
            rotation @ self.a,
            rotation @ self.h,
            rotation @ self.v,
            self.width_px,
            self.height_px,
        )


def project(model: Cahv, points: Array) -> Array:
    """Columns and rows [n, 2] at which points [n, 3] are seen; NaN behind the camera."""
    d = points - model.c
    depth = d @ model.a
    depth = np.where(depth > 0.0, depth, np.nan)
    return np.stack([d @ model.h / depth, d @ model.v / depth], axis=-1)


def pinhole(
    center_m: Vector, fov_horizontal_deg: float, fov_vertical_deg: float, size_px: tuple[int, int]
) -> Cahv:
    """Camera that looks along x, with y to its right and z down."""
    width_px, height_px = size_px
    forward, right, down = np.eye(3)
    return Cahv(
        np.array(center_m),
        forward,
        _axis(forward, right, math.radians(fov_horizontal_deg), width_px),
        _axis(forward, down, math.radians(fov_vertical_deg), height_px),
        width_px,
        height_px,
    )


def linearised(model: Cahvore) -> Cahv:
    """CAHV model of the images that matching works on: see the top of this module."""
    last_col, last_row = model.width_px - 1, model.height_px - 1
    middle_col, middle_row = 0.5 * last_col, 0.5 * last_row
    # the image's edges are half a pixel beyond the middles of its outer pixels
    left, right = (rays(model, col, middle_row) for col in (-0.5, last_col + 0.5))
    upper, lower = (rays(model, middle_col, row) for row in (-0.5, last_row + 0.5))
    forward = rays(model, middle_col, middle_row)
    to_right = _unit(right - (right @ forward) * forward)
    down = np.cross(forward, to_right)
    return Cahv(
        np.array(model.c),
        forward,
        _axis(forward, to_right, _angle(left, forward) + _angle(right, forward), model.width_px),
        _axis(forward, down, _angle(upper, forward) + _angle(lower, forward), model.height_px),
        model.width_px,
        model.height_px,
    )


def rays(model: Cahvore, col: npt.ArrayLike, row: npt.ArrayLike) -> Array:
    """Unit vectors [..., 3] along which pixels look."""
    a, h, v = (np.array(axis) for axis in (model.a, model.h, model.v))
    o = _unit(np.array(model.o))
    ideal = _cahv_rays(a, h, v, np.asarray(col)[..., None], np.asarray(row)[..., None])
    along = ideal @ o
    across = ideal - along[..., None] * o
    distance = np.linalg.norm(across, axis=-1)
    theta = _undistorted_angle(model, distance / along)
    with np.errstate(invalid="ignore"):
        side = np.where(distance[..., None] > 1e-12, across / distance[..., None], 0.0)
    result: Array = np.sin(theta)[..., None] * side + np.cos(theta)[..., None] * o
    return result


def _undistorted_angle(model: Cahvore, seen: Array) -> Array:
    """Angle from the axis O: Newton on (1 + r0) x + r1 x^3 + r2 x^5 = seen, then L x = tan(L t)."""
    r0, r1, r2 = model.r
    x = np.array(seen, dtype=np.float64)
    for _ in range(NEWTON_STEPS):
        error = (1.0 + r0) * x + r1 * x**3 + r2 * x**5 - seen
        x = x - error / (1.0 + r0 + 3.0 * r1 * x**2 + 5.0 * r2 * x**4)
    angle: Array = np.arctan(model.linearity * x) / model.linearity
    return angle


def _cahv_rays(a: Array, h: Array, v: Array, col: Array, row: Array) -> Array:
    """Unit vectors of pixels: across both (V - row A) and (H - col A), in front of the camera."""
    ray = np.cross(v - row * a, h - col * a)
    ray = ray if float(np.cross(v, h) @ a) > 0.0 else -ray
    unit: Array = ray / np.linalg.norm(ray, axis=-1, keepdims=True)
    return unit


def _axis(forward: Array, side: Array, fov_rad: float, size_px: int) -> Array:
    """H or V of a camera whose image of size_px spans an angle, its middle straight ahead."""
    focal_px = 0.5 * size_px / math.tan(0.5 * fov_rad)
    axis: Array = focal_px * side + 0.5 * (size_px - 1) * forward
    return axis


def _unit(vector: Array) -> Array:
    unit: Array = vector / np.linalg.norm(vector)
    return unit


def _angle(one: Array, other: Array) -> float:
    return math.atan2(float(np.linalg.norm(np.cross(one, other))), float(one @ other))
