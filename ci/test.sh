#!/usr/bin/env bash
# Installs missing packages, builds for every target and runs all tests: short arcs in place of long missions.
# The complete missions are flown by ci/verify.sh; the first verdict on a change is that of ci/quick.sh.
set -euo pipefail
cd "$(dirname "$0")/.."
started=$SECONDS
say() { printf '\n== %s (%d s)\n' "$1" $((SECONDS - started)); }

say "packages"
ci/install.sh test peers
timeout 120 tests/peers/wire_formats/install_npm.sh || echo "npm package cobs not fetched: its test will be skipped"
say "format"
ci/format.sh
say "build for this computer, for the bare Zynq and for Linux on the Zynq"
ci/build.sh host zynq zynq-linux
say "tests"
ctest --preset host --parallel 2
say "mutants of kernels: the tests of their modules must fail"
ci/mutate.sh
say "the second compiler, all warnings errors, and a quarter of the unit tests under its sanitizers"
ci/sanitize.sh
say "fuzzing: every decoder and loader for a few seconds"
ci/fuzz.sh 3
say "all passed"
