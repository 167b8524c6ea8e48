# SPDX-License-Identifier: Apache-2.0
"""How many instructions ACE takes a pose: navlib_c/tests/ace_poses.c under callgrind."""

import math
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from sim.generate import TerrainRecipe, generate

NAVLIB = Path(__file__).resolve().parents[1] / "navlib_c"
POSES = 2000
MAP_HALF_M = 15.0
POSE_REACH_M = 11.0  # poses this far from the middle see only known terrain
POSITION_M = 0.10  # the growth of uncertainty along a path ends here
YAW_RAD = 0.035
COMPILE = ("cc", "-std=c11", "-O3", "-g", "-ffp-contract=off")


def ace_instructions() -> dict[str, float]:
    """Return instructions a pose, for certain and for uncertain poses; nothing without valgrind."""
    if shutil.which("valgrind") is None:
        return {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        program = folder / "ace_poses"
        sources = [*sorted(NAVLIB.glob("src/*.c")), *sorted(NAVLIB.glob("stubs/*.c"))]
        includes = [f"-I{NAVLIB / part}" for part in ("include", "src", "stubs")]
        files = [str(path) for path in (*sources, NAVLIB / "tests/ace_poses.c")]
        subprocess.run([*COMPILE, *includes, *files, "-lm", "-o", str(program)], check=True)
        counts = {}
        for row, doubt in (("ace_instructions_per_pose", 0.0), ("ace_instructions_uncertain", 1.0)):
            scene = folder / f"{row}.bin"
            scene.write_bytes(_scene(doubt))
            counts[row] = _collected(program, scene) / POSES
        return counts


def _scene(doubt: float) -> bytes:
    """Return a surface and random poses on it, their uncertainty a share of the largest."""
    terrain = generate(TerrainRecipe(cfa=0.10, size_m=40.0, seed=11))
    north = np.abs(terrain.north_m) < MAP_HALF_M
    east = np.abs(terrain.east_m) < MAP_HALF_M
    rng = np.random.default_rng(3)
    poses = np.column_stack(
        [
            rng.uniform(-POSE_REACH_M, POSE_REACH_M, (POSES, 2)),
            rng.uniform(-math.pi, math.pi, POSES),
            doubt * rng.uniform(0.0, (POSITION_M, YAW_RAD), (POSES, 2)),
        ]
    )
    surface = terrain.z_site_m[np.ix_(north, east)].astype(np.float32)
    return surface.tobytes() + poses.tobytes()


def _collected(program: Path, scene: Path) -> float:
    """Return the instructions spent in nav_ace_evaluate."""
    answer = subprocess.run(
        [
            "valgrind",
            "--tool=callgrind",
            f"--callgrind-out-file={scene}.out",
            "--toggle-collect=nav_ace_evaluate",
            str(program),
            str(scene),
        ],
        check=True,
        capture_output=True,
        text=True,
    )
    found = re.search(r"Collected : (\d+)", answer.stderr)
    assert found is not None, answer.stderr
    return float(found[1])
