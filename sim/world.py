# SPDX-License-Identifier: Apache-2.0
"""HDSim: the rover in its terrain, driven along arcs in steps of an eighth of a second."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sim.camera import CameraConfig, StereoCamera
from sim.frames import rotation
from sim.kinematics import Arc, duration_s, pose_along, steering_duration_s, wheel_path_m
from sim.localization import Localization, NoiseConfig, PoseEstimate
from sim.random_streams import rng_for
from sim.settle import SettledState, Settler
from sim.slip import ExpectedSlip, SlipConfig, SlipModel
from sim.terrain import Terrain
from sim.vehicle import Vehicle

STEPS_PER_SECOND = 8
# a wheel further from the ground than this is not settled: the pose is no truth any more
UNSETTLED_M = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class TruthState(SettledState):
    """The true rover at one instant.

    Attributes:
        time_s: Simulated time.
        slip: Longitudinal slip of the last step, 1 - actual / commanded.
        distance_driven_m: Horizontal path of the rover's origin so far.
    """

    time_s: float
    slip: float
    distance_driven_m: float


@dataclass(frozen=True, slots=True)
class _Motion:
    """An arc being driven."""

    arc: Arc
    start: tuple[float, float, float]
    duration_s: float
    wheel_path_m: float


class World:
    """One rover on one terrain; every source of chance has its own stream of the seed."""

    def __init__(
        self,
        terrain: Terrain,
        vehicle: Vehicle,
        camera: CameraConfig | None = None,
        noise: NoiseConfig | None = None,
        slip: SlipConfig | None = None,
        start: tuple[float, float, float] = (0.0, 0.0, 0.0),
        seed: int = 0,
    ) -> None:
        """Settle the rover at start = (north, east, yaw)."""
        self.terrain = terrain
        self.vehicle = vehicle
        self._settling = Settler(terrain, vehicle).chain()
        self._camera = StereoCamera(terrain, vehicle, camera or CameraConfig())
        self._camera_rng = rng_for(seed, "camera")
        self._slip = SlipModel(slip or SlipConfig(), rng_for(seed, "slip"))
        self._ticks = 0
        self._distance_m = 0.0
        self._motion: _Motion | None = None
        self._motion_ticks = 0
        # what slip has added to the commanded pose since the start of the arc
        self._offset = (0.0, 0.0, 0.0)
        self._truth = self._settled_at(*start, slip=0.0)
        self._noise = noise or NoiseConfig()
        self._localization_rng = rng_for(seed, "localization")
        self._localization = Localization(self._noise, self._truth, self._localization_rng)

    # -------------------------------------------------------------- state

    @property
    def time_s(self) -> float:
        """Simulated time, exact: an integer count of eighths of a second."""
        return self._ticks / STEPS_PER_SECOND

    @property
    def truth(self) -> TruthState:
        """The true state."""
        return self._truth

    @property
    def estimate(self) -> PoseEstimate:
        """What the rover believes."""
        return self._localization.estimate

    @property
    def arc_done(self) -> bool:
        """Whether there is nothing left to drive."""
        return self.arc_fraction >= 1.0

    @property
    def arc_fraction(self) -> float:
        """Driven share of the arc; 1 when standing."""
        if self._motion is None:
            return 1.0
        return _fraction(self._motion, self._motion_ticks)

    def expected_slip(self, tilt_rad: float) -> float:
        """Mean slip of the present terrain class when driving up a slope."""
        return self._slip.expected(tilt_rad, self._class_number(self._truth))

    def sigma_position_after_m(self, distance_m: float) -> float:
        """What the estimate's position sigma grows to over so much more motion without a fix."""
        return self._localization.sigma_position_after_m(distance_m)

    def slip_ahead(self, length_m: float, heading_change_rad: float) -> ExpectedSlip:
        """What slip is expected to add to an arc from here, on ground like that under the rover.

        From what the rover knows: its estimated attitude and the class of the ground it is on.
        """
        here, arc = self.estimate, Arc(length_m, heading_change_rad)
        start = (0.0, 0.0, here.yaw_rad)
        north_m, east_m, _ = pose_along(start, arc, 1.0)
        middle_yaw_rad = here.yaw_rad + 0.5 * heading_change_rad
        return self._slip.expect(
            (north_m, east_m),
            wheel_path_m(arc, self.vehicle),
            (here.roll_rad, here.pitch_rad, middle_yaw_rad),
            self._class_number(self._truth),
        )

    # -------------------------------------------------------------- commands

    def steering_duration_s(self, curvature_from: float, curvature_to: float) -> float:
        """Time to steer from one curvature (1/m) to another; infinity is a turn in place."""
        return steering_duration_s(curvature_from, curvature_to, self.vehicle)

    def arc_duration_s(self, length_m: float, heading_change_rad: float) -> float:
        """Time to drive an arc, without steering."""
        return duration_s(Arc(length_m, heading_change_rad), self.vehicle)

    def start_arc(self, length_m: float, heading_change_rad: float) -> None:
        """Drive this arc from where the rover is; length 0 turns in place."""
        if not (math.isfinite(length_m) and math.isfinite(heading_change_rad)):
            raise ValueError(f"arc of {length_m} m and {heading_change_rad} rad is not finite")
        arc = Arc(length_m, heading_change_rad)
        start = (self._truth.x_m, self._truth.y_m, self._truth.yaw_rad)
        self._motion = _Motion(
            arc, start, duration_s(arc, self.vehicle), wheel_path_m(arc, self.vehicle)
        )
        self._motion_ticks = 0
        self._offset = (0.0, 0.0, 0.0)

    def stop(self) -> None:
        """Forget the rest of the arc."""
        self._motion = None

    def wait(self, duration_s: float) -> None:
        """Stand for a while, rounded up to whole steps."""
        if not duration_s >= 0.0:
            raise ValueError(f"cannot wait {duration_s} s")
        ticks = math.ceil(duration_s * STEPS_PER_SECOND - 1e-9)
        if ticks > 0:
            self._ticks += ticks
            self._truth = self._truth_now(slip=0.0)
            self._localization.move(self._truth, 0.0, 0.0, ticks / STEPS_PER_SECOND)

    def step(self) -> TruthState:
        """Advance by one eighth of a second; standing when there is no arc left."""
        motion = self._motion
        if motion is None or self.arc_done:
            self.wait(1.0 / STEPS_PER_SECOND)
            return self._truth
        old = self._truth
        before, after = (
            _fraction(motion, self._motion_ticks),
            _fraction(motion, self._motion_ticks + 1),
        )
        x0, y0, _ = pose_along(motion.start, motion.arc, before)
        x1, y1, yaw1 = pose_along(motion.start, motion.arc, after)
        offset_x, offset_y, offset_yaw = self._offset
        cosine, sine = math.cos(offset_yaw), math.sin(offset_yaw)
        # commanded step, in the direction that yaw slip has turned it to
        north_m = cosine * (x1 - x0) - sine * (y1 - y0)
        east_m = sine * (x1 - x0) + cosine * (y1 - y0)
        rolled_m = (after - before) * motion.wheel_path_m
        slipped = self._slip.step(
            (north_m, east_m),
            rolled_m,
            (old.roll_rad, old.pitch_rad, old.yaw_rad),
            self._class_number(old),
        )
        self._offset = (
            offset_x + slipped.north_m - (x1 - x0),
            offset_y + slipped.east_m - (y1 - y0),
            offset_yaw + slipped.yaw_slip_rad,
        )
        self._ticks += 1
        self._motion_ticks += 1
        self._distance_m += math.hypot(slipped.north_m, slipped.east_m)
        self._truth = self._settled_at(
            x1 + self._offset[0], y1 + self._offset[1], yaw1 + self._offset[2], slipped.slip
        )
        self._localization.move(self._truth, north_m, east_m, 1.0 / STEPS_PER_SECOND)
        return self._truth

    def place(self, north_m: float, east_m: float, yaw_rad: float) -> TruthState:
        """Set the rover down somewhere else, with the pose known as well as at the start."""
        self._motion = None
        self._truth = self._settled_at(north_m, east_m, yaw_rad, slip=0.0)
        self._localization = Localization(self._noise, self._truth, self._localization_rng)
        return self._truth

    # -------------------------------------------------------------- sensors

    def ground_around(self, radius_m: float) -> npt.NDArray[np.float32]:
        """True ground within a radius, as a cloud in the estimated rover frame: a perfect map."""
        here = self.estimate
        terrain = self.terrain
        north_m, east_m = np.meshgrid(terrain.north_m, terrain.east_m, indexing="ij")
        north_m, east_m = north_m - here.x_m, east_m - here.y_m
        down_m = terrain.z_site_m - here.z_m
        chosen = (np.hypot(north_m, east_m) <= radius_m) & np.isfinite(down_m)
        site_m = np.stack([north_m[chosen], east_m[chosen], down_m[chosen]], axis=-1)
        to_site = rotation(here.roll_rad, here.pitch_rad, here.yaw_rad)
        return np.ascontiguousarray(site_m @ to_site, dtype=np.float32)

    def visual_odometry(self) -> bool:
        """Fix the estimate by visual odometry; False when it failed."""
        return self._localization.fix()

    def image(self, azimuths_deg: Sequence[float] | None = None) -> npt.NDArray[np.float32]:
        """Point cloud float32 [n, 3] in the rover frame of this instant.

        One pair of images for each azimuth, clockwise from forward; the configured ones when None.
        """
        return self._camera.image(self._truth, self._camera_rng, azimuths_deg)

    def picture(
        self,
        azimuth_deg: float | None = None,
        sun_azimuth_deg: float | None = None,
        sun_elevation_deg: float | None = None,
    ) -> npt.NDArray[np.uint8]:
        """Shaded picture of the left camera; the configured directions when None."""
        return self._camera.picture(self._truth, azimuth_deg, sun_azimuth_deg, sun_elevation_deg)

    def _settled_at(self, north_m: float, east_m: float, yaw_rad: float, slip: float) -> TruthState:
        self._settled = self._settling.settle(north_m, east_m, yaw_rad)
        return self._truth_now(slip)

    def _truth_now(self, slip: float) -> TruthState:
        return TruthState(*(*self._settled, self.time_s, slip, self._distance_m))

    def _class_number(self, state: SettledState) -> int:
        """Terrain class under the rover's origin."""
        if self.terrain.classes is None:
            return 0
        return int(self.terrain.class_at(state.x_m, state.y_m))


