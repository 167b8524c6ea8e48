# SPDX-License-Identifier: Apache-2.0
"""Attitude conventions."""

import math

import numpy as np
import pytest

from sim.frames import rotation, turned, turned_back


def test_signs() -> None:
    assert (rotation(0, 0, math.pi / 2) @ [1, 0, 0])[1] == pytest.approx(1)  # heading east
    assert (rotation(0, 0.1, 0) @ [1, 0, 0])[2] < 0  # nose up
    assert (rotation(0.1, 0, 0) @ [0, 1, 0])[2] > 0  # right side down


def test_it_is_a_rotation() -> None:
    turn = rotation(0.3, -0.7, 2.1)
    np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(turn) == pytest.approx(1)


def test_single_vectors_turn_alike() -> None:
    angles, vector = (0.3, -0.7, 2.1), (1.0, -2.0, 3.0)
    np.testing.assert_allclose(turned(*angles, vector), rotation(*angles) @ vector, atol=1e-14)
    np.testing.assert_allclose(
        turned_back(*angles, vector), rotation(*angles).T @ vector, atol=1e-14
    )
