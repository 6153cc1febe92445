#!/usr/bin/env bash
# Renders the crops of a target, trains a keypoint network on them and calibrates it: data/networks/TARGET_keypoints.{bin,toml}. Some 75
# minutes on two idle cores with the defaults. An interrupted run continues (folder build/training/TARGET).
#   ci/train.sh TARGET [MINUTES [CROPS]]     of training, 55; to train on, 54000
# TARGET is a file of data/bodies with a CAD model and eleven keypoints; vbar_target_keypoints chooses and draws them (docs/own_target.md).
set -euo pipefail
cd "$(dirname "$0")/.."
target=${1:?usage: ci/train.sh TARGET [MINUTES [CROPS]]}
minutes=${2:-55}
count=${3:-54000}
[[ -f data/bodies/$target.toml ]] || { echo "ci/train.sh: no file data/bodies/$target.toml" >&2; exit 2; }

# In addition to the packages of ci/install.sh. Debian's Python, not another python3.
python=/usr/bin/python3
if ! "$python" -c 'import torch, numpy' 2>/dev/null; then
  sudo=()
  if [[ $(id -u) -ne 0 ]]; then sudo=(sudo); fi
  "${sudo[@]}" apt-get update -q
  DEBIAN_FRONTEND=noninteractive "${sudo[@]}" apt-get install -y -q --no-install-recommends python3-torch python3-numpy
fi

work=build/training/$target
crops=$work/crops
mkdir -p "$crops" data/networks
cmake --preset host --log-level=WARNING
cmake --build --preset host --target vbar_training_crops --parallel
render=(build/host/vbar_training_crops --target "$target" --out "$crops")

# Two processes share the crops for training; crops of other seeds are rendered first and last.
"${render[@]}" --kind held_out --seed 3 --count 2000 --shard-size 500
"${render[@]}" --kind training --seed 1 --count "$count" --part 0 --parts 2 &
"${render[@]}" --kind training --seed 1 --count "$count" --part 1 --parts 2
wait $!
"${render[@]}" --kind calibration --seed 2 --count 2000 --shard-size 500

# Tensors of a step are taken from memory that the process keeps. Returned to the kernel after every step, their pages cost two thirds of the
# time: 109 images a second in place of 330 on two cores.
export OMP_WAIT_POLICY=PASSIVE
export GLIBC_TUNABLES=glibc.malloc.mmap_threshold=2000000000:glibc.malloc.trim_threshold=4000000000:glibc.malloc.top_pad=200000000
"$python" host_sim/training/train_keypoints.py --crops "$crops" --out "$work/keypoints.bin" --minutes "$minutes"
"$python" host_sim/training/calibrate.py --crops "$crops" --body "data/bodies/$target.toml" --weights "$work/keypoints.bin" \
  --checkpoint "$work/keypoints.checkpoint" --command "ci/train.sh $target $minutes $count" --out "data/networks/${target}_keypoints.bin"
ci/data_checksums.sh
