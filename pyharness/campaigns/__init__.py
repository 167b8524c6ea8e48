# SPDX-License-Identifier: Apache-2.0
"""Campaigns that come with the simulator, by their names."""

from importlib import resources
from pathlib import Path

BUILT_IN = ("standard", "planners")


def built_in(name: str) -> Path:
    """Return the file of a campaign."""
    return Path(str(resources.files(__name__).joinpath(f"{name}.yaml")))