def _fraction(motion: _Motion, ticks: int) -> float:
    """Driven share of an arc; an arc shorter than a step takes one step."""
    elapsed_s = ticks / STEPS_PER_SECOND
    if elapsed_s >= motion.duration_s:
        return 1.0 if ticks > 0 or motion.duration_s == 0.0 else 0.0
    return elapsed_s / motion.duration_s


def off_map_reason(truth: SettledState, terrain: Terrain) -> str:
    """Why a rover that is not `on_map` has no pose."""
    if terrain.contains(truth.x_m, truth.y_m):
        return "a wheel over the edge of the map or over a hole in the terrain"
    return "over the edge of the map"


def true_limit_violation(truth: SettledState, vehicle: Vehicle) -> str | None:
    """The first fault of the true rover, with value and limit; None when safe.

    Its limits, a pose that settling did not find, and ground that is not known where the limits
    need it. Off the map nothing is known and nothing is reported: watch `on_map`.
    """
    if not truth.on_map:
        return None
    if not truth.residual_m <= UNSETTLED_M:
        gap = f"a wheel is {truth.residual_m:.3f} m off the ground"
        return f"not settled: {gap} (a cliff, or a hole beside it)"
    if not (math.isfinite(truth.clearance_m) and math.isfinite(truth.wheel_drop_m)):
        return "no ground known under the rover: a hole in the terrain"
    limits = vehicle.fault_limits
    bogie_rad = max(abs(truth.bogie_left_rad), abs(truth.bogie_right_rad))
    for name, angle_rad, limit_deg in (
        ("tilt", truth.tilt_rad, limits.tilt_max_deg),
        ("rocker", abs(truth.rocker_rad), limits.rocker_max_deg),
        ("bogie", bogie_rad, limits.bogie_max_deg),
    ):
        if math.degrees(angle_rad) > limit_deg:
            return f"{name} {math.degrees(angle_rad):.1f} deg over {name}_max_deg {limit_deg:g}"
    clearance_m, drop_m = truth.clearance_m, truth.wheel_drop_m
    if clearance_m < limits.clearance_min_m:
        return f"clearance {clearance_m:.3f} m under clearance_min_m {limits.clearance_min_m:g}"
    if drop_m > limits.wheel_drop_max_m:
        return f"wheel drop {drop_m:.3f} m over wheel_drop_max_m {limits.wheel_drop_max_m:g}"
    return None
