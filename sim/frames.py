# SPDX-License-Identifier: Apache-2.0
"""Attitude: R = Rz(yaw) Ry(pitch) Rx(roll) maps the rover frame to SITE."""

import math

import numpy as np
import numpy.typing as npt


def rotation(roll_rad: float, pitch_rad: float, yaw_rad: float) -> npt.NDArray[np.float64]:
    """Rotation matrix [3, 3] from rover to SITE; pitch is positive nose up."""
    cr, sr = math.cos(roll_rad), math.sin(roll_rad)
    cp, sp = math.cos(pitch_rad), math.sin(pitch_rad)
    cy, sy = math.cos(yaw_rad), math.sin(yaw_rad)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def turned(
    roll_rad: float, pitch_rad: float, yaw_rad: float, vector: tuple[float, float, float]
) -> tuple[float, float, float]:
    """`rotation(...) @ vector`, for one vector at a time."""
    cr, sr = math.cos(roll_rad), math.sin(roll_rad)
    cp, sp = math.cos(pitch_rad), math.sin(pitch_rad)
    cy, sy = math.cos(yaw_rad), math.sin(yaw_rad)
    x, y, z = vector
    y, z = cr * y - sr * z, sr * y + cr * z
    x, z = cp * x + sp * z, cp * z - sp * x
    return cy * x - sy * y, sy * x + cy * y, z


def turned_back(
    roll_rad: float, pitch_rad: float, yaw_rad: float, vector: tuple[float, float, float]
) -> tuple[float, float, float]:
    """`rotation(...).T @ vector`, for one vector at a time."""
    cr, sr = math.cos(roll_rad), math.sin(roll_rad)
    cp, sp = math.cos(pitch_rad), math.sin(pitch_rad)
    cy, sy = math.cos(yaw_rad), math.sin(yaw_rad)
    x, y, z = vector
    x, y = cy * x + sy * y, cy * y - sy * x
    x, z = cp * x - sp * z, sp * x + cp * z
    return x, cr * y + sr * z, cr * z - sr * y
