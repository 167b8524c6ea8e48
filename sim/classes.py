# SPDX-License-Identifier: Apache-2.0
"""Terrain class maps for slip: patches of bedrock, soil and sand."""

from typing import Annotated, Literal

import numpy as np
import numpy.typing as npt
from pydantic import Field

from sim.config import ConfigModel
from sim.random_streams import rng_for
from sim.terrain import CLASS_NAMES
from sim.undulation import Undulation, undulation_up_m


class ClassLayer(ConfigModel):
    """Patches of one class; later layers lie over earlier ones.

    Attributes:
        terrain_class: What the ground is there.
        cover: Share of the terrain; 1 is all of it.
        horizontal_scale_m: Size of the patches.
    """

    terrain_class: Literal["bedrock", "cohesive_soil", "sand"]
    cover: Annotated[float, Field(ge=0, le=1)] = 1.0
    horizontal_scale_m: Annotated[float, Field(gt=0, le=1000)] = 10.0


def class_map(
    layers: tuple[ClassLayer, ...], shape: tuple[int, int], resolution_m: float, seed: int
) -> npt.NDArray[np.uint8] | None:
    """Class of every node, or None without layers.

    A layer covers the ground where smooth noise is above the quantile that leaves its cover.
    """
    if not layers:
        return None
    result = np.zeros(shape, dtype=np.uint8)
    for index, layer in enumerate(layers):
        number = CLASS_NAMES.index(layer.terrain_class)
        if layer.cover >= 1.0:
            result[:] = number
        elif layer.cover > 0.0:
            noise = undulation_up_m(
                shape,
                resolution_m,
                Undulation(horizontal_scale_m=layer.horizontal_scale_m, height_span_m=1.0),
                rng_for(seed, f"class.{index}"),
            )
            result[noise > np.quantile(noise, 1.0 - layer.cover)] = number
    return result
