#!/usr/bin/env bash
# The first verdict, in a minute on a warm compiler cache: the format of the changed files, and the unit tests of the
# modules that they belong to.
#   ci/quick.sh               modules with changes since origin/main (or the last commit), committed or not
#   ci/quick.sh MODULE...     these modules, for example fsw/gnss host_sim/report
set -euo pipefail
cd "$(dirname "$0")/.."
started=$SECONDS

base=$(git merge-base HEAD origin/main 2>/dev/null || git rev-parse HEAD)
mapfile -t changed < <({ git diff --name-only --diff-filter=d "$base"; git ls-files --others --exclude-standard; } | sort -u)
mapfile -t sources < <(printf '%s\n' "${changed[@]}" | grep -E '\.(h|c|cpp)$' || true)
((${#sources[@]} == 0)) || clang-format --dry-run -Werror "${sources[@]}"
echo "format: ${#sources[@]} changed files"

cmake --preset host --log-level=WARNING >/dev/null
# Lines "module program", longest module first, so that a nested module is found before the one around it.
table=build/host/unit_test_modules.txt
modules=("$@")
if ((${#modules[@]} == 0)); then
  mapfile -t modules < <(
    for file in "${changed[@]}"; do
      file=${file#tests/unit/}
      awk -v file="$file" '$1 != "" && index(file, $1 "/") == 1 && length($1) > length(best) { best = $1 } END { if (best) print best }' "$table"
    done | sort -u)
fi
if ((${#modules[@]} == 0)); then
  echo "no module with unit tests has changed since ${base:0:12} ($((SECONDS - started)) s)"
  exit 0
fi

programs=()
labels=()
for module in "${modules[@]}"; do
  mapfile -t found < <(awk -v module="$module" '$1 == module || index($1, module "/") == 1 { print $2 }' "$table")
  if ((${#found[@]} == 0)); then
    echo "ci/quick.sh: '$module' has no unit tests; modules: $(awk 'NF { print $1 }' "$table" | sort | paste -sd' ')" >&2
    exit 2
  fi
  programs+=("${found[@]}")
  labels+=("$module")
done
echo "modules: ${modules[*]}"
cmake --build --preset host --target "${programs[@]}"
pattern=$(printf '^%s(/|$)|' "${labels[@]}")
ctest --preset host --parallel "$(nproc)" --label-regex "${pattern%|}" --progress --output-on-failure
echo "quick verdict after $((SECONDS - started)) s"
