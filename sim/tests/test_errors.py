# SPDX-License-Identifier: Apache-2.0
"""Errors print as clear lines."""

from sim.errors import ConfigError, SimError, TerrainError


def test_all_are_sim_errors() -> None:
    assert issubclass(TerrainError, SimError)
    assert str(ConfigError(["a", "b"])) == "a\nb"
    assert ConfigError(["a", "b"]).problems == ("a", "b")
