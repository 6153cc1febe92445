#!/usr/bin/env bash
# Installs missing packages, builds for every target and runs all tests: short arcs in place of long missions. Prints at its end
# the time that each stage took. The complete missions are flown by ci/verify.sh; the first verdict on a change is that of ci/quick.sh.
set -euo pipefail
cd "$(dirname "$0")/.."
started=$SECONDS
stages=() begins=()
stage() {
  stages+=("$1") begins+=("$((SECONDS - started))")
  printf '\n== %s (%d s)\n' "$1" "${begins[-1]}"
}
# Also after a failure: the last stage is then the one that failed.
print_times() {
  local ends=("${begins[@]:1}" "$((SECONDS - started))")
  printf '\n== time of each stage, s\n'
  for i in "${!stages[@]}"; do printf '%6d  %s\n' $((ends[i] - begins[i])) "${stages[i]}"; done
}
trap print_times EXIT

stage "packages"
ci/install.sh test peers
timeout 120 host_sim/view/web/install.sh || echo "npm packages of the page of a run not fetched: its tests will be skipped"
timeout 120 tests/peers/wire_formats/install_npm.sh || echo "npm package cobs not fetched: its test will be skipped"
stage "format"
ci/format.sh
stage "build for this computer"
ci/build.sh host
stage "build for the bare Zynq and for Linux on the Zynq"
ci/build.sh zynq zynq-linux
stage "tests"
ctest --preset host --parallel 2
stage "sample of the verification, with seeds of this commit: no run may be lost or unsafe"
sample=$(mktemp -d)
build/host/vbar verify sample --to "$sample"
rm -r "$sample"
stage "mutants of kernels: the tests of their modules must fail"
ci/mutate.sh
stage "the second compiler, all warnings errors, and an eighth of the unit tests under its sanitizers"
ci/sanitize.sh
stage "fuzzing: an eighth of the decoders and loaders for a few seconds"
ci/fuzz.sh 3 1 share
printf '\n== all passed (%d s)\n' $((SECONDS - started))
