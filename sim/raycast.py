# SPDX-License-Identifier: Apache-2.0
"""Ray casting on a terrain (kernel: `kernels/raycast.c`)."""

import numpy as np
import numpy.typing as npt

from sim.clib import ffi, lib, pointer
from sim.settle import terrain_struct
from sim.terrain import Terrain


class RayCaster:
    """Casts rays on one terrain; holds its roof, which lets rays skip empty space."""

    def __init__(self, terrain: Terrain) -> None:
        """Build the roof: milliseconds for a million nodes."""
        self.terrain = terrain
        self._terrain_c = terrain_struct(terrain)
        self._roof = np.empty(lib.sim_roof_size(*terrain.z_site_m.shape), dtype=np.float32)
        lib.sim_roof_build(self._terrain_c, pointer(self._roof, "float *"))

    def ranges_m(
        self,
        origin_site_m: npt.ArrayLike,
        directions: npt.ArrayLike,
        range_max_m: float,
        attitude: npt.ArrayLike | None = None,
    ) -> npt.NDArray[np.float32]:
        """Distance [n] to the ground along unit vectors [n, 3]; NaN where there is none.

        The vectors are in SITE, or in a frame that the rotation matrix `attitude` turns to
        SITE. A ray that starts below the ground has range 0. Outside the map there is no ground.
        """
        origin = np.ascontiguousarray(origin_site_m, dtype=np.float64).reshape(3)
        turn = np.ascontiguousarray(np.eye(3) if attitude is None else attitude, dtype=np.float64)
        vectors = np.ascontiguousarray(directions, dtype=np.float64).reshape(-1, 3)
        ranges = np.full(len(vectors), np.nan, dtype=np.float32)
        if np.all(np.isfinite(origin)) and np.all(np.isfinite(turn)) and range_max_m > 0:
            rays = ffi.new(
                "sim_rays_t *",
                {
                    "origin_site_m": origin.tolist(),
                    "attitude": turn.tolist(),
                    "range_max_m": range_max_m,
                    "directions": pointer(vectors, "const double *"),
                    "count": len(vectors),
                },
            )
            size = lib.sim_raycast_table_size(self._terrain_c, range_max_m)
            table = np.empty(size, dtype=np.float32)
            lib.sim_raycast(
                self._terrain_c,
                pointer(self._roof, "const float *"),
                rays,
                pointer(table, "float *"),
                pointer(ranges, "float *"),
            )
        return ranges
