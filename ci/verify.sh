#!/usr/bin/env bash
# Complete verification: all tests, then the complete missions on every flight computer. Writes docs/verification.md.
set -euo pipefail
cd "$(dirname "$0")/.."
ci/test.sh
python3 ci/verify.py
