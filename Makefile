# `make` lists the targets. `make lab PORT=8890` chooses the port, `make lab PYTHON=python3.12` the
# interpreter, `KERNELS=FILE` keeps what is compiled in a file too, for the next clone on this machine.
PYTHON ?= python3
PORT ?=
CHAPTERS ?= $(sort $(wildcard notebooks/*.ipynb))

SHELL := /bin/sh
RUN := .venv/bin/python
SETUP := .venv/segmap-for-dev
WARM := .venv/segmap-is-warm
STARTED := .venv/segmap-can-start
SOURCES := $(wildcard segmap/*.py segmap/*/*.py segmap/*/*/*.py segmap/*/*/*/*.py)
# What a student has, and what runs the chapters there.
ALONE := .venv-lab/segmap-for-lab
# uv takes seconds where pip takes minutes. It asks the registry that pip would ask.
UV = env PATH="$$PATH:$(CURDIR)/.venv/bin" \
	UV_DEFAULT_INDEX="$${UV_DEFAULT_INDEX:-$${PIP_INDEX_URL:-$$($(RUN) -m pip config get global.index-url 2> /dev/null)}}" uv
# A worker more than there are cores, since many tests wait for other programs; a worker runs whole
# files, so that what a file prepares is prepared once; they come in the order of their names, since
# those with few tests are often the longest.
SPREAD := -n $(shell $(PYTHON) -c 'import os; print(os.cpu_count() + 1)') --dist loadscope --no-loadscope-reorder
# That folder keeps Lab from asking about news, since a classroom may be offline, and stores panels
# as their pictures. Students work in copies: what they save changes nothing that is tracked.
LAB = JUPYTER_CONFIG_PATH="$(CURDIR)/notebooks/tools/jupyter$${JUPYTER_CONFIG_PATH:+:$$JUPYTER_CONFIG_PATH}" \
	$(RUN) -m jupyterlab --ip=127.0.0.1 $(if $(PORT),--port=$(PORT) --ServerApp.port_retries=0) \
	$(if $(filter 0,$(shell id -u)),--allow-root) --ServerApp.log_level=WARN --LabApp.default_url=/lab/tree/work/01_start_here.ipynb
# Without a display the address is printed, and served until Control-C.
BROWSER = $(if $(DISPLAY)$(WAYLAND_DISPLAY)$(filter Darwin,$(shell uname)),,--no-browser)
NBVAL := --nbval --nbval-current-env --nbval-cell-timeout=120 \
	--nbval-sanitize-with=tests/nbval.cfg -p no:cacheprovider

# Tests of the library run where its app cannot be imported; all others follow.
LIBRARY := $(foreach name,alignment basics experiments exports matching metrics panels plan plotting \
	quadtree readers reduction sensors,tests/$(name))
REST := $(filter-out $(LIBRARY),$(patsubst %/,%,$(filter-out tests/__pycache__/,$(wildcard tests/*/))))

