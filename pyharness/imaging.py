# SPDX-License-Identifier: Apache-2.0
"""Images that were taken and are not merged yet."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from pyharness.messages import copy_pose
from pyharness.protocols import World
from pyharness.thinker import Image


@dataclass(slots=True)
class Images:
    """Those of the arc being driven wait until the next one; then they are released."""

    world: World
    released: deque[Image] = field(default_factory=deque)
    _newest: list[Image] = field(default_factory=list)
    _taken_count: int = 0

    def take(self, shoot: Callable[[], npt.NDArray[np.float32]], pair_count: int = 1) -> None:
        """Take an image from where the rover believes to be."""
        self._taken_count += 1
        pose = copy_pose(self.world.estimate)
        self._newest.append(Image(self._taken_count, self.world.time_s, pose, shoot(), pair_count))

    def release(self) -> None:
        """Let everything taken so far be merged."""
        self.released.extend(self._newest)
        self._newest.clear()

    def clear(self) -> None:
        """Forget what was not merged."""
        self.released.clear()
        self._newest.clear()
