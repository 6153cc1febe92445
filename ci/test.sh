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
tests/peers/wire_formats/install_npm.sh
ctest --preset host --parallel 2
say "unit tests under the address and undefined-behaviour sanitizers"
ci/build.sh asan
ctest --preset asan --parallel 2 --label-exclude "integration|peer"
say "flight code with the second compiler, all warnings errors"
cmake --preset host-clang --log-level=WARNING
cmake --build --preset host-clang --parallel --target flight_code
say "all passed"
