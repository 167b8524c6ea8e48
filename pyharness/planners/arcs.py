# SPDX-License-Identifier: Apache-2.0
"""Arcs as planners without Navlib's tree need them: many at once."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np
import numpy.typing as npt

from pyharness.dp import Message

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Place:
    """Position and heading on the ground, SITE."""

    x_m: float
    y_m: float
    yaw_rad: float

    @classmethod
    def of(cls, pose: Message) -> Self:
        """Return the place of a pose of a record."""
        return cls(float(pose["x_site_m"]), float(pose["y_site_m"]), float(pose["yaw_rad"]))


def arc_points(
    place: Place,
    length_m: npt.ArrayLike,
    heading_rad: npt.ArrayLike,
    spacing_m: float,
    turn_rad: npt.ArrayLike = 0.0,
) -> Floats:
    """Return points [arc, point, north and east], evenly along each arc, the start left out.

    All arcs have as many points as the longest needs; a turn in place stays where it is. `turn_rad`
    is a turn in place before the arc.
    """
    lengths_m = np.atleast_1d(np.asarray(length_m, dtype=np.float64))
    headings_rad = np.atleast_1d(np.asarray(heading_rad, dtype=np.float64))
    count = max(1, math.ceil(np.abs(lengths_m).max() / spacing_m - 1e-9))
    share = np.arange(1, count + 1) / count
    half_rad = 0.5 * np.outer(headings_rad, share)
    chord_m = np.outer(lengths_m, share) * np.sinc(half_rad / np.pi)
    direction_rad = place.yaw_rad + np.reshape(turn_rad, (-1, 1)) + half_rad
    north_m = place.x_m + chord_m * np.cos(direction_rad)
    east_m = place.y_m + chord_m * np.sin(direction_rad)
    return np.stack([north_m, east_m], axis=-1)


def wrapped(angle_rad: float) -> float:
    """Return the angle from -pi to pi."""
    return math.remainder(angle_rad, 2.0 * math.pi)
