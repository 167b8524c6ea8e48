# SPDX-License-Identifier: Apache-2.0
"""Named random streams."""

import pytest

from sim.random_streams import rng_for


def test_streams_repeat_and_differ() -> None:
    assert rng_for(1, "rocks").random(5).tolist() == rng_for(1, "rocks").random(5).tolist()
    assert rng_for(1, "rocks").random() != rng_for(1, "slip").random()
    assert rng_for(1, "rocks").random() != rng_for(2, "rocks").random()


def test_a_stream_is_the_same_for_ever() -> None:
    """Stored recipes depend on it."""
    assert rng_for(7, "rocks").integers(0, 10**9) == 350160799


def test_a_negative_seed_is_refused() -> None:
    with pytest.raises(ValueError, match="negative"):
        rng_for(-1, "rocks")
