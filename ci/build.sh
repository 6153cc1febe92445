#!/usr/bin/env bash
# Builds presets, whole or one target of each without the tests: ci/build.sh host zynq zynq-linux, ci/build.sh host:vbar
set -euo pipefail
cd "$(dirname "$0")/.."
# Without a compiler cache from earlier builds, a new build folder is one of a unity build: that needs half the time.
objects=$(ccache --print-stats 2>/dev/null | awk '$1 == "files_in_cache" { print $2 }' || true)
for entry in "$@"; do
  IFS=: read -r preset target <<<"$entry"
  options=() only=()
  if [[ -n $target ]]; then
    options+=(-DVBAR_TESTS=OFF) only=(--target "$target")
  fi
  if [[ $preset == host && ! -d build/host ]] && ((${objects:-0} < 500)); then
    options+=(-DVBAR_UNITY=ON)
    echo "no compiler cache: a unity build"
  fi
  cmake --preset "$preset" --log-level=WARNING "${options[@]}"
  cmake --build --preset "$preset" "${only[@]}"
done
