#!/usr/bin/env bash
# Builds the tests, runs those that compare with independent references, writes docs/accuracy.md.
#   ci/accuracy.sh           accuracy alone
#   ci/accuracy.sh --cost    and computing cost, by the benchmark program
set -euo pipefail
cd "$(dirname "$0")/.."
cmake --preset host --log-level=WARNING
cmake --build --preset host --parallel
if [[ ${1:-} == --cost ]]; then
  mkdir -p runs
  build/host/vbar_bench --benchmark_filter='^(truth|gravity|nrlmsise00|drag|sun_moon|third_body|solid_tides|relativity|earth_rotation|day_in_sunlight|attitude)/' \
    --benchmark_out_format=json --benchmark_out=runs/bench.json >/dev/null
  python3 ci/accuracy.py --bench runs/bench.json
else
  python3 ci/accuracy.py
fi
