# Two commands, each enough on a fresh machine with Python 3.11, 3.12 or 3.13, git and make:
#   make calibrate   a simulated joint, from sweep to exported model, into runs/demo
#   make test        the test suite, in some eight minutes on two cores
# And for work on it: make test-slow (the tests that take long), make lint, make docs (the site), make lock, make clean.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
JOBS ?= 2

.PHONY: calibrate test test-slow lint docs lock clean

$(VENV)/installed: requirements.lock pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))' || { echo "what requirements.lock pins is for Python 3.11, 3.12 and 3.13; name one: make PYTHON=python3.11"; exit 1; }
	@echo "Installing what requirements.lock pins into $(VENV) (a few minutes, once) ..."
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -r requirements.lock
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	@touch $@

calibrate: $(VENV)/installed
	$(BIN)/fricomp calibrate --backend sim --out runs/demo --overwrite

# Each worker takes neighbouring tests, so that what a module makes for all of them is made once, and helps the other
# with its rest.
test: $(VENV)/installed
	$(BIN)/python -m pytest -n $(JOBS) --dist worksteal -m "not slow"

# Whole diagnoses, soaks and sweeps of many cases: what the quick tests cannot show.
test-slow: $(VENV)/installed
	$(BIN)/python -m pytest -n $(JOBS) --dist worksteal -m slow

lint: $(VENV)/installed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

# The documentation as a site: open build/site/index.html, no server and no network needed.
docs: $(VENV)/installed
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet
	@echo "The site is in build/site: open build/site/index.html"

# Write down what is installed now; torch without its build tag, so that the CPU build of any index serves.
lock:
	$(BIN)/python -m pip freeze --all --exclude-editable --exclude pip --exclude fricomp | sed 's/+cpu$$//' > requirements.lock

clean:
	rm -rf $(VENV) build dist *.egg-info
