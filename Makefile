# Short names for the usual commands; the real build is CMake (CMakePresets.json).

SHELL := /bin/bash
.SHELLFLAGS := -o pipefail -c
.DEFAULT_GOAL := help
JOBS ?= $(shell nproc 2>/dev/null || echo 2)
# Tests wait for processes to start for a third of their time.
TEST_JOBS ?= $(shell echo $$(($(JOBS) + ($(JOBS) + 1)/2)))
PREFIX ?= /usr/local
RUN_DIR := build/run/taylor_bar
PYTHON = $(shell test -x build/venv/bin/python && echo build/venv/bin/python || echo python3)
FORTRAN_SOURCES = $(shell find src -name '*.f90' -o -name '*.F90' | sort)

# Containers run as root, and tests start more processes than there are cores.
export OMPI_ALLOW_RUN_AS_ROOT := 1
export OMPI_ALLOW_RUN_AS_ROOT_CONFIRM := 1
export OMPI_MCA_rmaps_base_oversubscribe := 1
MAKEFLAGS += --no-print-directory

# Threads that wait for others give their core away: on a busy machine spinning makes small runs several times slower.
export OMP_WAIT_POLICY ?= passive

GALLERY = $(wildcard input/gallery/*.inp) input/taylor_bar_axisymmetric.inp

.PHONY: gallery help setup setup-test setup-dev build build-all run verify verify-full hard test test-long test-full test-slurm test-serial sanitize fuzz truth mutate debug test-debug bench speed wrap lint format coverage doc install clean
.PRECIOUS: build/%/.configured

help: ## List the targets
	@echo "make TARGET, where TARGET is one of"
	@sed -n 's/^\([a-z][a-z-]*\):.*## /  \1	/p' $(MAKEFILE_LIST) | expand -t 14

setup: ## Install what is missing (compiler, MPI, HDF5, muParser, CMake, Python packages)
	@scripts/setup/setup.sh

setup-test: # What only tests use
	@scripts/setup/setup.sh --test

setup-dev: # The tools of lint, format, coverage and doc
	@scripts/setup/setup.sh --dev

build/%/.configured: CMakePresets.json
	cmake --preset $*
	@touch $@

build: setup build/release/.configured ## Build build/release/sgmp
	cmake --build build/release --parallel $(JOBS) --target sgmp sgmp_manual

build-all: setup setup-test build/release/.configured # With the tests, and with what make bench compares
	cmake --build build/release --parallel $(JOBS)

run: build ## Run the Taylor bar, compare it with the experiment and draw it
	rm -rf $(RUN_DIR)
	mkdir -p $(RUN_DIR)
	build/release/sgmp input/taylor_bar.inp --output $(RUN_DIR)
	$(PYTHON) scripts/taylor_bar_report.py $(RUN_DIR)

gallery: build ## Run the decks of input/gallery/ and draw them (two minutes): build/gallery/
	mkdir -p build/gallery
	for deck in $(GALLERY); do \
	  out=build/gallery/$$(basename $$deck .inp).out; \
	  build/release/sgmp $$deck --quiet --output $$out && $(PYTHON) scripts/sgmp-view report $$out || exit 1; \
	done

verify: build ## Compare the paper's examples with their references (minutes): build/verification/report.html
	$(PYTHON) verification/verify.py

verify-full: build ## The same with all sizes and figures, and the copy in doc/verification/
	$(PYTHON) verification/verify.py --full

hard: build ## Run the hard cases by four methods (minutes): build/hard/results.json, doc/hard-cases.md
	$(PYTHON) verification/hard/hard.py --publish
	$(PYTHON) scripts/dev/wrap.py doc/hard-cases.md

test: build-all ## Build and run the tests that take less than ten seconds each: three minutes on two cores
	ctest --test-dir build/release --parallel $(TEST_JOBS) --output-on-failure --no-tests=error -LE long

test-long: build-all ## Run the others: layouts, restarts, random decks and scenes, every page's commands (ten minutes)
	ctest --test-dir build/release --parallel $(TEST_JOBS) --output-on-failure --no-tests=error -L long

test-full: build-all ## The same with all layouts, more kills and random scenes, sanitizers, a sample of small faults (half an hour)
	SGMP_TEST_FULL=1 ctest --test-dir build/release --parallel $(TEST_JOBS) --output-on-failure --no-tests=error -LE fuzz
	$(MAKE) fuzz INPUTS=$(or $(INPUTS),8000) SCENES=$(or $(SCENES),120) SEED=$(or $(SEED),$(shell date +%s))
	$(MAKE) sanitize
	$(MAKE) mutate SAMPLE=$(or $(SAMPLE),20) LEAST=0.7

test-serial: build build/serial/.configured ## Build sgmp without MPI (build/serial/sgmp) and compare its results with those of the build with MPI, bit by bit
	cmake --build build/serial --parallel $(JOBS) --target sgmp
	$(PYTHON) tests/serial/serial.py build/serial/sgmp . build/serial/scratch build/release/sgmp

sanitize: setup setup-test build/sanitize/.configured ## Run units, broken decks and some scenes with address and undefined-behaviour sanitizers
	cmake --build build/sanitize --parallel $(JOBS)
	ctest --test-dir build/sanitize --parallel $(TEST_JOBS) --output-on-failure --no-tests=error -R '^(test_|decks_|regression_(values|cards|seeding)$$)'

test-slurm: build ## Run scripts/hpc/slurm.sh under a SLURM of its own through time limit, queue and restart; says what is missing
	$(PYTHON) tests/slurm/slurm.py build/release/sgmp . build/slurm

fuzz: build-all ## Damaged decks and checkpoints, then random scenes (INPUTS=100000 of each, SCENES=1500, SEED=1)
	$(PYTHON) tests/fuzz/decks.py build/release/sgmp . build/fuzz/decks --inputs $(or $(INPUTS),100000) --seed $(or $(SEED),1)
	$(PYTHON) tests/fuzz/mpm3d.py build/release/sgmp . build/fuzz/mpm3d --inputs $(or $(INPUTS),100000) --seed $(or $(SEED),1)
	$(PYTHON) tests/fuzz/checkpoints.py build/release/sgmp . build/fuzz/checkpoints --inputs $(or $(INPUTS),100000) --seed $(or $(SEED),1)
	$(PYTHON) tests/fuzz/scenes.py build/release/sgmp . build/fuzz/scenes --inputs $(or $(SCENES),1500) --seed $(or $(SEED),240000000)
	$(PYTHON) tests/fuzz/truth.py build/release/sgmp . build/fuzz/truth --inputs $(or $(SCENES),1500) --seed $(or $(SEED),1)

truth: build ## Random scenes of 63 classes whose truth is known, by class: how often sound runs are wrong (SCENES=400, SEED=1; UNEQUAL=1: on unequal cells)
	$(PYTHON) tests/fuzz/truth_table.py build/release/sgmp . build/fuzz/truth_table --inputs $(or $(SCENES),400) --seed $(or $(SEED),1) --jobs $(JOBS) $(if $(UNEQUAL),--unequal)

mutate: build-all ## Put small faults into the sources and see whether tests notice (SAMPLE=200, SEED=1; MUTATE=FILE: all of it; FAULTS=LIST)
	$(PYTHON) tests/mutation/mutate.py $(if $(MUTATE),--files $(MUTATE)) $(if $(FAULTS),--faults $(FAULTS)) $(if $(SAMPLE),--sample $(SAMPLE)) $(if $(SEED),--seed $(SEED)) $(if $(LEAST),--least $(LEAST)) --jobs $(JOBS)

debug: setup build/debug/.configured ## Build build/debug/sgmp with all run-time checks
	cmake --build build/debug --parallel $(JOBS)

test-debug: debug setup-test ## Run all tests on the debug build
	ctest --test-dir build/debug --parallel $(TEST_JOBS) --output-on-failure --no-tests=error

bench: build-all ## Measure nanoseconds per particle and step, and what whole runs take, beside targets (a quarter of an hour)
	$(PYTHON) scripts/bench/bench.py build/release/sgmp
	$(PYTHON) scripts/bench/whole_runs.py build/release/sgmp

speed: build ## Error against CPU seconds of all methods on thirteen scenes (half an hour, may be stopped and started again): doc/speed-and-accuracy.md
	$(PYTHON) verification/speed/speed.py
	$(PYTHON) scripts/dev/wrap.py doc/speed-and-accuracy.md

wrap: ## Wrap lines of the documents that are longer than 120 letters
	@$(PYTHON) scripts/dev/wrap.py $$(git ls-files '*.md' | grep -v '^doc/verification/')

lint: setup-dev ## Check the sources against the house style
	@$(PYTHON) scripts/dev/lint.py --fortitude build/venv/bin/fortitude src

# findent takes "module DIM(name)" of the dimension-generic sources for an array, hence the change and back.
format: setup-dev ## Indent the sources in place
	@for file in $(FORTRAN_SOURCES); do \
	  sed -E 's/\bDIM\((\w+)\)/DIM_OPEN_\1_CLOSE_DIM/g' $$file | build/venv/bin/findent -i2 -k- -Rr \
	    | sed -E 's/DIM_OPEN_(\w+)_CLOSE_DIM/DIM(\1)/g' > build/indented || exit 1; \
	  cmp -s $$file build/indented || { cat build/indented > $$file; echo "indented $$file"; }; \
	done; rm -f build/indented

coverage: setup setup-dev build/coverage/.configured ## Measure the tests' line coverage
	cmake --build build/coverage --parallel $(JOBS)
	find build/coverage -name '*.gcda' -delete
	ctest --test-dir build/coverage --parallel $(JOBS) --output-on-failure --no-tests=error
	mkdir -p build/coverage/report
	build/venv/bin/gcovr --root . --filter src/ --object-directory build/coverage --gcov-ignore-errors=all \
	  --html-details build/coverage/report/index.html --print-summary --txt build/coverage/report/coverage.txt
	@echo "report: $(CURDIR)/build/coverage/report/index.html"

doc: setup setup-dev ## Write all documents, and the pages of the programming interface, as a site: build/site/html/index.html
	build/venv/bin/python scripts/dev/site_pages.py . build/site
	build/venv/bin/ford doc/api.md
	@echo "site: $(CURDIR)/build/site/html/index.html"

install: build ## Install below PREFIX (default /usr/local)
	cmake --install build/release --prefix "$(PREFIX)"

clean: ## Remove everything that was built, the Python environment included
	rm -rf build
