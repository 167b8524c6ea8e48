# SPDX-License-Identifier: Apache-2.0
"""Scenarios that show something, by their names."""

from importlib import resources
from pathlib import Path


def example(name: str) -> Path:
    """Return the file of an example."""
    return Path(str(resources.files(__name__).joinpath(f"{name}.yaml")))
