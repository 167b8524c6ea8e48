# SPDX-License-Identifier: Apache-2.0
"""The declarations of the extensions are taken from C headers."""

import importlib.util
import shutil
from pathlib import Path

import pytest

from pyharness.clib import lib

SCRIPT = Path(__file__).parents[1] / "_build" / "make_binding.py"


@pytest.fixture(scope="module")
def make_binding():
    spec = importlib.util.spec_from_file_location("make_binding", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


PREPROCESSED = """\
# 1 "/usr/include/stdint.h" 1 3 4
typedef int theirs_t;
#define NAV_THEIRS 1
# 1 "{folder}/nav_x.h" 1
#define NAV_X_H
#define NAV_COUNT (4U * 2U)
#define NAV_RATE 0.5
#define NAV_ADD(a) ((a) + 1)
#define OTHER 7
typedef struct {{ int rows[8]; }} nav_x_t;
"""


def test_only_our_declarations_and_integer_macros_are_kept(make_binding, tmp_path):
    text = PREPROCESSED.format(folder=tmp_path)
    cdef, used = make_binding.extract_cdef(text, [tmp_path.resolve()], "NAV_")
    assert cdef == "#define NAV_COUNT ...\ntypedef struct { int rows[8]; } nav_x_t;\n"
    assert used == {tmp_path.resolve() / "nav_x.h"}


def test_a_space_in_a_folder_is_escaped_for_the_build_tool(make_binding):
    depfile = make_binding.make_depfile(Path("/b/_x.c"), {Path("/a b/nav_x.h")})
    assert depfile == "/b/_x.c: /a\\ b/nav_x.h\n"


def test_a_header_that_does_not_compile_stops_the_build(make_binding, tmp_path):
    if shutil.which("cc") is None:
        pytest.skip("a C compiler is needed")
    with pytest.raises(SystemExit, match="cannot preprocess"):
        make_binding.preprocess("cc", [tmp_path], '#include "missing.h"\n')


def test_functions_tables_and_macros_reach_python():
    assert lib.NAV_WHEELS == 6
    assert len(lib.nav_param_defs) == lib.NAV_PARAM_COUNT
    assert callable(lib.nav_init)
