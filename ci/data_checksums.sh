#!/usr/bin/env bash
# Lists the data files with their SHA-256 in data/SHA256SUMS, after a change that is intended. The program rejects a data file
# that differs from the list.
set -euo pipefail
cd "$(dirname "$0")/../data"
export LC_ALL=C
find . -type f -not -name SHA256SUMS -not -name README.md -not -name '*.py' | sort | sed 's|^\./||' | xargs sha256sum >SHA256SUMS
