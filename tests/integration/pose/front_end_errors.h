#pragma once
// How well the pose network's front end does: errors of keypoints and poses against the truth, and against what they
// themselves say they are.

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "fsw/vision/imaging/camera_model.h"
#include "fsw/vision/pose/crop.h"
#include "fsw/vision/pose/keypoint.h"
#include "fsw/vision/pose/keypoint_network.h"
#include "fsw/vision/pose/pnp.h"

namespace vbar::test {

// A crop of which everything is known, and crops in files as training writes them (host_sim/training/shard_file.h).

struct LabelledView {
  fsw::pose::CropSamples samples{};  ///< standardised
  fsw::pose::CropRegion region;
  fsw::imaging::CameraModel camera;
  fsw::pose::TargetPose truth;
  std::array<fsw::Vector2, fsw::pose::kKeypoints> cells;  ///< true places on the map
  std::array<bool, fsw::pose::kKeypoints> counts{};       ///< on the map, or beyond its edge by half a cell at most
};

/// As cut_crop standardises them.
void standardise(fsw::pose::CropSamples& samples);

/// All crops of a shard, standardised. Throws std::runtime_error that names the file if it is not one.
std::vector<LabelledView> read_shard(const std::filesystem::path& file);

/// A keypoint that was taken for usable and is on the map.
struct KeypointError {
  double samples = 0.0;  ///< of the crop, length
  double px = 0.0;
  double normalised = 0.0;  ///< squared, by its covariance: chi-square of 2 degrees
};

/// A crop's pose.
struct PoseError {
  bool is_there = false;
  int usable = 0;
  int inliers = 0;
  double mean_square = 0.0;
  double attitude_sigma_deg = 0.0;  ///< by its covariance, root of the sum of the axes'
  double attitude_deg = 0.0;
  double position_m = 0.0;
  double normalised = 0.0;  ///< squared, by its covariance: chi-square of 6 degrees
};

class FrontEndErrors {
 public:
  /// Throws std::runtime_error if `weights` are none.
  FrontEndErrors(std::span<const std::byte> weights, const fsw::pose::KeypointShape& shape,
                 const fsw::pose::PnpSettings& settings);

  void add(const LabelledView& view);

  [[nodiscard]] const std::vector<KeypointError>& keypoints() const { return keypoints_; }
  [[nodiscard]] const std::vector<PoseError>& poses() const { return poses_; }
  /// Of the keypoints on a map those that were usable; and of those not on it.
  [[nodiscard]] double usable_share() const;
  [[nodiscard]] double false_share() const;

  [[nodiscard]] double median_keypoint_samples() const;
  [[nodiscard]] double accepted_share() const;
  /// Of the accepted.
  [[nodiscard]] double share_beyond(double attitude_deg) const;

  /// For people, several lines.
  [[nodiscard]] std::string report() const;
  /// What stricter acceptance would make of it, a line each.
  [[nodiscard]] std::string acceptance_table() const;

 private:
  void add_keypoint(const fsw::pose::Keypoint& keypoint, const LabelledView& view, std::size_t k);
  void add_pose(const fsw::pose::Keypoints& keypoints, const LabelledView& view);

  std::unique_ptr<fsw::pose::KeypointNetwork> network_;
  fsw::pose::KeypointShape shape_;
  fsw::pose::PnpSettings settings_;
  std::vector<KeypointError> keypoints_;
  std::vector<PoseError> poses_;
  std::size_t on_map_ = 0, beside_map_ = 0, usable_beside_map_ = 0;
};

}  // namespace vbar::test
