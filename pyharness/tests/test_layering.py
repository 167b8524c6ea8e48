# SPDX-License-Identifier: Apache-2.0
"""Who may know whom. The Python half is written down in pyproject.toml, the C half here."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
NAVLIB = ROOT / "navlib_c"
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]+(?P<name>[<"][^>"]+[>"])', re.MULTILINE)

# a module includes only modules of lower rows; the same row is not lower
LEVELS = [
    ["nav_config"],
    ["nav_types"],
    ["nav_minmax", "nav_guard"],
    ["nav_math"],
    ["nav_params", "nav_evr"],
    ["nav_heightmap", "nav_kioz", "nav_arc", "nav_vehicle"],
    ["nav_costmap"],
    ["nav_relief"],
    ["nav_passage", "nav_ground"],
    ["nav_global"],
    ["nav_wheel", "nav_rough", "nav_states", "nav_places"],
    ["nav_belly"],
    ["nav_ace"],
    ["nav_tree"],
    ["nav_walk"],
    ["nav_rank", "nav_trial"],
    ["nav_show"],
    ["nav_select"],
    ["nav_context"],
    ["nav_interface"],
    ["navlib"],
]
LEVEL_OF = {module: level for level, modules in enumerate(LEVELS) for module in modules}

# names the records of every module, so it may include upward; included from .c files only
PRODUCTS = "nav_dp"

STANDARD_HEADERS = {"<stdbool.h>", "<stddef.h>", "<stdint.h>"}
STANDARD_SOURCES = STANDARD_HEADERS | {"<float.h>", "<limits.h>", "<math.h>", "<string.h>"}


def includes(path):
    return [match["name"] for match in INCLUDE.finditer(path.read_text())]


def included_modules(path):
    return [Path(name.strip('"')).stem for name in includes(path) if name.startswith('"')]


def navlib_files(*patterns):
    files = sorted(path for pattern in patterns for path in NAVLIB.glob(pattern))
    assert files, f"nothing matches {patterns}"
    return files


def offences(path):
    """Return the includes of one file of Navlib that its place does not allow."""
    module, is_header = path.stem, path.suffix == ".h"
    found = []
    for other in included_modules(path):
        if other == module and not is_header:
            continue
        if PRODUCTS in (module, other):
            if other == PRODUCTS and is_header and module != "navlib":
                found.append(f"{path.name} includes {other}.h: only a .c may")
        elif other not in LEVEL_OF:
            found.append(f"{path.name} includes {other}.h, which has no row in LEVELS")
        elif LEVEL_OF[other] >= LEVEL_OF[module]:
            found.append(f"{path.name} includes {other}.h, which is not below it")
    return found


def test_every_module_has_a_row():
    modules = {path.stem for path in navlib_files("include/*.h", "src/*.[ch]")}
    assert modules - set(LEVEL_OF) - {PRODUCTS} == set()


def test_a_module_includes_only_modules_below_it():
    files = navlib_files("include/*.h", "src/*.[ch]")
    assert [offence for path in files for offence in offences(path)] == []


def test_an_upward_include_is_noticed(tmp_path):
    source = tmp_path / "nav_arc.c"
    source.write_text('#include "nav_arc.h"\n  #  include "nav_tree.h"\n#include "nav_math.h"\n')
    assert offences(source) == ["nav_arc.c includes nav_tree.h, which is not below it"]


def test_public_headers_include_only_public_headers():
    public = {path.name for path in navlib_files("include/*.h")}
    for header in navlib_files("include/*.h"):
        private = {f"{module}.h" for module in included_modules(header)} - public
        assert private == set(), header.name


def test_stubs_know_only_the_public_headers():
    known = {path.name for path in navlib_files("include/*.h", "stubs/*.h")}
    for path in navlib_files("stubs/*.[ch]"):
        private = {f"{module}.h" for module in included_modules(path)} - known
        assert private == set(), path.name


@pytest.mark.parametrize(
    ("patterns", "allowed"),
    [(("include/*.h",), STANDARD_HEADERS), (("src/*.[ch]",), STANDARD_SOURCES)],
)
def test_only_listed_standard_headers_are_used(patterns, allowed):
    used = {name for path in navlib_files(*patterns) for name in includes(path) if name[0] == "<"}
    assert used <= allowed


def test_every_c_source_is_listed_in_cmake():
    listed = (ROOT / "CMakeLists.txt").read_text()
    sources = navlib_files("src/*.c", "stubs/*.c") + sorted((ROOT / "sim/kernels").glob("*.c"))
    missing = [path.name for path in sources if f"{path.relative_to(ROOT)}" not in listed]
    assert missing == []


def test_every_module_has_its_tests_and_they_are_listed_in_cmake():
    listed = (NAVLIB / "tests/CMakeLists.txt").read_text()
    match = re.search(r"set\(modules (?P<names>[^)]*)\)", listed)
    assert match is not None
    in_cmake = {f"nav_{name}" for name in match["names"].split()}
    on_disk = {path.stem.removeprefix("test_") for path in NAVLIB.glob("tests/test_nav_*.cpp")}
    assert in_cmake == on_disk
    assert {path.stem for path in navlib_files("src/nav_*.c")} - on_disk == set()


def test_import_contracts_hold():
    command = Path(sys.executable).with_name("lint-imports")
    if not command.exists() and not (command := shutil.which("lint-imports")):
        pytest.skip("import-linter is not installed")
    run = subprocess.run([command], cwd=ROOT, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr
