#!/usr/bin/env bash
# Installs the Debian 12 packages that are missing; may be run repeatedly.
#   ci/install.sh fly      packages to build vbar and fly missions, in process and on the emulated Zynq
#   ci/install.sh images   fly, and Mesa's off-screen OpenGL, which missions with a digital camera load (50 MB)
#   ci/install.sh test     images, and packages for the unit and integration tests, format and lint
#   ci/install.sh view     npm and node, with which host_sim/view/web/install.sh fetches what the page of a run is made of
#   ci/install.sh peers    the independent programs that tests compare with (half a gigabyte); without them their tests are skipped
#   ci/install.sh train    packages to train the keypoint network
# Several groups may be given; the default is fly.
set -euo pipefail

fly=(
  g++ cmake ninja-build python3
  libeigen3-dev liblcm-dev liblcm-bin libboost-dev liberfa-dev libgeographiclib-dev librandom123-dev libtomlplusplus-dev
  libcli11-dev nlohmann-json3-dev libfmt-dev libssl-dev libassimp-dev libpng-dev zlib1g-dev libcharls-dev pps-tools
  libpugixml-dev  # documents of KUKA's controllers
  # The emulated Zynq, whose images link no C++ run-time library (its headers are enough; the library is 313 MB), and the
  # sources of the mathematics library that flight code has on every target.
  gcc-arm-none-eabi libnewlib-arm-none-eabi libstdc++-arm-none-eabi-dev newlib-source qemu-system-arm
)
images=("${fly[@]}" libosmesa6)
test=(
  "${images[@]}"
  libosmesa6-dev  # headers of OpenGL, with which its declarations here are compared
  ccache lld git ca-certificates libgtest-dev libgmock-dev libbenchmark-dev python3 iproute2
  libaravis-dev libusb-1.0-0-dev
  clang clang-format clang-tidy libclang-rt-14-dev
  g++-arm-linux-gnueabihf qemu-user
  # The display of the Optical Stimulator, its server on an emulated bench, and another client of it.
  libsdl2-dev libx11-dev libxrandr-dev xvfb x11-apps
  libceres-dev         # calibration of the Optical Stimulator and of TRON
  libopencv-contrib-dev  # calibration of TRON: its board in images
)
peers=(aravis-tools aravis-tools-cli nftables chrony python3-crcmod python3-numpy python3-cvxopt python3-sgp4 python3-erfa python3-torch rtklib librtklib-dev gnss-sdr
  libopencv-dev liborocos-kdl-dev tshark ffmpeg ola
  doxygen mkdocs   # documentation site (ci/site.py)
  mmdebstrap       # clean roots (ci/package.sh, ci/clean_root.sh, ci/bundle.sh)
  busybox-static   # a root with a shell only (ci/bundle.sh)
  gdb-multiarch    # loads the flight image through a debug server
  xilinx-bootgen   # BOOT.BIN of the flight image
  slurm-wlm munge  # a cluster on loopback, for campaigns
  python3-pandas python3-matplotlib octave)  # the notebooks and readers of run folders
train=("${images[@]}" python3 python3-numpy python3-torch)

# The page of a run is made of npm packages, and the wire formats' peer is one. Only if no other npm is installed: a vendor's node
# conflicts with Debian's.
view=()
command -v npm >/dev/null 2>&1 || { view+=(nodejs npm) && peers+=(nodejs npm); }

packages=()
for group in "${@:-fly}"; do
  case $group in
    fly | images | test | view | peers | train) declare -n list=$group && packages+=("${list[@]}") ;;
    *) echo "ci/install.sh: '$group' is not a group; accepted: fly, images, test, view, peers, train" >&2 && exit 2 ;;
  esac
done

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
