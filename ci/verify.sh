#!/usr/bin/env bash
# Everything at full length: all tests, then the whole missions on every flight computer. Writes docs/verification.md.
set -euo pipefail
cd "$(dirname "$0")/.."
ci/test.sh
python3 ci/verify.py
