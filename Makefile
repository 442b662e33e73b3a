# Two commands: `make replicate` regenerates the whole paper, `make test` verifies it.
# Options: CORES=4, PRESET=draft|paper|reference, OVERLAY=mine.yaml, TARGET=results/figures/NAME.png

SHELL := /bin/sh
PYTHON ?= python3
CORES ?= 2
PRESET ?=
OVERLAY ?=
TARGET ?=
ALLOW_LARGE ?=
AGAINST ?=
PACKAGES ?=
KILLS ?= 24
# No value of an option is executed. Make would expand $(shell ...) in a value that it uses or exports,
# and so each value is taken as it was written and passed on in the environment.
OPTIONS := PYTHON CORES PRESET OVERLAY TARGET AGAINST PACKAGES ALLOW_LARGE KILLS
GIVEN := $(foreach name,$(.VARIABLES),$(if $(filter command,$(origin $(name))),$(name)))
$(foreach name,$(OPTIONS) $(GIVEN),$(eval override $(name) := $$(value $(name))))
export $(OPTIONS)
# Python may write compiled modules. Without them each process imports for 3 s instead of 1.
export PYTHONDONTWRITEBYTECODE :=
# Settings of the user for the installation of packages do not apply to this environment.
unexport PIP_USER PIP_TARGET PIP_PREFIX PIP_ROOT PIP_REQUIRE_VIRTUALENV PIP_DRY_RUN PIP_CONSTRAINT \
    PIP_PYTHON PIP_EDITABLE PIP_REQUIREMENT UV_SYSTEM_PYTHON UV_CONSTRAINT UV_OVERRIDE UV_TARGET UV_PREFIX
VENV := .venv
LOCK := src/slippulse_paper/records/lock.py
READY := $(VENV)/.ready
BIN := $(VENV)/bin
PIP := "$(BIN)/python" -m pip install --quiet --disable-pip-version-check --no-deps
# Install with uv, which the lock contains, or with pip if uv does not run on this machine.
define install
if "$(BIN)/uv" --version >/dev/null 2>&1; then \
    "$(BIN)/uv" pip install --quiet --python "$(BIN)/python" --no-deps --require-hashes --only-binary :all: $(1); \
else \
    $(PIP) --require-hashes --only-binary :all: $(1); \
fi
endef

# Install these packages from source, since they have no wheels. From Python 3.14 on, immutables has no
# wheel either, and needs a C compiler.
FROM_SOURCE = --no-binary connection-pool \
    $$("$(BIN)/python" -c 'import sys; sys.version_info < (3, 14) or print("--no-binary immutables")')

# Jobs find no interpreter if the path has such characters, and Snakemake would notice it late or never.
CHECK_PLACE = case "$$PWD" in *[[:space:]\'\"\\$$\`]*) \
    echo "This folder's path has a space or a quote: $$PWD; move the project to a path without" >&2; \
    exit 1;; esac
CHECK_COUNT = case "$$$(1)" in ""|*[!0-9]*|0*) \
    echo "$(1): $$$(1); allowed: a whole number from 1 on, such as $(1)=2" >&2; exit 1;; esac
CHECK_OPTIONS = $(CHECK_PLACE); $(call CHECK_COUNT,CORES); \
    case "$$PRESET" in *[!A-Za-z0-9_-]*) \
        echo "PRESET: $$PRESET; allowed: the name of a preset, such as draft" >&2; exit 1;; esac; \
    case "$$ALLOW_LARGE" in ""|true|false|yes|no|on|off|1|0) ;; *) \
        echo "ALLOW_LARGE: $$ALLOW_LARGE; allowed: true or false" >&2; exit 1;; esac

.PHONY: help setup slurm notebook docs lock describe tutorial reference replicate rulegraph verify compare test \
    test-library test-pages test-site test-slow test-all faults slurm-test benchmark check clean distclean

