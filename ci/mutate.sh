#!/usr/bin/env bash
# Mutation test of the unit tests. Kernels are modified to return NaN, zero and the opposite sign, each in turn, and
# a test of the kernel's own module must fail. Prints a table; exits with 1 if a mutant survives.
#   ci/mutate.sh            all kernels of ci/mutants.toml: minutes, once the unit tests are built
#   ci/mutate.sh orbit      those whose name contains a word
set -euo pipefail
cd "$(dirname "$0")/.."
cmake --preset host --log-level=WARNING
cmake --build --preset host --parallel --target $(python3 ci/mutate.py --programs "$@")
exec python3 ci/mutate.py "$@"
