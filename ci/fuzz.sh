#!/usr/bin/env bash
# ci/fuzz.sh [SECONDS [SEED [TARGET...]]]: runs libFuzzer programs of the sanitizer tree, by default all of them for 20 s each; with
# "share" in place of targets an eighth of them, the next one with each commit.
# One seed (1 by default) begins with the same inputs everywhere; 0 draws another seed each time. Failing inputs
# are kept in build/asan/fuzz_findings/<target>; copy them to tests/fuzz/corpus/<target> with their correction.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-20} seed=${2:-1}
targets=("${@:3}")
every=1 share=0
if [[ ${targets[*]} == share ]]; then
  targets=() every=8 share=$(ci/share.sh)
fi
cmake --preset asan --log-level=WARNING
if ((${#targets[@]} == 0)); then
  mapfile -t targets < <(for file in tests/fuzz/fuzz_*.cpp; do target=${file##*/fuzz_}; echo "${target%.cpp}"; done |
    awk -v every=$every -v share="$share" 'NR % every == share')
fi
cmake --build --preset asan --parallel --target "${targets[@]/#/vbar_fuzz_}"
failed=()
for target in "${targets[@]}"; do
  program=build/asan/tests/fuzz/vbar_fuzz_$target
  found=build/asan/fuzz_findings/$target
  mkdir -p "$found"
  printf '%-18s' "$target"
  if "$program" -max_total_time="$seconds" -seed="$seed" -rss_limit_mb=4096 -timeout=20 -print_final_stats=1 -verbosity=0 \
    -artifact_prefix="$found/" "$found" "tests/fuzz/corpus/$target" >"$found.log" 2>&1; then
    grep -h number_of_executed_units "$found.log" | sed 's/.*: */executed /'
  else
    echo "FAILED, see $found.log"
    failed+=("$target")
  fi
done
((${#failed[@]} == 0)) || { echo "failed: ${failed[*]}" >&2; exit 1; }
