#!/usr/bin/env bash
# Renders the crops, trains the keypoint network and calibrates it: data/networks/tango_keypoints.{bin,toml}. Some 75
# minutes on two idle cores. An interrupted run continues (folder build/training).
#   ci/train.sh [minutes of training]     default 55
set -euo pipefail
cd "$(dirname "$0")/.."
minutes=${1:-55}

# In addition to the packages of ci/install.sh. Debian's Python, not another python3.
python=/usr/bin/python3
if ! "$python" -c 'import torch, numpy' 2>/dev/null; then
  sudo=()
  if [[ $(id -u) -ne 0 ]]; then sudo=(sudo); fi
  "${sudo[@]}" apt-get update -q
  DEBIAN_FRONTEND=noninteractive "${sudo[@]}" apt-get install -y -q --no-install-recommends python3-torch python3-numpy
fi

work=build/training
crops=$work/crops
mkdir -p "$crops" data/networks
cmake --preset host --log-level=WARNING
cmake --build --preset host --target vbar_training_crops --parallel
render=build/host/vbar_training_crops

# Two processes share the crops for training; crops of other seeds are rendered first and last.
"$render" --kind held_out --seed 3 --count 2000 --shard-size 500 --out "$crops"
"$render" --kind training --seed 1 --count 54000 --part 0 --parts 2 --out "$crops" &
"$render" --kind training --seed 1 --count 54000 --part 1 --parts 2 --out "$crops"
wait $!
"$render" --kind calibration --seed 2 --count 2000 --shard-size 500 --out "$crops"

"$python" host_sim/training/train_keypoints.py --crops "$crops" --out "$work/tango_keypoints.bin" --minutes "$minutes"
"$python" host_sim/training/calibrate.py --crops "$crops" --weights "$work/tango_keypoints.bin" \
  --checkpoint "$work/tango_keypoints.checkpoint" --command "ci/train.sh $minutes" --out data/networks/tango_keypoints.bin
