# SPDX-License-Identifier: Apache-2.0
"""One seed per run, one named random stream per source of chance."""

import zlib

import numpy as np

SEED_MAX = 2**63 - 1


def rng_for(seed: int, name: str) -> np.random.Generator:
    """Generator of the stream `name`; streams of one seed are independent of each other.

    Using one stream more or less never changes what the others draw.
    """
    return np.random.default_rng(np.random.SeedSequence([seed, zlib.crc32(name.encode())]))
