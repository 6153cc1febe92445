#!/usr/bin/env bash
# From a bare Debian 12 to the paper's sample trajectory: installs, builds, flies the complete mission in process and on the
# emulated Zynq, prints the waypoint table, the comparison of the two runs bit for bit, and the path of the report.
set -euo pipefail
cd "$(dirname "$0")/.."
ci/install.sh fly
# Only what is flown here; cmake --build --preset host builds the other programs too.
ci/build.sh host:vbar zynq:vbar_zynq7000
vbar=build/host/vbar
"$vbar" run missions/ideal_navigation.toml --force --out runs/ideal_navigation-sil
"$vbar" run missions/ideal_navigation.toml --set flight_computer.target=zynq_qemu --force --out runs/ideal_navigation-pil
"$vbar" report runs/ideal_navigation-sil runs/ideal_navigation-pil
