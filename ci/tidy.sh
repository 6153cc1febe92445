#!/usr/bin/env bash
# clang-tidy, every finding an error (.clang-tidy, fsw/.clang-tidy, boards/.clang-tidy).
#   ci/tidy.sh [FILE_PATTERN...]   flight code, or the sources whose path matches, without the path-sensitive analyzer
#   ci/tidy.sh --changed           the sources that differ from origin/main or, on it, from the commit before
#   ci/tidy.sh --all               everything, with the analyzer (half an hour on two cores)
set -euo pipefail
cd "$(dirname "$0")/.."

analyzer=(-checks=-clang-analyzer-\*)
sources=("$@")
if [[ ${1:-} == --all ]]; then
  analyzer=()
  sources=(fsw boards hil_drivers emulators pil_bridge host_sim tests)
elif [[ ${1:-} == --changed ]]; then
  base=$(git merge-base HEAD origin/main 2>/dev/null || true)
  if [[ -z $base || $base == "$(git rev-parse HEAD)" ]]; then base=$(git rev-parse --verify --quiet HEAD~1 || true); fi
  mapfile -t sources < <(git diff --name-only --diff-filter=d ${base:+"$base"} -- '*.cpp')
  # A commit that changes everything (for example a renaming) is checked by --all.
  if ((${#sources[@]} > 40)); then
    echo "clang-tidy: ${#sources[@]} sources differ from ${base:0:12}; the first 40 are checked, ci/tidy.sh --all checks every file"
    sources=("${sources[@]:0:40}")
  fi
  if ((${#sources[@]} == 0)); then
    echo "clang-tidy: no source differs from ${base:0:12}"
    exit 0
  fi
elif (($# == 0)); then
  sources=(fsw boards)
fi

# Clang's command lines, and the headers that the build generates.
cmake --preset asan --log-level=WARNING >/dev/null
cmake --build --preset asan --target flight_code vbar_host_sim_twins vbar_host_sim_twins_camera

root=$(printf '%s' "$PWD" | sed 's/[][\.*^$+?(){}|]/\\&/g')
log=$(mktemp)
trap 'rm -f "$log"' EXIT
status=0
run-clang-tidy -quiet -j "$(nproc)" -p build/asan "${analyzer[@]}" \
  "${sources[@]/#/^$root/}" >"$log" 2>&1 || status=$?
# The remaining lines are the findings, each once, without the commands and the counts of suppressed warnings.
grep -vE '^(clang-tidy|[0-9]+ warnings? (generated|treated)|Suppressed|Use -header-filter|Enabled checks:|$)' "$log" |
  awk '/(error|warning): / { show = !seen[$0]++ } show' || true
((status == 0)) && echo "clang-tidy: no findings in ${sources[*]}"
exit "$status"
