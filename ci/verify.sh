#!/usr/bin/env bash
# Complete verification: all tests, fuzzing, new Debian roots, campaigns and resumes at full size, then every row of missions/verification,
# and the pages of what was flown. A budget in minutes as argument cuts the rows; the same command continues them.
set -euo pipefail
cd "$(dirname "$0")/.."
ci/test.sh
ci/fuzz.sh 20
# The second command of the README on a new Debian 12 until its tests start, and the portable bundle in a root with a shell only
# and on Debian 13.
ci/clean_root.sh test || (($? == 77))  # 77: cannot be made here
ci/bundle.sh --check || (($? == 77))
ci/bundle.sh --check13 || (($? == 77))
# All programs by a unity build, as ci/run.sh builds without a compiler cache: it flies the bits of the other.
unity=$(mktemp -d)
cmake --preset host -B build/unity --log-level=WARNING -DVBAR_TESTS=OFF -DVBAR_UNITY=ON
cmake --build build/unity
build/host/vbar run ideal_navigation --out "$unity/run"
build/unity/vbar replay "$unity/run"
rm -r "$unity"
# gnss-sdr behind the ports of a receiver; 120 s of two spacecraft through it and RTKLIB: double differences and the fixed baseline.
gnss_sdr=(python3 tests/peers/gnss_sdr/check_gnss_sdr.py build/host/tests/peers/gnss_sdr/vbar_gnss_sdr_tool)
"${gnss_sdr[@]}" receiver
"${gnss_sdr[@]}" baseline
ci/verify_campaign.py
ci/verify_resume.py build/host/vbar
ci/calibrate_benches.sh
met=0
build/host/vbar verify --to runs/verification ${1:+--budget "$1"} || met=$?
((met <= 1)) || exit "$met"
cp runs/verification/verification.json docs/
build/host/vbar verify --page docs/verification.json
ci/requirements.py
exit "$met"
