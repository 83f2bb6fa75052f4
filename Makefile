# The targets that people use. Everything that is built is below .ws/; `make help` lists the targets.
SHELL := /bin/bash
.SHELLFLAGS := -eo pipefail -c
.DEFAULT_GOAL := help
# One goal after the other, because two goals that install packages at the same time would disturb each other.
.NOTPARALLEL:
.PHONY: help deps build build-tests demo docs test nightly explore lint bench study study-trial experiment picture figures clean
.PHONY: deps-docs deps-test deps-lint deps-bench deps-study deps-experiment deps-picture

WS := $(CURDIR)/.ws
# Debian's own Python, for which ROS was built; PATH may have another python3 first.
PYTHON := /usr/bin/python3
BUILD_TYPE ?= RelWithDebInfo
# ROS Noetic and ROS One (Ubuntu, not tested) are outside of the system's paths. Debian's own packages need no setup.
ROS_SETUP := $(firstword $(wildcard /opt/ros/noetic/setup.bash /opt/ros/one/setup.bash))
ENTER_ROS := $(if $(ROS_SETUP),source $(ROS_SETUP) &&)
ENTER := source '$(WS)/setup.sh' &&

# No other workspace and no running ROS master of the calling shell are used.
unexport CMAKE_PREFIX_PATH PYTHONPATH ROS_PACKAGE_PATH ROS_HOSTNAME ROS_NAMESPACE ROS_MASTER_URI
export ROS_IP := 127.0.0.1
export ROS_HOME := $(WS)/ros_home

help:  ## print this list
	@sed -n 's/^\([a-z-]*\):.*## /  make \1\t/p' Makefile | expand -t 20
	@echo
	@echo 'Options: make demo CLOCK=scaled FACTOR=10 ROBOTS=5 CSV=readings.csv MISSION=mission.yaml; make test ONLY=part_of_a_name;'
	@echo '         make study STUDY_FIELD=csv:/path/of/readings.csv (or meuse; without it, a synthetic field)'
	@echo 'A shell in the built environment: source .ws/setup.sh'

deps:  ## install missing Debian packages to build and run, by apt
	@bash tools/install_deps

# Further packages of other targets. They come before `build`, so that all packages are installed at once.
deps-docs deps-test deps-lint deps-bench deps-study deps-experiment deps-picture:
	@bash tools/install_deps $(patsubst deps-%,%,$@)

build: deps  ## build the catkin package in .ws/
	@$(ENTER_ROS) bash tools/build $(PYTHON) $(BUILD_TYPE)

demo: $(if $(RVIZ),deps-picture) build  ## run a mission of five robots, with a progress bar and a table; RVIZ=1 shows it, ROUTES=1 goes around buildings, WORLD=warehouse has orders
	@$(ENTER) rosrun move_base_abstract demo \
	  $(if $(CLOCK),--clock '$(CLOCK)') $(if $(FACTOR),--factor '$(FACTOR)') $(if $(ROBOTS),--robots '$(ROBOTS)') $(if $(RVIZ),--rviz) \
	  $(if $(ROUTES),--routes) $(if $(WORLD),--world '$(WORLD)') $(if $(POLICY),--policy '$(POLICY)') \
	  $(if $(CSV),--csv '$(abspath $(CSV))') $(if $(MISSION),--mission '$(abspath $(MISSION))')

build-tests: deps-test deps
	@$(ENTER_ROS) bash tools/build $(PYTHON) $(BUILD_TYPE) tests
	@cmake --build '$(WS)/build' --target tests -j$$(nproc) >'$(WS)/build_tests.log' || { cat '$(WS)/build_tests.log'; exit 1; }

test: build-tests  ## run all tests; ONLY=part_of_a_name runs some
	@$(ENTER) $(PYTHON) tools/run_tests.py $(if $(ONLY),--only '$(ONLY)')