help:
	@echo "make replicate   make every figure of the paper, from config/config.yaml, into results/"
	@echo "make verify      list results that a run would make again; AGAINST=other/results compares numbers"
	@echo "make compare     write results/compare.html, with old and new results side by side; AGAINST=other/results"
	@echo "make rulegraph   print the graph of the rules, in the mermaid format"
	@echo "make test        run the tests: theory, convergence, conservation, figures, workflow"
	@echo "make test-library  test the library alone, with the oldest and the newest packages; PACKAGES=oldest or newest"
	@echo "make test-pages  test the pages of results/ in a headless chromium: links, accessibility"
	@echo "make test-site   test the pages of the documentation in a headless chromium"
	@echo "make test-all    run all tests, also the slow ones: edits, every example, killed runs, Slurm"
	@echo "make benchmark   measure the speed of the kernels and of a whole scene, as ratios within one run"
	@echo "make faults      kill a small run at KILLS=24 random times; its results must not change"
	@echo "make docs        write the documentation as a site to results/site"
	@echo "make notebook    install JupyterLab, for .venv/bin/jupyter lab"
	@echo "make slurm       install the additional packages for a Slurm cluster (docs/cluster.md)"
	@echo "make slurm-test  compare the draft results of a Slurm cluster of one node with those without Slurm"
	@echo "make check       check format, types, imports and language"
	@echo "make describe    write the tables of config/README.md, the JSON Schema and rows of docs/columns.md"
	@echo "make tutorial    run docs/tutorial.md, with its pictures in results/tutorial"
	@echo "make reference   write the reference of the Python interface to results/reference"
	@echo "make clean       remove results/;  make distclean: also remove the environment"
	@echo "options          CORES=2 PRESET=draft|paper|reference OVERLAY=mine.yaml TARGET=fig05"

setup: $(READY)

ifndef LOCKED
# If two set-ups run at once, the second waits and then has nothing to do.
$(READY): requirements-build.lock requirements.lock pyproject.toml
	@$(CHECK_PLACE)
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "slippulse needs Python 3.11 or newer; '$(PYTHON)' is `$(PYTHON) --version 2>&1`. Try: make replicate PYTHON=python3.12"; exit 1; }
	@$(PYTHON) $(LOCK) .setup.lock $(MAKE) -s --no-print-directory LOCKED=yes $(READY)
else
$(READY): requirements-build.lock requirements.lock pyproject.toml
	@test ! -e "$(VENV)" || $(PYTHON) $(LOCK) .snakemake/slippulse.lock || { echo "A run is using this folder: wait for it. Then the environment is set up again" >&2; exit 1; }
	@echo "Setting up $(VENV) from requirements.lock (once; 1.2 GB)"
	@rm -rf "$(VENV)"
	@$(PYTHON) -m venv "$(VENV)"
	@$(PIP) --require-hashes --only-binary :all: -r requirements-build.lock
	@$(call install,$(FROM_SOURCE) --no-build-isolation -r requirements.lock)
	@$(PIP) --no-build-isolation --editable .
	@touch "$(READY)"
endif

# The additional packages for a cluster. All others have the versions of requirements.lock.
$(VENV)/.slurm: $(READY) requirements-slurm.lock
	@$(call install,-r requirements-slurm.lock)
	@touch "$@"

slurm: $(VENV)/.slurm

# What the documentation and notebooks add, in the same way.
$(VENV)/.docs $(VENV)/.notebook: $(VENV)/.%: requirements-%.lock $(READY)
	@$(call install,-r $<)
	@touch "$@"

# JupyterLab in the environment; `.venv/bin/jupyter lab` starts it.
notebook: $(VENV)/.notebook

lock:
	uv pip compile --universal --python-version 3.11 --generate-hashes --no-emit-index-url --no-annotate --no-header \
	    --group build --quiet -o requirements-build.lock
	uv pip compile --universal --python-version 3.11 --generate-hashes --no-emit-index-url --no-annotate --no-header \
	    --group dev --quiet pyproject.toml -o requirements.lock
	for group in slurm docs notebook; do \
	    uv pip compile --universal --python-version 3.11 --generate-hashes --no-emit-index-url --no-annotate --no-header \
	        --group $$group --quiet --constraints requirements.lock $$(test $$group != notebook || echo --constraints requirements-docs.lock) \
	        -o requirements-$$group.lock $$(sed -n 's/^\([^= ]*\)==.*/--no-emit-package \1/p' requirements.lock); \
	done

