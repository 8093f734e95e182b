# Two commands for a person: `make demo` and `make test`. Everything lands in .venv and is installed once.
#   make demo PYTHON=python3.12                                            another interpreter
#   make test PIP_ARGS="--extra-index-url https://download.pytorch.org/whl/cpu"   where to find a CPU build of torch
# pip prefers a CPU build of torch ("+cpu") wherever one of its indexes or --find-links folders offers it.

PYTHON ?= python3
VENV ?= .venv
PIP_ARGS ?=
DEMO ?= demo
SEED ?= 1
PYTEST_ARGS ?=

BIN := $(VENV)/bin
INSTALL := $(BIN)/python -m pip install --disable-pip-version-check $(PIP_ARGS)

.PHONY: demo test lint format picture page-picture clean

demo: $(VENV)/.ready
	$(BIN)/scenewright demo -o $(DEMO) --seed $(SEED) --force

test: $(VENV)/.ready-dev
	$(BIN)/python -m pytest $(PYTEST_ARGS)
	$(BIN)/scenewright bench guard

lint: $(VENV)/.ready-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy -p scenewright

# The picture in the README: the demo's own contact sheet, smaller and with fewer colours.
picture: $(VENV)/.ready
	$(BIN)/scenewright demo -o $(DEMO) --seed $(SEED) --size 360x240 --force
	$(BIN)/python -c "from PIL import Image; i = Image.open('$(DEMO)/contact_sheet.png').convert('RGB'); \
	  i = i.resize((1000, round(i.height * 1000 / i.width)), Image.Resampling.LANCZOS); \
	  i.quantize(256, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save('docs/demo.png', optimize=True)"

# The picture of the page in the README and in docs/view.md, as its test makes it in a browser.
page-picture: $(VENV)/.ready-dev
	mkdir -p $(DEMO)
	SCENEWRIGHT_PAGE_PICTURES=$(DEMO) $(BIN)/python -m pytest -n 0 -m slow tests/agent/view/test_picture_of_the_page.py
	$(BIN)/python -c "from PIL import Image; \
	  Image.open('$(DEMO)/view.png').convert('RGB').save('docs/view.jpg', quality=88, optimize=True, subsampling=0)"

format: $(VENV)/.ready-dev
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

clean:
	rm -rf $(VENV) $(DEMO) build dist scenewright.egg-info

# One pip command each, so that torch and whatever depends on it are resolved together.
$(VENV)/.ready: $(VENV)/pyvenv.cfg pyproject.toml
	$(INSTALL) -e .
	touch $@

$(VENV)/.ready-dev: $(VENV)/pyvenv.cfg pyproject.toml
	$(INSTALL) -e ".[dev]"
	touch $@ $(VENV)/.ready

$(VENV)/pyvenv.cfg:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Scenewright needs Python 3.11 or newer: make PYTHON=python3.12 ...")'
	$(PYTHON) -m venv $(VENV)