nightly: build-tests  ## run each scenario 20 times under other conditions, and all that `make test` leaves out; PART=3/16 HOURS=2 ONLY=part_of_a_name
	@$(ENTER) $(PYTHON) tools/run_tests.py --night $(or $(RUNS),20) $(if $(PART),--part '$(PART)') \
	  $(if $(HOURS),--hours '$(HOURS)') $(if $(ONLY),--only '$(ONLY)')

explore: deps-test build  ## run the property tests for long, with other examples each time; EXAMPLES=50000 of each, ONLY=part_of_a_test
	@$(ENTER) EXAMPLES='$(EXAMPLES)' '$(WS)/venv/bin/python' -m pytest -q -p no:cacheprovider test/unit -m hypothesis \
	  --hypothesis-profile=explore $(if $(ONLY),-k '$(ONLY)')

lint: deps-lint build  ## check the sources: ruff, borders between packages, Python 3.8, catkin_lint, clang-format, shell scripts
	@$(ENTER) bash tools/lint

bench: deps-bench deps-test deps-study build  ## run the benchmarks; the results are JSON lines
	@$(ENTER_ROS) bash tools/build $(PYTHON) $(BUILD_TYPE) tests
	@cmake --build '$(WS)/build' --target bench_ping_pong bench_rate bench_dense_agent >'$(WS)/build_bench.log' || \
	  { cat '$(WS)/build_bench.log'; exit 1; }
	@$(ENTER) $(PYTHON) bench/lockstep $(BENCH_ARGS) && $(PYTHON) bench/launcher $(BENCH_ARGS) && \
	  $(PYTHON) bench/dense $(BENCH_ARGS) && $(PYTHON) bench/experiments $(BENCH_ARGS) && \
	  $(PYTHON) bench/dense --one-core --kinds roscpp --agents 4 8 $(BENCH_ARGS) && \
	  $(PYTHON) bench/dense --lookahead 0.1 --kinds roscpp --agents 4 8 --rates 20/10 $(BENCH_ARGS) && \
	  $(PYTHON) bench/run $(BENCH_ARGS) && $(PYTHON) bench/scale $(BENCH_ARGS) && \
	  $(PYTHON) bench/world $(BENCH_ARGS) && '$(WS)/venv/bin/python' bench/plain --simpy '$(WS)/plain/bin/python' \
	    --irsim '$(WS)/peers/bin/python' $(BENCH_ARGS)

experiment: deps-experiment build  ## run a small experiment, with a report in .ws/experiment, resumable; EXPERIMENT=FILE runs another one
	@$(ENTER) rosrun move_base_abstract experiment run '$(or $(EXPERIMENT),config/experiments/patrol.yaml)' \
	  -o '$(WS)/experiment' $(EXPERIMENT_ARGS)

study-trial: deps-study build  ## run one trial of the soil mapping study; TRIAL_ARGS='--seed 3 --clock scaled --factor 10'
	@$(ENTER) $(PYTHON) examples/study.py trial $(if $(STUDY_FIELD),--field '$(STUDY_FIELD)') --output '$(WS)/trial' $(TRIAL_ARGS)

study: deps-study build  ## run the whole study in .ws/study, resumable; STUDY_1X=1 adds real time, STUDY_ARGS='--seeds 3' adds options
	@$(ENTER) $(PYTHON) examples/study.py run $(if $(STUDY_FIELD),--field '$(STUDY_FIELD)') --output '$(WS)/study' $(STUDY_ARGS)

picture: deps-picture deps-study build  ## take the pictures of the README, from RViz on a screen without a monitor
	@$(ENTER) $(PYTHON) tools/take_picture.py && $(PYTHON) tools/take_soil_picture.py

figures: build-tests  ## measure the README's figures on this machine, which does nothing else, and write the ranges over all machines
	@cmake --build '$(WS)/build' --target bench_ping_pong bench_dense_agent >'$(WS)/build_bench.log'
	@$(ENTER) $(PYTHON) tools/figures.py

docs: deps-docs build  ## build the documentation site, .ws/docs/html/index.html; a broken link is an error
	@$(ENTER) $(PYTHON) tools/build_docs.py '$(WS)/docs'

clean:  ## remove everything that was built
	rm -rf '$(WS)'
