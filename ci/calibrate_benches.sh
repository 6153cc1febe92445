#!/usr/bin/env bash
# Calibrates the four emulated benches of each kind whose calibrations missions/verification/*_hil.toml name, over their wires.
#
#     ci/calibrate_benches.sh [optical_stimulator] [tron]      without arguments both; BUILD=build/host
set -euo pipefail
cd "$(dirname "$0")/.."
build=${BUILD:-build/host}
mkdir -p calibrations
# 3: a goal of the residuals was missed, which the row shows.
missed_goal() { "$@" || (($? == 3)); }
if (($# == 0)); then set -- optical_stimulator tron; fi
for bench in "$@"; do
  for seed in 1 2 3 4; do
    case $bench in
      optical_stimulator)
        missed_goal "$build/vbar_os_calibrate" --seed "$seed" --out "calibrations/optical_stimulator_$seed.toml" \
          --bench "vbar_os_bench {data}/benches/optical_stimulator.toml --directory {directory} --seed {seed}" ;;
      tron)
        missed_goal "$build/vbar_tron" calibrate data/benches/tron.toml --seed "$seed" --out "calibrations/tron_$seed" \
          --bench "vbar_tron_bench {data}/benches/tron_emulated.toml --directory {directory} --seed {seed}" ;;
      *)
        echo "$bench: is not a kind of bench; accepted: optical_stimulator, tron" >&2
        exit 2
        ;;
    esac
  done
done
