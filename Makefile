# `make design` and `make test` are all that a newcomer needs; the rest serves those who work on firmtouch.
PYTHON ?= python3
MODEL  ?= models/planar_2r_wall.yaml
BIN    := .venv/bin
SOURCE := $(shell find toolkit -name '*.py')

# Matrices here are small: a second thread for each costs more than it gives.
export OPENBLAS_NUM_THREADS ?= 1

.PHONY: design test test-slow lint benchmark samples lock clean

design: .venv/package
	$(BIN)/firmtouch design $(MODEL)

test: .venv/test
	$(BIN)/python -m pytest -n auto -m "not slow"

test-slow: .venv/test
	$(BIN)/python -m pytest -n auto --dist worksteal -m slow

lint: .venv/test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

benchmark: .venv/test
	$(BIN)/python -m tests.benchmarks

# The three finished reports that the repository keeps.
samples: .venv/package
	for model in planar_2r_wall two_arms_bar; do \
	    $(BIN)/firmtouch design models/$$model.yaml --out reports/samples/$$model || exit 1; \
	done
	$(BIN)/firmtouch thermal models/thermal/fingertip_film.yaml --out reports/samples/fingertip_film

# The three stamps: the environment, the package compiled in it, and the test extras.
.venv/core: requirements.lock
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements.lock
	touch $@

.venv/package: .venv/core pyproject.toml $(SOURCE)
	test -x $(BIN)/firmtouch -a $@ -nt pyproject.toml || \
	    $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	$(BIN)/python -m compileall -q toolkit
	touch $@

.venv/test: .venv/package requirements-test.lock
	test $@ -nt requirements-test.lock || \
	    $(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements-test.lock
	touch $@

# The locks hold names, versions and hashes, and no address. `pip install uv` first.
LOCK := uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-header --no-annotate --group build
lock:
	$(LOCK) pyproject.toml --output-file requirements.lock
	$(LOCK) --extra test --extra oracle --constraint requirements.lock pyproject.toml --output-file requirements-test.lock

clean:
	rm -rf .venv build dist .mypy_cache .pytest_cache .ruff_cache .hypothesis
