#!/usr/bin/env bash
# Builds presets, whole or one target of each without the tests: ci/build.sh host zynq zynq-linux, ci/build.sh host:vbar
set -euo pipefail
cd "$(dirname "$0")/.."
# Without a compiler cache from earlier builds, a new build folder is one of a unity build: that needs half the time. The
# cache then has the objects of unity builds, which is noted in it: the next new folder is one as well.
is_unity() {
  local cache objects
  cache=$(ccache --get-config cache_dir 2>/dev/null) || return 0
  objects=$(ccache --print-stats | awk '$1 == "files_in_cache" { print $2 }')
  if ((${objects:-0} < 500)); then
    mkdir -p "$cache"
    touch "$cache/vbar_unity"
  fi
  [[ -e $cache/vbar_unity ]]
}
for entry in "$@"; do
  IFS=: read -r preset target <<<"$entry"
  options=() only=()
  if [[ -n $target ]]; then
    options+=(-DVBAR_TESTS=OFF) only=(--target "$target")
  fi
  if [[ $preset == host && ! -d build/host ]] && is_unity; then
    options+=(-DVBAR_UNITY=ON)
    echo "no compiler cache of other builds: a unity build"
  fi
  cmake --preset "$preset" --log-level=WARNING "${options[@]}"
  cmake --build --preset "$preset" "${only[@]}"
done
