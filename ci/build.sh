#!/usr/bin/env bash
# Builds presets: ci/build.sh host zynq zynq-linux
set -euo pipefail
cd "$(dirname "$0")/.."
for preset in "$@"; do
  cmake --preset "$preset" --log-level=WARNING
  cmake --build --preset "$preset"
done
