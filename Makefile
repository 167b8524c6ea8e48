# The front door. Every target sets up what it needs; `make help` lists them.
SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.ONESHELL:
.DEFAULT_GOAL := help
MAKEFLAGS += --no-print-directory --no-builtin-rules

JOBS ?= 2
# of every source of Navlib, by its C tests alone
LEAST_LINE_PERCENT ?= 100
LEAST_BRANCH_PERCENT ?= 98
# of any call of Navlib
MOST_STACK_BYTES ?= 4096
# of the bulk check of ACE
POSES ?= 1000000
SEARCH_S ?= 300
# of the reader of data product files
FUZZ_S ?= 120
BIN := .venv/bin
export PATH := $(CURDIR)/$(BIN):$(PATH)
export PYTHONDONTWRITEBYTECODE :=

# outside data for some tests; without it they are skipped
SHARED_DATA := $(wildcard ../shared/data)
ifneq ($(SHARED_DATA),)
export ENAV_TEST_DATA ?= $(abspath $(SHARED_DATA))
endif

# the extensions are rebuilt when one of these changes; Python files are used where they are
C_FILES := $(wildcard navlib_c/include/*.h navlib_c/src/*.[ch] navlib_c/stubs/*.[ch] sim/kernels/*.[ch])
C_FORMATTED := $(C_FILES) $(wildcard navlib_c/tests/*.cpp navlib_c/tests/*.hpp)
SETUP := .venv/.setup

# a moved or copied folder, or a changed Python, makes the environment stale
ifneq ($(shell { $(BIN)/python -c '' && cat $(SETUP); } 2>/dev/null),$(CURDIR))
.PHONY: $(SETUP)
endif

$(SETUP): setup.sh pyproject.toml CMakeLists.txt pyharness/_build/make_binding.py $(C_FILES)
	@./setup.sh

$(SETUP)-bench: $(SETUP)
	@./setup.sh bench

# $(call logged,NAME,COMMAND): the output of a command is shown only when it fails
logged = mkdir -p build; $(2) >build/$(1).log 2>&1 </dev/null || { cat build/$(1).log; exit 1; }

# name the files that are not formatted, without a diff for every place
define clang_format_check
wrong=$$(for file in $(C_FORMATTED); do clang-format $$file | cmp -s - $$file || echo $$file; done)
[ -z "$$wrong" ] || { printf '%s: not formatted (make format)\n' $$wrong; exit 1; }
endef

# $(call c_tests,PRESET): build and run the C tests, show the summary
define c_tests
echo "building the C tests ($(1))"
$(call logged,$(1)-configure,cmake --preset $(1))
$(call logged,$(1)-build,cmake --build --preset $(1) --parallel $(JOBS))
$(call logged,$(1)-tests,ctest --preset $(1) --parallel $(JOBS))
grep -A 9 '% tests passed' build/$(1)-tests.log
endef

.PHONY: help
help: ## list the targets
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## (.*)/  \1\t\2/' | expand -t 14

.PHONY: setup
setup: $(SETUP) ## system packages, .venv, this package with its extensions, pre-commit hooks

.PHONY: drive
drive: $(SETUP) ## set up and run the demonstration drive
	@$(BIN)/enav drive --force

.PHONY: test
test: test-c style misra stack test-python ## set up and run all tests: C under sanitizers, MISRA, style, stack, Python

.PHONY: test-c
test-c: $(SETUP) ## the C tests under the address and undefined-behaviour sanitizers
	@$(call c_tests,asan)

.PHONY: test-python
test-python: $(SETUP) ## the Python tests
	@$(BIN)/python -m pytest -n $(JOBS) --quiet

.PHONY: style
style: $(SETUP) ## formatting, ruff and the import rules, in seconds
	@ruff check --quiet
	@ruff format --check --quiet
	@$(call clang_format_check)
	@$(call logged,lint-imports,lint-imports)
	@lizard -l c -C 10 -L 60 -a 6 -w navlib_c/src # complexity, lines, parameters of a function
	@echo "style: ruff, clang-format, import contracts, shape of C ok"

.PHONY: lint
lint: style misra stack ## style, MISRA rules, stack and types
	@mypy

.PHONY: misra
misra: $(SETUP) ## cppcheck with its MISRA addon over Navlib
	@JOBS=$(JOBS) .ci/misra

.PHONY: stack
stack: $(SETUP) ## worst-case stack of every call of Navlib
	@$(BIN)/python .ci/stack.py --most-bytes $(MOST_STACK_BYTES)

.PHONY: bench
bench: $(SETUP)-bench ## set up and measure speed: a table, and build/bench.json
	@mkdir -p build
	@$(BIN)/python -m pyharness.bench

.PHONY: drive-rate
drive-rate: $(SETUP) ## thinking while driving against stopping to think: m/h on 20 terrains
	@$(BIN)/python -m pyharness.drive_rate --workers $(JOBS)

.PHONY: montecarlo
montecarlo: $(SETUP) ## run the standard 1,200 drives, or what is missing of them, and make their report
	@$(BIN)/enav montecarlo run standard -o build/montecarlo --workers $(JOBS)
	@$(BIN)/enav montecarlo report build/montecarlo -o build/montecarlo.pdf

.PHONY: coverage
coverage: $(SETUP) ## coverage of Navlib by its C tests alone: build/coverage/report/index.html
	@find build -path 'build/coverage/*.gcda' -delete 2>/dev/null || true
	@$(call c_tests,coverage)
	@mkdir -p build/coverage/report
	@gcovr --root . --object-directory build/coverage --filter navlib_c/src/ --txt \
	    --html-details build/coverage/report/index.html --json-summary build/coverage/summary.json
	@$(BIN)/python .ci/coverage_gate.py build/coverage/summary.json \
	    --least-line-percent $(LEAST_LINE_PERCENT) --least-branch-percent $(LEAST_BRANCH_PERCENT)

.PHONY: verify
verify: test lint coverage records ace-guarantee koz-guarantee ## everything that is checked, and ACE against a million poses

.PHONY: golden
golden: $(SETUP) ## record the golden drive of a PowerPC again (needs its compiler and qemu)
	@mkdir -p build
	@.ci/powerpc_drive build/powerpc.dp
	@xz -9 --stdout build/powerpc.dp >pyharness/tests/data/powerpc.dp.xz

.PHONY: kaitai
kaitai: $(SETUP) docs ## compile navlib_c/enav_dp.ksy for its test (needs npm)
	@mkdir -p build/kaitai && cd build/kaitai
	@npm install --silent kaitai-struct-compiler@0.11.0 js-yaml@4
	@node ../../.ci/compile_ksy.js ../../navlib_c/enav_dp.ksy ../../pyharness/tests/data/enav_dp.py

.PHONY: records
records: $(SETUP) ## data product files: a PowerPC's, Kaitai's compiler, fuzzing, speed
	@$(BIN)/python -m pytest --quiet -m verify pyharness/tests/test_foreign_files.py \
	    pyharness/tests/test_kaitai.py pyharness/tests/test_dp_speed.py -s
	@$(BIN)/python -m pyharness.tests.fuzz_dp --seconds $(FUZZ_S)

.PHONY: ace-guarantee
ace-guarantee: $(SETUP) ## settle a million random poses, and search for ground that breaks ACE's bounds
	@mkdir -p build
	@$(BIN)/python -m pyharness.tests.verify_ace --poses $(POSES) --workers $(JOBS)
	@$(BIN)/python -m pyharness.tests.search_ace --seconds $(SEARCH_S) --workers $(JOBS)

.PHONY: koz-guarantee
koz-guarantee: $(SETUP) ## a hundred drives round a keep-out zone with bad localisation
	@$(BIN)/python -m pytest --quiet -m verify pyharness/tests/test_koz_growth.py

.PHONY: docs
docs: $(SETUP) ## write the pages of docs/ that are made from the C tables
	@$(BIN)/python -m pyharness._build.make_docs

.PHONY: format
format: $(SETUP) ## format C and Python
	@clang-format -i $(C_FORMATTED)
	@ruff check --fix --quiet || true
	@ruff format

.PHONY: clean
clean: ## remove what was built; .venv stays
	@rm -rf build .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis
