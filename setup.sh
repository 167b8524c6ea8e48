#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Makes a checkout ready: system packages, .venv with this package in it, pre-commit hooks.
# May be run again at any time. As root it installs missing Debian packages; otherwise it names
# them in one line and stops with 2. `setup.sh bench` also sets up what the benchmarks need.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

readonly VENV=.venv LOG=build/setup.log
PATH=${PATH//"$PWD/$VENV/bin:"/} # the environment is made by another Python than its own
python=${PYTHON:-python3}
extras=all,test
[ "${1:-}" != bench ] || extras=$extras,bench

fail() {
    echo "setup: $*" >&2
    exit 2
}

# run a step quietly; when it fails, show the end of its output and say in one line what was wanted
quietly() {
    local wanted=$1
    shift
    if ! "$@" >"$LOG" 2>&1 </dev/null; then
        tail -n 15 "$LOG" >&2
        fail "$wanted (whole output: $LOG)"
    fi
}

# --- system packages ------------------------------------------------------------------------------

have_gtest() {
    echo '#include <gtest/gtest.h>' | c++ -E -x c++ - >/dev/null 2>&1
}

have_python_headers() {
    "$python" -c 'import pathlib, sysconfig, sys
sys.exit(not pathlib.Path(sysconfig.get_path("include"), "Python.h").exists())'
}

missing_packages() {
    command -v gcc >/dev/null || echo gcc
    command -v make >/dev/null || echo make
    command -v g++ >/dev/null || echo g++
    have_gtest || echo libgtest-dev
    [[ $extras != *bench* ]] || command -v valgrind >/dev/null || echo valgrind
    if command -v "$python" >/dev/null; then
        "$python" -c 'import ensurepip, venv' 2>/dev/null || echo python3-venv
        have_python_headers || echo python3-dev
    else
        echo python3 python3-venv python3-dev
    fi
}

install_system_packages() {
    local missing
    if command -v "$python" >/dev/null; then
        "$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' ||
            fail "Python 3.11 or newer is needed; $python is $("$python" --version 2>&1)"
    fi
    missing=$(missing_packages | xargs)
    [ -n "$missing" ] || return 0
    if [ "$(id -u)" -ne 0 ] || ! command -v apt-get >/dev/null; then
        fail "missing system packages; as root: apt-get install $missing"
    fi
    echo "setup: installing $missing"
    export DEBIAN_FRONTEND=noninteractive
    quietly "apt-get cannot read the package lists" apt-get update
    # shellcheck disable=SC2086  # a list of names
    quietly "apt-get cannot install: $missing" \
        apt-get install -y --no-install-recommends $missing
    missing=$(missing_packages | xargs)
    [ -z "$missing" ] || fail "still missing after apt-get install: $missing"
}

# --- Python ---------------------------------------------------------------------------------------

have_cmake() {
    local version
    version=$(cmake --version 2>/dev/null | sed -n 's/^cmake version //p')
    [ -n "$version" ] && [ "$(printf '%s\n3.21\n' "$version" | sort -V | head -n 1)" = 3.21 ]
}

pip_install() {
    "$VENV/bin/python" -m pip install --disable-pip-version-check --no-input "$@"
}

install_python_packages() {
    # neither an environment nor a build survives being moved
    if [ "$(cat "$VENV/.folder" 2>/dev/null)" != "$PWD" ] || ! "$VENV/bin/python" -c '' 2>/dev/null; then
        rm -rf "$VENV"
        for cache in build/*/CMakeCache.txt; do
            grep -qsx "CMAKE_HOME_DIRECTORY:INTERNAL=$PWD" "$cache" || rm -rf "${cache%/*}"
        done
        quietly "cannot make $VENV" "$python" -m venv "$VENV"
        echo "$PWD" >"$VENV/.folder"
    fi
    echo "setup: installing into $VENV (a few minutes the first time)"
    local tools=("scikit-build-core>=0.11" "cffi>=1.17")
    have_cmake || tools+=("cmake>=3.21")
    quietly "pip cannot install ${tools[*]}: is the package index reachable?" \
        pip_install "${tools[@]}"
    PATH="$PWD/$VENV/bin:$PATH" quietly "pip cannot install enav-sim with its dependencies" \
        pip_install --no-build-isolation -e ".[$extras]"
}

# --- hooks ----------------------------------------------------------------------------------------

install_hooks() {
    if [ ! -e .git ] || ! command -v git >/dev/null; then
        return 0
    fi
    "$VENV/bin/pre-commit" install >"$LOG" 2>&1 ||
        echo "setup: no pre-commit hooks: $(head -n 1 "$LOG")"
}

mkdir -p build
install_system_packages
install_python_packages
install_hooks
echo "$PWD" >"$VENV/.setup"
[[ $extras != *bench* ]] || touch "$VENV/.setup-bench"
