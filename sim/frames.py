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
