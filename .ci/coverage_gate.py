# SPDX-License-Identifier: Apache-2.0
"""Check gcovr's summary: every source of Navlib is in it, each covered as demanded.

gcovr is content when its filter matches nothing, so the files are counted here. A source that holds
only tables has nothing to measure; its object file says so.
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def has_code(folder: Path, source: str) -> bool:
    """Ask the object file of a source for functions; without an object there is doubt."""
    objects = list(folder.rglob(f"{Path(source).name}.o"))
    if not objects:
        return True
    listing = subprocess.run(
        ["nm", "--format=posix", *objects], capture_output=True, text=True, check=True
    )
    return any(line.split()[1:2] in (["T"], ["t"]) for line in listing.stdout.splitlines())


def problems(summary: dict, sources: list[str], least_percent: dict[str, float]) -> list[str]:
    """Return one sentence for everything that is wrong."""
    measured = {file["filename"]: file for file in summary["files"]}
    found = [f"{name}: not measured" for name in sources if name not in measured]
    if not sources:
        found.append("navlib_c/src has no sources")
    for name in sources:
        file = measured.get(name)
        for kind, least in least_percent.items():
            if not file or not file[f"{kind}_total"]:
                continue
            covered, total = file[f"{kind}_covered"], file[f"{kind}_total"]
            if 100.0 * covered < least * total:
                plural = {"line": "lines", "branch": "branches"}[kind]
                found.append(f"{name}: {covered} of {total} {plural} covered, {least:g} % demanded")
    return found


def main() -> None:
    """Print what is wrong and exit with 1, or a line that sums up."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("summary", type=Path)
    parser.add_argument("--least-line-percent", type=float, default=0.0)
    parser.add_argument("--least-branch-percent", type=float, default=0.0)
    options = parser.parse_args()
    summary = json.loads(options.summary.read_text())
    folder = ROOT / "navlib_c" / "src"
    names = [str(path.relative_to(ROOT)) for path in sorted(folder.glob("*.c"))]
    sources = [name for name in names if has_code(options.summary.parent, name)]
    least = {"line": options.least_line_percent, "branch": options.least_branch_percent}
    found = problems(summary, sources, least)
    if found:
        sys.exit("\n".join(f"coverage: {sentence}" for sentence in found))
    print(
        f"coverage: {summary['line_percent']} % of lines, {summary['branch_percent']} % of "
        f"branches in {len(sources)} files"
    )


if __name__ == "__main__":
    main()
