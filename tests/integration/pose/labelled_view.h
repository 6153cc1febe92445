#pragma once
// A crop of which everything is known, and crops in files as training writes them (host_sim/training/shard_file.h).

#include <array>
#include <filesystem>
#include <vector>

#include "fsw/imaging/camera_model.h"
#include "fsw/pose/crop.h"
#include "fsw/pose/keypoint.h"
#include "fsw/pose/pnp.h"

namespace vbar::test {

struct LabelledView {
  fsw::pose::CropSamples samples{};  ///< standardised
  fsw::pose::CropRegion region;
  fsw::imaging::CameraModel camera;
  fsw::pose::TargetPose truth;
  std::array<fsw::Vector2, fsw::network::kKeypoints> cells;  ///< true places on the map
  std::array<bool, fsw::network::kKeypoints> counts{};       ///< on the map, or beyond its edge by half a cell at most
};

/// As cut_crop standardises them.
void standardise(fsw::pose::CropSamples& samples);

/// All crops of a shard, standardised. Throws std::runtime_error that names the file if it is not one.
std::vector<LabelledView> read_shard(const std::filesystem::path& file);

}  // namespace vbar::test
