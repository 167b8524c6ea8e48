# SPDX-License-Identifier: Apache-2.0
"""What a result was made with: versions and machine."""

import os
import platform
import subprocess
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).parent.parent
CPU_FILE = Path("/proc/cpuinfo")


def provenance() -> dict[str, Any]:
    """Return versions and machine."""
    return {
        "enav_sim": metadata.version("enav-sim"),
        "revision": revision(ROOT),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "platform": platform.platform(),
        "cpu": cpu_name(CPU_FILE),
        "cores": os.cpu_count(),
    }


def revision(root: Path) -> str | None:
    """Return the revision of the source, `-dirty` where it was changed; None without git."""
    if not (root / ".git").exists():
        return None
    command = ["git", "-C", str(root), "describe", "--always", "--dirty", "--abbrev=12"]
    try:
        git = subprocess.run(command, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return None
    return git.stdout.strip()


def cpu_name(path: Path) -> str:
    """Return the name of the processor."""
    try:
        lines = path.read_text("utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()
