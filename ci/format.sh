#!/usr/bin/env bash
# clang-format over every C and C++ file of the tree.
#   ci/format.sh         reports files that are not in the format of the tree, and fails if there are any
#   ci/format.sh --fix   formats them
set -euo pipefail
cd "$(dirname "$0")/.."
mode=(--dry-run -Werror)
[[ ${1:-} == --fix ]] && mode=(-i)
git ls-files -z '*.h' '*.c' '*.cpp' | xargs -0 -r -P "$(nproc)" -n 32 clang-format "${mode[@]}"
