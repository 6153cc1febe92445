#pragma once
// Input of the keypoint network: a square of the image around the target, resampled to a fixed size and brightness.

#include <array>
#include <cstddef>
#include <span>

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/vision/imaging/camera_model.h"
#include "fsw/vision/imaging/image.h"
#include "fsw/vision/pose/keypoint.h"

namespace vbar::fsw::pose {

inline constexpr int kCropSide = 128;  ///< samples
inline constexpr std::size_t kCropSamples = static_cast<std::size_t>(kCropSide) * kCropSide;

/// A square on the detector; an integer is the centre of a pixel.
struct CropRegion {
  Vector2 centre_px = Vector2::Zero();
  double side_px = 0.0;

  /// Returns the position on the detector of a point of the crop, in samples of `samples` a side (128 of the crop
  /// itself, 32 of a heatmap); an integer is the centre of a sample.
  [[nodiscard]] Vector2 pixel_of(const Vector2& place, int samples) const {
    return centre_px + side_px * ((place.array() + 0.5) / samples - 0.5).matrix();
  }
  /// Returns the point of the crop at a position on the detector.
  [[nodiscard]] Vector2 place_of(const Vector2& pixel, int samples) const {
    return ((pixel - centre_px).array() / side_px + 0.5).matrix() * samples - Vector2::Constant(0.5);
  }
};

/// Samples of a crop: rows from the top, samples from the left.
using CropSamples = std::array<float, kCropSamples>;

/// Crops `region` of the image. A sample is the root of the mean of the pixels it covers, weighted by the covered area,
/// above `dark_level_dn`; the root makes photon noise uniform, and shadows count beside glints. Pixels that the image
/// does not contain (outside it, missing tiles) have no light.
///
/// With `standardise` the samples are scaled to mean 0 and standard deviation 1 over the crop; in a crop that is almost
/// uniform (below half a root of a DN) noise is not amplified. kOutOfRange unless the region is 16 to 4096 px a side,
/// with its centre at most as far from the image's.
Status cut_crop(const imaging::ImageView& image, const CropRegion& region, double dark_level_dn, CropSamples& out,
                bool standardise = true);

// The square of the detector to crop.

/// Side of a crop in apparent radii of the target: the mean of the training data.
inline constexpr double kCropRadii = 2.3;

/// Returns the radius of the sphere about the origin that holds all keypoints, m.
[[nodiscard]] double radius_of(const KeypointShape& shape);

/// Returns the crop for a target at a pose: the square around all its keypoints, for any attitude. kOutOfRange if
/// behind.
Result<CropRegion> region_of(const Vector3& position_camera_m, const imaging::CameraModel& model,
                             const KeypointShape& shape);

}  // namespace vbar::fsw::pose
