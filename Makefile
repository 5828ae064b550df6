# make exits with 2 whenever a recipe fails, so through make a gate that found a difference
# (1) looks like one that could not run (2). CI calls .venv/bin/shadeproof itself.

SUITE  ?= default
OUT    ?= reports/out
FILTER ?=
ARGS   ?=
PYTHON ?= python3
PYTHON311 ?= python3.11
NO_APT ?=

BIN := .venv/bin
# A worker takes up to 3 GB. Files stay whole, since their tests share what they set up.
WORKERS := -n auto --maxprocesses 4 --dist loadfile
RUN := --suite '$(SUITE)' --out '$(OUT)' $(if $(FILTER),--filter '$(FILTER)') $(ARGS)

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.PHONY: help compare gate report view references bench attack limits stability efficiency calibrate crosscheck test test-long lint clean FORCE

help: ## show this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "make %-11s %s\n", $$1, $$2 }' Makefile
	@echo
	@echo "Variables: SUITE=$(SUITE) OUT=$(OUT) FILTER=$(FILTER) ARGS=$(ARGS)"
	@echo "           PYTHON=$(PYTHON) NO_APT=$(NO_APT) (1: install no system packages)"
	@echo "           PYTHON311=$(PYTHON311) (for crosscheck, which takes no other version)"

compare: .venv/.stamp ## render a suite with both renderers and report how far apart they are
	@$(BIN)/shadeproof compare $(RUN)

gate: .venv/.stamp ## the same, and fail when a row misses its budget
	@$(BIN)/shadeproof gate $(RUN)

report: .venv/.stamp ## write the report anew from the results in OUT
	@$(BIN)/shadeproof report --out '$(OUT)' $(ARGS)

references: .venv/.stamp ## render the references a suite needs and keep them
	@$(BIN)/shadeproof references --suite '$(SUITE)' $(if $(FILTER),--filter '$(FILTER)') $(ARGS)

# It has a suite of its own, unless another is asked for.
bench: .venv/.stamp ## speed against error: every technique beside path tracing, raw and denoised
	@$(BIN)/shadeproof bench $(if $(filter file,$(origin SUITE)),,--suite '$(SUITE)') \
		--out '$(OUT)' $(if $(FILTER),--filter '$(FILTER)') $(ARGS)

stability: .venv/.stamp ## the shaders on every hard input, against double precision and Mitsuba
	@$(BIN)/shadeproof stability --out '$(OUT)' $(ARGS)

view: .venv/.stamp ## a live window: orbit, change material, light, weight, technique
	@$(BIN)/shadeproof view --suite '$(SUITE)' $(if $(FILTER),--filter '$(FILTER)') $(ARGS)

attack: .venv/.stamp ## inject shader bugs into copies of the renderer: does the gate see them?
	@$(BIN)/shadeproof attack $(if $(filter file,$(origin SUITE)),,--suite '$(SUITE)') \
		--out '$(OUT)' $(ARGS)

limits: .venv/.stamp ## the smallest errors that the gate catches, and its false alarms
	@$(BIN)/shadeproof limits $(if $(filter file,$(origin SUITE)),,--suite '$(SUITE)') \
		--out '$(OUT)' $(if $(FILTER),--filter '$(FILTER)') $(ARGS)

crosscheck: .venv/.stamp .venv-crosscheck/.stamp ## hold the truths against Blender's Cycles
	@$(BIN)/shadeproof compare --suite crosscheck --out '$(OUT)' \
		$(if $(FILTER),--filter '$(FILTER)') $(ARGS) --candidate \
		'$(BIN)/python -m reports.crosscheck .venv-crosscheck/bin/python {case} {out}'

efficiency: .venv/.stamp ## time the references to an interval, beside plain path tracing
	@$(BIN)/shadeproof efficiency --suite '$(SUITE)' $(if $(FILTER),--filter '$(FILTER)') $(ARGS)

calibrate: .venv/.stamp ## do the intervals hold? figures from few samples against 16 times as many
	@$(BIN)/shadeproof calibrate $(ARGS)

test: .venv/.stamp ## check style and imports, and run the short tests
	@$(BIN)/ruff check --quiet
	@$(BIN)/lint-imports --no-cache >.venv/imports.log || { cat .venv/imports.log; exit 1; }
	@$(BIN)/pytest -q -m 'not long' $(WORKERS)

test-long: .venv/.stamp ## run every test, those of minutes too
	@$(BIN)/pytest

lint: .venv/.stamp ## check style, format and imports
	@$(BIN)/ruff check
	@$(BIN)/ruff format --check
	@$(BIN)/lint-imports --no-cache

clean: ## remove .venv, caches and reports/out; the rendered references stay
	@rm -rf .venv .venv-crosscheck .pytest_cache .ruff_cache .mypy_cache .import_linter_cache .hypothesis
	@rm -rf build dist shadeproof.egg-info reports/out
	@find scenes renderer reference reports tests -name __pycache__ -prune -exec rm -rf {} +

# A .venv counts as sound when its Python runs and its commands were written for this folder;
# one that was moved, or whose Python has gone, is made anew. An interrupted one has no stamp.
SOUND := $(shell $(BIN)/python -c 'import pip' 2>/dev/null && \
	grep -qsF '$(CURDIR)/.venv/' $(BIN)/shadeproof && echo yes)

.venv/.pinned: requirements/requirements.txt requirements/system.sh $(if $(SOUND),,FORCE)
	@PYTHON='$(PYTHON)' NO_APT='$(NO_APT)' requirements/system.sh
	@echo "shadeproof: installing the pinned Python packages into .venv (a minute or so)"
	@$(PYTHON) -m venv --clear .venv
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check \
		--require-hashes -r requirements/requirements.txt
	@touch $@

.venv/.stamp: .venv/.pinned pyproject.toml
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check \
		--no-deps --no-build-isolation -e .
	@touch $@

# Blender comes as the package bpy, for one version of Python and with an older numpy: apart.
.venv-crosscheck/.stamp: requirements/crosscheck.txt requirements/system.sh
	@PYTHON='$(PYTHON311)' NO_APT='$(NO_APT)' requirements/system.sh blender
	@echo "shadeproof: installing Blender into .venv-crosscheck (1 GB, some minutes)"
	@$(PYTHON311) -m venv --clear .venv-crosscheck
	@.venv-crosscheck/bin/python -m pip install --quiet --disable-pip-version-check \
		--require-hashes -r requirements/crosscheck.txt
	@touch $@
