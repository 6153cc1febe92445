#!/usr/bin/env bash
# The second compiler, all warnings errors, under its address and undefined-behaviour sanitizers: builds flight code, vbar
# and unit tests, and runs the tests.
#   ci/sanitize.sh                an eighth of the test programs, the next one with each commit; vbar with one of the eighths
#   ci/sanitize.sh all            all of them
#   ci/sanitize.sh MODULE...      those of these modules, for example fsw/gnss host_sim/report
set -euo pipefail
cd "$(dirname "$0")/.."
cmake --preset asan --log-level=WARNING
targets=(flight_code vbar)
table=build/asan/unit_test_modules.txt  # lines "module program"
case ${1:-} in
  "")
    share=$(ci/share.sh)
    mapfile -t programs < <(awk -v share="$share" 'NF && !seen[$2]++ && ++count % 8 == share { print $2 }' "$table")
    ((share == 0)) || targets=(flight_code)
    echo "eighth $share of 0 to 7: ${#programs[@]} test programs"
    ;;
  all) mapfile -t programs < <(awk 'NF && !seen[$2]++ { print $2 }' "$table") ;;
  *) mapfile -t programs < <(awk -v modules="$*" '
      BEGIN { count = split(modules, module, " ") }
      NF { for (i = 1; i <= count; ++i) if ($1 == module[i] || index($1, module[i] "/") == 1) { if (!seen[$2]++) print $2; next } }' "$table") ;;
esac
((${#programs[@]} > 0)) || { echo "ci/sanitize.sh: no unit test in: $*" >&2; exit 2; }
cmake --build --preset asan --target "${targets[@]}" "${programs[@]}"
ctest --preset asan --parallel 2 --tests-regex "^($(IFS='|'; echo "${programs[*]}"))\."
