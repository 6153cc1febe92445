#!/usr/bin/env bash
# Installs every Debian 12 package that vbar builds, tests or runs with. Safe to run again.
set -euo pipefail

packages=(
  # build
  build-essential cmake ninja-build ccache git ca-certificates pkg-config
  clang clang-format clang-tidy libclang-rt-14-dev
  # libraries of the host programs
  libeigen3-dev liblcm-dev liblcm-bin libboost-dev libboost-system-dev liberfa-dev libgeographiclib-dev librandom123-dev
  libtomlplusplus-dev libcli11-dev nlohmann-json3-dev libfmt-dev libssl-dev libosmesa6-dev libassimp-dev libpng-dev
  libgtest-dev libgmock-dev libbenchmark-dev
  # flight computers: bare-metal ARM, ARM Linux, their emulators, and the mathematics library of the flight code
  gcc-arm-none-eabi libnewlib-arm-none-eabi libstdc++-arm-none-eabi-newlib newlib-source
  g++-arm-linux-gnueabihf qemu-system-arm qemu-user
  # independent programs the tests compare with
  tshark iproute2 python3 python3-crcmod python3-numpy python3-cvxopt python3-torch rtklib librtklib-dev libopencv-dev
)
# Only where another npm is not already there (a vendor's node conflicts with Debian's).
command -v npm >/dev/null 2>&1 || packages+=(nodejs npm)

sudo=()
if [[ $(id -u) -ne 0 ]]; then sudo=(sudo); fi

missing=()
for p in "${packages[@]}"; do
  dpkg-query -W -f='${db:Status-Status}\n' "$p" 2>/dev/null | grep -qx installed || missing+=("$p")
done
if ((${#missing[@]})); then
  export DEBIAN_FRONTEND=noninteractive
  "${sudo[@]}" apt-get update -q
  "${sudo[@]}" apt-get install -y -q --no-install-recommends "${missing[@]}"
fi
