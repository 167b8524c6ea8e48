# SPDX-License-Identifier: Apache-2.0
"""What the executive needs of a world. `sim` offers it without knowing of this module."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
import numpy.typing as npt


class Pose(Protocol):
    """A pose in SITE: x north, y east, z down."""

    @property
    def x_m(self) -> float: ...  # noqa: D102
    @property
    def y_m(self) -> float: ...  # noqa: D102
    @property
    def z_m(self) -> float: ...  # noqa: D102
    @property
    def roll_rad(self) -> float: ...  # noqa: D102
    @property
    def pitch_rad(self) -> float: ...  # noqa: D102
    @property
    def yaw_rad(self) -> float: ...  # noqa: D102


class Estimate(Pose, Protocol):
    """What the rover believes, and how much it trusts it."""

    @property
    def sigma_position_m(self) -> float:
        """Standard deviation of the position in SITE."""
        ...

    @property
    def sigma_local_m(self) -> float:
        """Standard deviation of the motion since the last VO fix."""
        ...


class Truth(Pose, Protocol):
    """The settled rover; off the map only its position is known."""

    @property
    def rocker_rad(self) -> float: ...  # noqa: D102
    @property
    def bogie_left_rad(self) -> float: ...  # noqa: D102
    @property
    def bogie_right_rad(self) -> float: ...  # noqa: D102
    @property
    def tilt_rad(self) -> float: ...  # noqa: D102
    @property
    def clearance_m(self) -> float: ...  # noqa: D102
    @property
    def wheel_drop_m(self) -> float: ...  # noqa: D102
    @property
    def slip(self) -> float: ...  # noqa: D102
    @property
    def distance_driven_m(self) -> float: ...  # noqa: D102
    @property
    def residual_m(self) -> float: ...  # noqa: D102
    @property
    def contact_site_m(self) -> npt.NDArray[np.float64]: ...  # noqa: D102
    @property
    def converged(self) -> bool: ...  # noqa: D102
    @property
    def on_map(self) -> bool: ...  # noqa: D102


class ExpectedSlip(Protocol):
    """What slip is expected to add to a commanded motion."""

    @property
    def north_m(self) -> float: ...  # noqa: D102
    @property
    def east_m(self) -> float: ...  # noqa: D102
    @property
    def sigma_m(self) -> float:
        """Standard deviation of the position around the mean."""
        ...

    @property
    def yaw_sigma_rad(self) -> float:
        """Standard deviation of the heading."""
        ...


class World(Protocol):
    """A rover on terrain, moved in steps of one tick."""

    @property
    def time_s(self) -> float:
        """Simulated time."""
        ...

    @property
    def estimate(self) -> Estimate:
        """The pose from odometry, IMU and VO."""
        ...

    @property
    def arc_done(self) -> bool:
        """Whether the commanded arc has been driven."""
        ...

    @property
    def arc_fraction(self) -> float:
        """The commanded part of the arc, 0 to 1."""
        ...

    def slip_ahead(self, length_m: float, heading_change_rad: float) -> ExpectedSlip:
        """Return what slip is expected to add to an arc from here."""
        ...

    def sigma_position_after_m(self, distance_m: float) -> float:
        """Return what the position sigma grows to over so much more motion without a fix."""
        ...

    def start_arc(self, length_m: float, heading_change_rad: float) -> None:
        """Command an arc, or a turn in place."""
        ...

    def step(self) -> Truth:
        """Advance by one tick, driving or standing; return the truth."""
        ...

    def stop(self) -> None:
        """Give up the rest of the arc."""
        ...

    def visual_odometry(self) -> bool:
        """Correct the estimate; False when it finds no fix."""
        ...

    def image(self, azimuths_deg: Sequence[float] | None = None) -> npt.NDArray[np.float32]:
        """Return the point cloud [n, 3] seen now, in the rover frame.

        One pair of images for each azimuth of the mast; where it always looks when None.
        """
        ...

    def ground_around(self, radius_m: float) -> npt.NDArray[np.float32]:
        """Return the true ground within a radius as a point cloud [n, 3] in the rover frame."""
        ...

    def place(self, north_m: float, east_m: float, yaw_rad: float) -> Truth:
        """Set the rover down somewhere else."""
        ...

    def steering_duration_s(self, curvature_from: float, curvature_to: float) -> float:
        """Return the time to turn the wheels; an infinite curvature is that of a turn in place."""
        ...
