#!/usr/bin/env bash
# clang-format over every C and C++ file of the tree.
#   ci/format.sh         says what is not in the tree's format, and fails if anything is not
#   ci/format.sh --fix   puts it in format
set -euo pipefail
cd "$(dirname "$0")/.."
mode=(--dry-run -Werror)
[[ ${1:-} == --fix ]] && mode=(-i)
git ls-files -z '*.h' '*.c' '*.cpp' | xargs -0 -r -P "$(nproc)" -n 32 clang-format "${mode[@]}"
