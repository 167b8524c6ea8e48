# SPDX-License-Identifier: Apache-2.0
"""Write the C source of a cffi extension whose declarations come from public C headers.

The headers are the only place where the interface is written down. They are run through the
preprocessor of the compiler that builds the library; what remains of our own folders is the cdef.
Integer macros with the given prefix are exported too, and their values asked of the compiler.

CMake runs this script by its path, so it imports nothing of the package around it.
"""

import argparse
import re
import subprocess
import sys
from collections.abc import Collection, Sequence
from pathlib import Path

LINE_MARKER = re.compile(r'^# \d+ "(?P<file>[^"]+)"')
OBJECT_MACRO = re.compile(r"^#define (?P<name>\w+) (?P<value>[\w\s()+\-*/<>|&~]+)$")


def preprocess(compiler: str, includes: Sequence[Path], source: str) -> str:
    """Return the preprocessed source, macro definitions and line markers kept."""
    folders = [f"-I{path}" for path in includes]
    command = [compiler, "-std=c11", "-E", "-dD", *folders, "-x", "c", "-"]
    run = subprocess.run(command, input=source, capture_output=True, text=True)
    if run.returncode != 0:
        sys.exit(f"{run.stderr}make_binding: {compiler} cannot preprocess the headers")
    return run.stdout


def extract_cdef(
    preprocessed: str, includes: Collection[Path], macro_prefix: str
) -> tuple[str, set[Path]]:
    """Keep the declarations of headers in the (resolved) folders; name the headers used."""
    kept: list[str] = []
    used: set[Path] = set()
    ours = False
    for line in preprocessed.splitlines():
        if marker := LINE_MARKER.match(line):
            path = Path(marker["file"]).resolve()
            ours = path.parent in includes
            if ours:
                used.add(path)
        elif ours and (macro := OBJECT_MACRO.match(line)):
            if macro["name"].startswith(macro_prefix):
                kept.append(f"#define {macro['name']} ...")
        elif ours and line.strip() and not line.startswith("#"):
            kept.append(line)
    return "\n".join(kept) + "\n", used


def make_depfile(target: Path, used: Collection[Path]) -> str:
    """Return a Makefile rule that tells the build tool which headers the target came from."""
    names = [str(path).replace(" ", "\\ ") for path in (target, *sorted(used))]
    return f"{names[0]}: {' '.join(names[1:])}\n"


def parse_arguments(arguments: Sequence[str] | None = None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--compiler", default="cc")
    parser.add_argument("--include", action="append", type=Path, required=True, dest="includes")
    parser.add_argument("--header", action="append", required=True, dest="headers")
    parser.add_argument("--macro-prefix", required=True)
    parser.add_argument("--module", required=True)
    parser.add_argument("--out-c", type=Path, required=True)
    parser.add_argument("--out-cdef", type=Path, required=True)
    parser.add_argument("--depfile", type=Path, required=True)
    return parser.parse_args(arguments)


def main() -> None:
    from cffi import FFI

    options = parse_arguments()
    includes = [path.resolve() for path in options.includes]
    source = "".join(f'#include "{header}"\n' for header in options.headers)
    preprocessed = preprocess(options.compiler, includes, source)
    cdef, used = extract_cdef(preprocessed, includes, options.macro_prefix)

    ffi = FFI()
    ffi.cdef(cdef)
    ffi.set_source(options.module, source)
    ffi.emit_c_code(str(options.out_c))
    options.out_cdef.write_text(cdef)
    options.depfile.write_text(make_depfile(options.out_c, used))


if __name__ == "__main__":
    main()