# Write the JSON Schema and the tables of config/README.md, from the definition of the keys.
describe: $(READY)
	@"$(BIN)/python" docs/describe.py

# Run the tutorial as a script.
tutorial: $(READY)
	@"$(BIN)/python" docs/run_tutorial.py results/tutorial

# Write the documentation as a site, from docs, the tutorial and the docstrings.
docs: $(VENV)/.docs
	@"$(BIN)/python" docs/build_site.py results/site

# Write the reference of the Python interface from its docstrings.
reference: $(READY)
	@"$(BIN)/python" docs/reference.py results/reference

replicate: $(READY)
	@$(CHECK_OPTIONS)
	@PATH="$(CURDIR)/$(BIN):$$PATH" exec "$(BIN)/python" workflow/run.py replicate

rulegraph: $(READY)
	@"$(BIN)/python" workflow/run.py rulegraph

# Old beside new: AGAINST is the folder of the old results.
compare: $(READY)
	@test -n "$$AGAINST" || { echo "AGAINST is missing; allowed: a folder of results, such as AGAINST=shipped" >&2; exit 1; }
	@"$(BIN)/python" -m slippulse_paper.report.compare results "$$AGAINST" results/compare.html

verify: $(READY)
	@$(if $(AGAINST),"$(BIN)/python" -m slippulse_paper.report.compare results "$$AGAINST",PATH="$(CURDIR)/$(BIN):$$PATH" "$(BIN)/python" workflow/run.py verify)

faults: $(READY)
	@$(call CHECK_COUNT,KILLS)
	@"$(BIN)/python" tests/faults.py "$$KILLS"

test: $(READY)
	@PATH="$(CURDIR)/$(BIN):$$PATH" python -m pytest -n "$$CORES" --dist loadfile --no-loadscope-reorder -m "not slow"

# Test the library alone, in temporary environments with the oldest and the newest allowed packages.
test-library: $(READY)
	@case "$$PACKAGES" in *[!a-z\ ]*) echo "PACKAGES: $$PACKAGES; allowed: oldest, newest or both" >&2; exit 1;; esac; \
	"$(BIN)/python" tests/library_environments.py $$PACKAGES

test-pages: $(READY)
	@PATH="$(CURDIR)/$(BIN):$$PATH" PAGES=results python -m pytest -m "slow or not slow" tests/browser

# The pages of the documentation in a headless chromium.
test-site: docs
	@PATH="$(CURDIR)/$(BIN):$$PATH" SITE=results/site python -m pytest -m "slow or not slow" tests/browser/test_site.py

test-slow: $(READY)
	@$(call CHECK_COUNT,KILLS)
	@PATH="$(CURDIR)/$(BIN):$$PATH" python -m pytest -n "$$CORES" --dist worksteal -m slow --ignore tests/browser
	@"$(BIN)/python" tests/faults.py "$$KILLS"

test-all: test test-pages test-slow slurm-test

# The daemons of Slurm are often in folders that are not on the path.
slurm-test: $(VENV)/.slurm
	@test "$$(id -u)" = 0 || { echo "make slurm-test starts a Slurm cluster, for which it must be root" >&2; exit 1; }
	@export PATH="$$PATH:/usr/sbin:/sbin" DEBIAN_FRONTEND=noninteractive; \
	hash munged slurmctld slurmd sbatch 2>/dev/null || { apt-get -qq update && \
	    apt-get -qq install -y --no-install-recommends munge slurmctld slurmd slurm-client >/dev/null; } && \
	"$(BIN)/python" tests/slurm_cluster.py

benchmark: $(READY)
	@"$(BIN)/python" -m tests.benchmark

check: $(READY)
	@PATH="$(CURDIR)/$(BIN):$$PATH" ./.ci/check

clean:
	rm -rf results .snakemake .site

distclean: clean
	rm -rf "$(VENV)"
