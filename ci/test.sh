#!/usr/bin/env bash
# Installs what is missing, builds for every target and runs all tests: short arcs where a whole mission would be long.
# The whole missions are flown by ci/verify.sh.
set -euo pipefail
cd "$(dirname "$0")/.."
started=$SECONDS
say() { printf '\n== %s (%d s)\n' "$1" $((SECONDS - started)); }

say "packages"
ci/install.sh
say "build for this computer, for the bare Zynq and for Linux on the Zynq"
ci/build.sh host zynq zynq-linux
say "tests"
timeout 120 tests/peers/wire_formats/install_npm.sh || echo "npm package cobs not fetched: its test will be skipped"
ctest --preset host --parallel 2
say "the second compiler, all warnings errors, and unit tests under its address and undefined-behaviour sanitizers"
cmake --preset asan --log-level=WARNING
cmake --build --preset asan --parallel --target flight_code vbar unit_tests
ctest --preset asan --parallel 2 --label-regex unit
say "fuzzing of every decoder and loader"
ci/fuzz.sh 10
say "all passed"
