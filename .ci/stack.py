# SPDX-License-Identifier: Apache-2.0
"""Worst-case stack of every call of Navlib: the deepest chain of gcc's call graph, in bytes.

The host's two functions and the C library are not counted. Exits with 1 where a call needs more
than the limit: python .ci/stack.py --most-bytes 4096
"""

import argparse
import functools
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
SOURCES = ROOT / "navlib_c" / "src"
CALLS = (
    "nav_init",
    "nav_set_kioz",
    "nav_process_disparity",
    "nav_analyze_terrain",
    "nav_select_arc",
    "nav_evaluate_arc",
)
FLAGS = ("-std=c11", "-O2", "-ffp-contract=off", "-fcallgraph-info=su", "-c")
NODE = re.compile(r'node: \{ title: "([^"]+)" label: "[^"]*?(\d+) bytes')
EDGE = re.compile(r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"')

Chain = tuple[int, tuple[tuple[str, int], ...]]


def call_graph() -> tuple[dict[str, int], dict[str, set[str]]]:
    """Frame of every function, and which ones it calls."""
    frames: dict[str, int] = {}
    called: dict[str, set[str]] = {}
    with tempfile.TemporaryDirectory() as folder:
        includes = [f"-I{ROOT / 'navlib_c' / 'include'}", f"-I{SOURCES}"]
        sources = sorted(map(str, SOURCES.glob("*.c")))
        subprocess.run(["gcc", *FLAGS, *includes, *sources], cwd=folder, check=True)
        for path in Path(folder).glob("*.ci"):
            for line in path.read_text("utf-8").splitlines():
                if node := NODE.match(line):
                    frames[node[1]] = int(node[2])
                elif edge := EDGE.match(line):
                    called.setdefault(edge[1], set()).add(edge[2])
    return frames, called


def main() -> int:
    """Print a table, and the deepest chain."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--most-bytes", type=int, required=True)
    most_bytes = parser.parse_args().most_bytes
    frames, called = call_graph()

    @functools.cache
    def deepest(name: str) -> Chain:
        """Navlib does not recurse: the graph has an end."""
        below, chain = max(map(deepest, called.get(name, ())), default=(0, ()))
        frame = frames.get(name, 0)
        return frame + below, ((name.rpartition(":")[2], frame), *chain)

    stacks = {name: deepest(name) for name in CALLS}
    for name, (size_bytes, _) in stacks.items():
        print(f"stack: {name} {size_bytes} bytes")
    worst = max(stacks, key=lambda name: stacks[name][0])
    print("stack: deepest:", ", ".join(f"{name} {frame}" for name, frame in stacks[worst][1]))
    if missing := [name for name in CALLS if name not in frames]:
        print(f"stack: no frame known of {', '.join(missing)}")
        return 1
    if stacks[worst][0] > most_bytes:
        print(f"stack: {worst} needs more than {most_bytes} bytes")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
