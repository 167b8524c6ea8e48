# SPDX-License-Identifier: Apache-2.0
"""Where the rover will be at the end of its arc, and how far it may be from there."""

import math
from dataclasses import dataclass, replace

from pyharness.executive_config import PoseUncertainty
from pyharness.messages import Arc, Pose6, Uncertainty, copy_pose, pose_after
from pyharness.protocols import World


@dataclass(frozen=True, slots=True)
class Predictor:
    """Predicts from the estimate, which VO has just corrected when an arc is selected."""

    world: World
    config: PoseUncertainty

    def now(self) -> Uncertainty:
        """How far the rover may be from where it believes to be.

        Relative to the map, that is the error of the last fix and of the motion since then; in
        SITE, all that has piled up since the start.
        """
        estimate, config = self.world.estimate, self.config
        return Uncertainty(
            position_m=config.position_base_m + config.local_sigmas * estimate.sigma_local_m,
            yaw_rad=math.radians(config.yaw_base_deg),
            global_position_m=config.global_sigmas * estimate.sigma_position_m,
        )

    def at_end(self, remaining: Arc) -> tuple[Pose6, Uncertainty]:
        """The pose when the rest of an arc is driven, and its uncertainty.

        Slip shifts the end by its mean and adds its spread. Zones are kept by what the position
        error will have grown to before a fix comes on the arc that is selected now, so that an
        arc that is passed now is not refused while it is driven.
        """
        slip = self.world.slip_ahead(remaining.length_m, remaining.heading_change_rad)
        end = pose_after(copy_pose(self.world.estimate), remaining)
        pose = replace(end, x_m=end.x_m + slip.north_m, y_m=end.y_m + slip.east_m)
        now, sigmas = self.now(), self.config.slip_sigmas
        uncertainty = Uncertainty(
            position_m=now.position_m + sigmas * slip.sigma_m,
            yaw_rad=now.yaw_rad + sigmas * slip.yaw_sigma_rad,
            global_position_m=self.global_position_m(remaining),
        )
        return pose, uncertainty

    def global_position_m(self, remaining: Arc) -> float:
        """By how much zones grow for the arc after this one."""
        unfixed_m = abs(remaining.length_m) + self.config.unfixed_ahead_m
        return self.config.global_sigmas * self.world.sigma_position_after_m(unfixed_m)
