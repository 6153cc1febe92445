#include "fsw/vision/pose/spacecraft_pose_network.h"

#include "fsw/math/math.h"
#include "fsw/vision/pose/heatmap.h"
#include "fsw/vision/pose/rotation.h"

namespace vbar::fsw::pose {
namespace {

/// Limits of the difference between two poses of the same image.
constexpr double kMaxRotation = 30.0 * math::kDegree;
constexpr double kMaxShift = 0.2;  ///< largest shift over the range

bool agree(const TargetPose& a, const TargetPose& b) {
  const double range = math::sqrt(b.position_camera_m.squaredNorm());
  const double shift = math::sqrt((a.position_camera_m - b.position_camera_m).squaredNorm());
  return angle_between(a.R_camera_body, b.R_camera_body) <= kMaxRotation && shift <= kMaxShift * range;
}

bool is_within(const imaging::ImageFrame& frame, const Vector2& pixel) {
  const double x = pixel.x() - frame.origin_x;
  const double y = pixel.y() - frame.origin_y;
  return x >= 0.0 && y >= 0.0 && x <= frame.width - 1.0 && y <= frame.height - 1.0;
}

}  // namespace

void SpacecraftPoseNetwork::configure(const PoseCameraSettings& settings) {
  settings_ = settings;
  sighting_ = {};
  // Without weights process() returns kInvalid.
  if (!network_.is_loaded()) static_cast<void>(network_.load(pose::weights_on_board()));
}

const PoseSighting& SpacecraftPoseNetwork::process(GpsTime time, std::int32_t image_number,
                                                   const imaging::ImageView& image,
                                                   const std::optional<Vector3>& predicted_position_camera_m) {
  sighting_ = {};
  sighting_.time = time;
  sighting_.image = image_number;
  sighting_.status = look(image, predicted_position_camera_m);
  return sighting_;
}

SightingStatus SpacecraftPoseNetwork::look(const imaging::ImageView& image, const std::optional<Vector3>& predicted) {
  const std::size_t pixels = static_cast<std::size_t>(image.frame.width) * static_cast<std::size_t>(image.frame.height);
  if (!network_.is_loaded() || !(image.frame == settings_.frame) || image.pixels.size() != pixels) {
    return SightingStatus::kInvalid;
  }
  const Finding finding = finder_.find(image, {settings_.dark_level_dn, settings_.noise_dn, settings_.saturation_dn});
  if (finding == Finding::kDark) return SightingStatus::kDark;
  if (finding == Finding::kBlinded) return SightingStatus::kBlinded;
  CropRegion region;
  if (predict(predicted, region)) {
    sighting_.region_is_predicted = true;
    return look_at(image, region);
  }
  return finding == Finding::kTarget ? look_twice(image) : SightingStatus::kNoTarget;
}

bool SpacecraftPoseNetwork::predict(const std::optional<Vector3>& predicted, CropRegion& region) const {
  if (!predicted.has_value()) return false;
  const Result<CropRegion> expected = region_of(*predicted, settings_.model, settings_.shape);
  if (!expected.ok() || !is_within(settings_.frame, expected.value().centre_px)) return false;
  region = expected.value();
  return true;
}

SightingStatus SpacecraftPoseNetwork::look_at(const imaging::ImageView& image, const CropRegion& region) {
  sighting_.region = region;
  sighting_.keypoints = {};
  sighting_.pnp.reset();
  if (cut_crop(image, region, settings_.dark_level_dn, crop_) != Status::kOk) return SightingStatus::kNoTarget;
  network_.relocate(pose::weights_on_board());
  if (network_.run(crop_) != Status::kOk) return SightingStatus::kNoKeypoints;
  const auto sigma = static_cast<double>(network_.calibration().target_sigma_cells);
  bool is_any = false;
  for (std::size_t k = 0; k < sighting_.keypoints.size(); ++k) {
    const MapPeak peak = read_map(network_.logits(static_cast<int>(k)), sigma);
    sighting_.keypoints[k] = keypoint_of(peak, network_.calibration(), region);
    is_any = is_any || sighting_.keypoints[k].is_usable;
  }
  if (!is_any) return SightingStatus::kNoKeypoints;
  const Result<PnpSolution> solution = solve_pnp(sighting_.keypoints, settings_.shape, settings_.model, settings_.pnp,
                                                 static_cast<std::uint32_t>(sighting_.image));
  if (!solution.ok()) return SightingStatus::kKeypointsOnly;
  sighting_.pnp = solution.value();
  return SightingStatus::kPose;
}

SightingStatus SpacecraftPoseNetwork::look_twice(const imaging::ImageView& image) {
  const SightingStatus first = look_at(image, finder_.region());
  if (first != SightingStatus::kPose && first != SightingStatus::kKeypointsOnly) return first;
  const std::optional<PnpSolution> before = sighting_.pnp;
  const SightingStatus second = look_at(image, second_region());
  if (second == SightingStatus::kPose && before.has_value() && !agree(before->pose, sighting_.pnp->pose)) {
    sighting_.pnp.reset();
    return SightingStatus::kKeypointsOnly;
  }
  return second;
}

/// Around the pose of the first round, or else around its keypoints.
CropRegion SpacecraftPoseNetwork::second_region() const {
  if (sighting_.pnp.has_value()) {
    const Result<CropRegion> region =
        region_of(sighting_.pnp->pose.position_camera_m, settings_.model, settings_.shape);
    if (region.ok()) return region.value();
  }
  constexpr double kMargin = 1.4;  // mean margin of the training crops beside the keypoints
  constexpr double kMinShare = 0.7;
  Vector2 minimum = Vector2::Constant(1e9);
  Vector2 maximum = Vector2::Constant(-1e9);
  for (const Keypoint& keypoint : sighting_.keypoints) {
    if (!keypoint.is_usable) continue;
    minimum = minimum.cwiseMin(keypoint.pixel);
    maximum = maximum.cwiseMax(keypoint.pixel);
  }
  CropRegion region = sighting_.region;
  region.centre_px = 0.5 * (minimum + maximum);
  const double side = kMargin * (maximum - minimum).maxCoeff();
  region.side_px = side > kMinShare * region.side_px ? side : kMinShare * region.side_px;
  return region;
}

}  // namespace vbar::fsw::pose
