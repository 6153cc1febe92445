#!/usr/bin/env bash
# ci/fuzz.sh [SECONDS]: runs every libFuzzer program of the sanitizer tree, 20 s each by default. Failing inputs
# are kept in build/asan/fuzz_findings/<target>; copy it to tests/fuzz/corpus/<target> with its correction.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-20}
cmake --preset asan --log-level=WARNING
cmake --build --preset asan --parallel --target vbar_fuzz
failed=()
for program in build/asan/tests/fuzz/vbar_fuzz_*; do
  [[ -x $program && ! -d $program ]] || continue
  target=${program##*/vbar_fuzz_}
  found=build/asan/fuzz_findings/$target
  mkdir -p "$found"
  printf '%-12s' "$target"
  if "$program" -max_total_time="$seconds" -rss_limit_mb=4096 -timeout=20 -print_final_stats=1 -verbosity=0 \
    -artifact_prefix="$found/" "$found" "tests/fuzz/corpus/$target" >"$found.log" 2>&1; then
    grep -h number_of_executed_units "$found.log" | sed 's/.*: */executed /'
  else
    echo "FAILED, see $found.log"
    failed+=("$target")
  fi
done
((${#failed[@]} == 0)) || { echo "failed: ${failed[*]}" >&2; exit 1; }
