# SPDX-License-Identifier: Apache-2.0
"""Errors a user can cause; every one prints as clear lines, never as a traceback."""

from collections.abc import Sequence


class SimError(Exception):
    """Base class of all errors of the package."""


class TerrainError(SimError):
    """A terrain file or recipe is unusable: one line with file, fault and what was expected."""


class ConfigError(SimError):
    """A configuration file is unusable; `problems` holds one line per fault, all faults at once."""

    def __init__(self, problems: Sequence[str]) -> None:
        """Keep the problems, each already one line."""
        super().__init__("\n".join(problems))
        self.problems = tuple(problems)