# Every compiled loop on small cases, on bad arguments, on extreme lengths and on damaged maps.
INDEXED := $(wildcard $(foreach name,warm entry_points returns quadtree_files reduction_properties,tests/*/test_$(name).py))

.NOTPARALLEL:
.PHONY: help lab app handout test test-all test-lowest mutants fuzz bounds refresh panels bench book slides clean

help: ## list the targets
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/  make \1\t\2/p' Makefile

lab: .venv/segmap-for-lab ## set up, copy the chapters to work/, open them in JupyterLab (PORT=8890 chooses the port)
	@$(RUN) -m segmap notebooks work & copying=$$!; $(MAKE) --no-print-directory $(STARTED) && wait $$copying
	@$(LAB) $(BROWSER)

app: .venv/segmap-for-app $(WARM) ## set up, then serve the workbench as a page of its own (PORT=8890 chooses the port)
	@$(RUN) -m segmap app $(if $(PORT),--port $(PORT))

wheel: $(SETUP) ## write the wheel into dist/, for machines without a clone
	$(RUN) -m hatchling build -t wheel -d dist

handout: .venv/segmap-for-grading ## an assignment for nbgrader in build/course (ARGS="--chapters 07,17", DIR=...)
	$(RUN) -m segmap_course handout $(or $(DIR),build/course/lab1) $(ARGS)

test: $(SETUP) $(WARM) $(ALONE) ## set up, then prove it: style, types, tests, examples and every chapter
	$(RUN) -m ruff check .
	$(RUN) -m ruff format --check .
	$(RUN) -m mypy
	SEGMAP_ALONE=1 $(RUN) -m pytest $(SPREAD) -m "not slow" -p no:nbval segmap $(LIBRARY)
	$(RUN) -m pytest $(SPREAD) -m "not slow" -p no:nbval segmap_app notebooks/segmap_course $(REST)
	PYTHONWARNINGS=error::DeprecationWarning:__main__ .venv-lab/bin/python -m pytest $(SPREAD) $(NBVAL) notebooks/*.ipynb

test-all: test bounds .venv/segmap-for-grading ## the same, every index of the loops checked, then the tests that are marked slow
	$(RUN) -m pytest $(SPREAD) -m slow

test-lowest: | $(RUN) ## the tests once more, in .venv-lowest, with the oldest packages that pyproject.toml allows
	rm -rf .venv-lowest
	$(UV) venv --quiet --python "$$(command -v $(PYTHON))" .venv-lowest
	$(UV) pip install --quiet --python .venv-lowest/bin/python --resolution lowest-direct --editable '.[dev]'
	.venv-lowest/bin/python -m pytest $(SPREAD)

refresh: $(SETUP) ## run the chapters again and store what they show (CHAPTERS="..." for some)
	$(RUN) notebooks/tools/refresh.py $(CHAPTERS)

mutants: $(SETUP) $(WARM) ## plant bugs by rule and see a test fail (PACKAGE=reduction ARGS="--count 40 --seed 2")
	$(RUN) -m benchmarks.mutants $(or $(PACKAGE),reduction) $(ARGS)

fuzz: $(SETUP) $(WARM) ## read 5 000 tables, 100 000 damaged files: logs, maps (MUTANTS=500 ARGS="-k carmen" for fewer)
	SEGMAP_TABLES=5000 $(RUN) -m pytest -q -p no:nbval tests/readers/test_declared_tables.py -k all_ways
	SEGMAP_MUTANTS=$(or $(MUTANTS),4600) $(RUN) -m pytest $(SPREAD) --dist load -m "not slow" -p no:nbval \
		tests/app/files/test_damage.py tests/quadtree/test_quadtree_files.py $(or $(ARGS),-k "damaged_ or crafted")

bounds: $(SETUP) ## run every compiled loop with each index checked
	NUMBA_BOUNDSCHECK=1 NUMBA_CACHE_DIR="$(CURDIR)/build/bounds" $(RUN) -m pytest $(SPREAD) -p no:nbval $(INDEXED)

bench: $(SETUP) ## measure speed against the references, as ratios from one run (ARGS=--record keeps records)
	$(RUN) -m benchmarks $(ARGS)

panels: $(SETUP) ## take the pictures of panels that the book shows (CHAPTERS="..." for some)
	$(RUN) notebooks/tools/panel_pictures.py $(CHAPTERS)

book: $(SETUP) ## make web pages of chapters and API, build/book/index.html, to read offline
	PYTHONPATH=notebooks/tools $(RUN) -m book

slides: $(SETUP) ## make slides of chapters, build/slides/*.html, to show offline (CHAPTERS="..." for some)
	PYTHONPATH=notebooks:notebooks/tools $(RUN) notebooks/tools/slides.py $(CHAPTERS)

clean: ## remove what make made, the environment too; work/ stays
	rm -rf .venv .venv-lab .venv-lowest build dist .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find . -name __pycache__ -prune -exec rm -rf {} +
	find . -name .ipynb_checkpoints -prune -exec rm -rf {} +

$(RUN):
	@$(PYTHON) -c 'import sys; sys.version_info >= (3, 11) or sys.exit("segmap needs Python 3.11 \
	or later, and $(PYTHON) is %d.%d: try make PYTHON=python3.12" % sys.version_info[:2])'
	@rm -rf .venv
	@if command -v uv > /dev/null; then uv venv --quiet --seed --python "$$(command -v $(PYTHON))" .venv; \
	elif $(PYTHON) -m venv .venv; then $(RUN) -m pip install --quiet --disable-pip-version-check uv 2> /dev/null || true; \
	else rm -rf .venv; echo "No virtual environment: on Debian and Ubuntu, apt install python3-venv"; exit 1; fi

# Extras of pyproject.toml, each as far as it is needed: the lab without the tools of the tests. The
# stamp is written last, so an installation that failed is tried again.
install = @{ { test -x .venv/bin/uv || command -v uv; } && \
	  $(UV) pip install --quiet --python $(1) --editable $(2) || \
	  $(RUN) -m pip --python $(1) install --quiet --disable-pip-version-check --editable $(2); \
	} > .venv/install.log 2>&1 || { echo "The packages cannot be had: without a network see \
	'Classrooms without a network' in environment.md; what pip said is in .venv/install.log" >&2; exit 1; }

.venv/segmap-for-%: pyproject.toml | $(RUN)
	@echo "Installing what segmap needs for $* into .venv ..."
	$(call install,$(RUN),'.[$*]')
	@touch $@

# The same versions as in .venv, so that what was compiled there serves here too.
$(ALONE): pyproject.toml | $(SETUP)
	@echo "Installing what the chapters need into .venv-lab ..."
	@rm -rf .venv-lab && $(RUN) -m venv --without-pip .venv-lab
	@$(RUN) -m pip freeze --exclude-editable > .venv/versions.txt
	$(call install,.venv-lab/bin/python,'.[lab]' nbval pytest-xdist --constraint .venv/versions.txt)
	@touch $@

# Once more whenever a source has changed; what did not change is not compiled again. Machine code of
# other sources, of another processor or another numba is left alone.
$(WARM): .venv/segmap-for-lab $(SOURCES)
	@$(if $(KERNELS),test ! -f $(KERNELS) || tar -xf $(KERNELS))
	@$(RUN) -m segmap warm
	@$(if $(KERNELS),mkdir -p $(dir $(KERNELS)) && find segmap -name '*.nb[ci]' | tar -cf $(KERNELS) -T -)
	@touch $@

# Lab opens when what chapter 01 needs is compiled. The rest is compiled behind it, which Control-C
# leaves alone: it ends by itself within a minute.
$(STARTED): .venv/segmap-for-lab $(SOURCES)
	@$(if $(KERNELS),test ! -f $(KERNELS) || tar -xf $(KERNELS))
	@$(RUN) -m segmap warm --first
	@touch $@
	@nice $(MAKE) --silent $(WARM) > /dev/null &
