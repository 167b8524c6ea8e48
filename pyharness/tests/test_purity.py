# SPDX-License-Identifier: Apache-2.0
"""Navlib touches nothing but its arguments: no heap, no I/O, no state of its own."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
NAVLIB = ROOT / "navlib_c"

FORBIDDEN = re.compile(
    r"\b(abort|alloca|assert|atexit|calloc|clock|errno|exit|f?printf|fopen|free|getenv|goto|longjmp"
    r"|malloc|puts|raise|rand|realloc|scanf|setjmp|signal|sn?printf|strtod|system|thread_local|time"
    r"|va_arg|va_list|va_start|_Atomic|_Thread_local)\b"
)
NOT_CODE = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"', re.DOTALL)

# the two calls of the host, memory, and the part of libm that gives equal bits everywhere
ALLOWED_SYMBOLS = {
    *("nav_dp_send", "nav_evr_send"),
    *("memcmp", "memcpy", "memmove", "memset"),
    *(
        "ceil",
        "ceilf",
        "fabs",
        "fabsf",
        "floor",
        "floorf",
        "fma",
        "fmod",
        "lround",
        "sqrt",
        "sqrtf",
    ),
}

# text, read-only data, weak and absolute symbols hold no state; `U` is checked by itself
STATELESS = set("tTrRaUnN")


def forbidden_identifiers(text):
    code = NOT_CODE.sub(" ", text)
    return sorted({match[0] for match in FORBIDDEN.finditer(code)})


@pytest.mark.parametrize("folder", ["include", "src"])
def test_no_forbidden_identifier_is_used(folder):
    files = sorted((NAVLIB / folder).glob("*.[ch]"))
    assert files
    found = {path.name: forbidden_identifiers(path.read_text()) for path in files}
    assert {name: words for name, words in found.items() if words} == {}


def test_forbidden_identifiers_are_seen_in_code_only():
    text = 'x = malloc(1); /* free */ // exit\ny = "goto"; time_s = 0; _Static_assert(1, "");'
    assert forbidden_identifiers(text) == ["malloc"]


def small_l_suffixes(text):
    return re.findall(r"\b(?:0[xX][0-9a-fA-F]+|\d[\d.]*)[uU]?l\w*", NOT_CODE.sub(" ", text))


def test_no_literal_ends_in_a_small_l():
    assert small_l_suffixes("a = 1L + 2ul + cell1 + 3l; /* 4l */") == ["2ul", "3l"]
    files = sorted(NAVLIB.glob("include/*.h")) + sorted(NAVLIB.glob("src/*.[ch]"))
    assert {path.name: small_l_suffixes(path.read_text()) for path in files} == {
        path.name: [] for path in files
    }


def symbols(objects, folder):
    """Link objects into one and return {name: kind} of its symbols as nm tells them."""
    joined = folder / "joined.o"
    subprocess.run(["gcc", "-r", "-nostdlib", "-o", joined, *objects], cwd=folder, check=True)
    listing = subprocess.run(
        ["nm", "--format=posix", joined], capture_output=True, text=True, check=True
    )
    rows = (line.split() for line in listing.stdout.splitlines())
    return {name: kind for name, kind, *_ in rows}


def compile_sources(sources, folder, optimisation):
    if shutil.which("gcc") is None or shutil.which("nm") is None:
        pytest.skip("gcc and nm are needed")
    # without -fno-pie constant tables of pointers look like variables
    flags = ["-std=c11", optimisation, "-fno-pie", "-fno-stack-protector", "-U_FORTIFY_SOURCE"]
    folders = [f"-I{NAVLIB / name}" for name in ("include", "src")]
    subprocess.run(
        ["gcc", *flags, "-ffp-contract=off", *folders, "-c", *sources], cwd=folder, check=True
    )
    return [f"{path.stem}.o" for path in sources]


@pytest.fixture(scope="module", params=["-O0", "-O2"])
def navlib_symbols(request, tmp_path_factory):
    sources = sorted((NAVLIB / "src").glob("*.c"))
    assert sources
    folder = tmp_path_factory.mktemp("purity")
    return symbols(compile_sources(sources, folder, request.param), folder)


def test_navlib_calls_only_its_host_and_exact_functions(navlib_symbols):
    undefined = {name for name, kind in navlib_symbols.items() if kind == "U"}
    assert undefined - ALLOWED_SYMBOLS == set()
    assert {"nav_dp_send", "nav_evr_send"} <= undefined


def test_navlib_has_no_variables(navlib_symbols):
    stateful = {name: kind for name, kind in navlib_symbols.items() if kind not in STATELESS}
    assert stateful == {}


def test_navlib_defines_only_names_with_its_prefix(navlib_symbols):
    exported = {name for name, kind in navlib_symbols.items() if kind in "TR"}
    assert exported
    assert {name for name in exported if not name.startswith("nav_")} == set()


def test_a_variable_and_a_foreign_call_are_noticed(tmp_path):
    source = tmp_path / "impure.c"
    source.write_text(
        "double sin(double);\nstatic int calls;\n"
        "double nav_f(double x);\ndouble nav_f(double x) { calls++; return sin(x) + calls; }\n"
    )
    found = symbols(compile_sources([source], tmp_path, "-O0"), tmp_path)
    assert found["sin"] == "U"
    assert "sin" not in ALLOWED_SYMBOLS
    assert found["calls"] not in STATELESS
