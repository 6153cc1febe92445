#!/usr/bin/env bash
# clang-tidy, every finding an error (.clang-tidy, fsw/.clang-tidy, boards/.clang-tidy).
#   ci/tidy.sh [FILE_PATTERN...]   flight code, or the sources whose path matches, without the path-sensitive analyzer
#   ci/tidy.sh --all               everything, with the analyzer (half an hour on two cores)
set -euo pipefail
cd "$(dirname "$0")/.."

analyzer=(-checks=-clang-analyzer-\*)
sources=("$@")
if [[ ${1:-} == --all ]]; then
  analyzer=()
  sources=(fsw boards pil_bridge host_sim tests)
elif (($# == 0)); then
  sources=(fsw boards)
fi

# Clang's command lines, and the headers that the build generates.
cmake --preset host-clang --log-level=WARNING >/dev/null
cmake --build --preset host-clang --parallel --target flight_code

root=$(printf '%s' "$PWD" | sed 's/[][\.*^$+?(){}|]/\\&/g')
log=$(mktemp)
trap 'rm -f "$log"' EXIT
status=0
run-clang-tidy -quiet -j "$(nproc)" -p build/host-clang "${analyzer[@]}" \
  "${sources[@]/#/^$root/}" >"$log" 2>&1 || status=$?
# What is left are the findings: a header's once, and neither the commands nor the counts of suppressed warnings.
grep -vE '^(clang-tidy|[0-9]+ warnings? (generated|treated)|Suppressed|Use -header-filter|Enabled checks:|$)' "$log" |
  awk '/(error|warning): / { show = !seen[$0]++ } show' || true
((status == 0)) && echo "clang-tidy: no findings in ${sources[*]}"
exit "$status"
