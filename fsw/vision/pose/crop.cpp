#include "fsw/vision/pose/crop.h"

#include "fsw/math/math.h"

namespace vbar::fsw::pose {

double radius_of(const KeypointShape& shape) {
  double radius = 0.0;
  for (const Vector3& point : shape) {
    const double length = math::sqrt(point.squaredNorm());
    if (length > radius) radius = length;
  }
  return radius;
}

Result<CropRegion> region_of(const Vector3& position_camera_m, const imaging::CameraModel& model,
                             const KeypointShape& shape) {
  const Result<Vector2> centre = imaging::pixel_of(model, position_camera_m);
  if (!centre.ok()) return Status::kOutOfRange;
  const double focal_length_px = 0.5 * (model.focal_length_px.x() + model.focal_length_px.y());
  const double range = math::sqrt(position_camera_m.squaredNorm());
  CropRegion region;
  region.centre_px = centre.value();
  region.side_px = kCropRadii * radius_of(shape) * focal_length_px / range;
  if (!math::is_finite(region.side_px)) return Status::kOutOfRange;
  return region;
}

namespace {

constexpr double kMinSide = 16.0;
constexpr double kMinDeviation = 0.5;  // root of DN

double larger(double a, double b) {
  return a > b ? a : b;
}

double smaller(double a, double b) {
  return a < b ? a : b;
}

/// The pixels of one axis that a sample covers: first and last, whole and cut to the image, and its edges.
struct Cover {
  double begin = 0.0;
  double end = 0.0;
  int first = 0;
  int last = -1;

  /// Part of pixel p that is covered, 0 to 1.
  [[nodiscard]] double share(int p) const { return smaller(p + 1.0, end) - larger(p, begin); }
};

/// Pixel p of the image covers p to p + 1 here.
Cover cover_of(double edge, double step, int sample, int pixels) {
  Cover cover;
  cover.begin = larger(0.0, edge + step * sample);
  cover.end = smaller(pixels, edge + step * (sample + 1));
  if (!(cover.begin < cover.end)) return cover;
  cover.first = static_cast<int>(cover.begin);
  cover.last = static_cast<int>(cover.end);
  if (cover.last >= pixels || cover.share(cover.last) <= 0.0) --cover.last;
  return cover;
}

/// Sum over a row's covered pixels of the values above the dark level.
double row_sum(const std::uint16_t* row, const Cover& across, double dark_level_dn) {
  double sum = 0.0;
  for (int x = across.first; x <= across.last; ++x) {
    if (row[x] == imaging::kMissingPixel) continue;
    sum += across.share(x) * larger(0.0, row[x] - dark_level_dn);
  }
  return sum;
}

void standardise_samples(CropSamples& samples) {
  double sum = 0.0;
  double squares = 0.0;
  for (const float sample : samples) {
    const double value = static_cast<double>(sample);
    sum += value;
    squares += value * value;
  }
  const double mean = sum / kCropSamples;
  const double variance = larger(0.0, squares / kCropSamples - mean * mean);
  const double by = 1.0 / larger(kMinDeviation, math::sqrt(variance));
  for (float& sample : samples) sample = static_cast<float>((static_cast<double>(sample) - mean) * by);
}

}  // namespace

Status cut_crop(const imaging::ImageView& image, const CropRegion& region, double dark_level_dn, CropSamples& out,
                bool standardise) {
  const imaging::ImageFrame& frame = image.frame;
  const Vector2 middle(frame.origin_x + 0.5 * (frame.width - 1), frame.origin_y + 0.5 * (frame.height - 1));
  const double off = (region.centre_px - middle).norm();
  // The comparison also rejects a NaN.
  if (!(region.side_px >= kMinSide && region.side_px <= imaging::kMaxSide && off <= imaging::kMaxSide)) {
    return Status::kOutOfRange;
  }
  const double step = region.side_px / kCropSide;
  const double left = region.centre_px.x() + 0.5 - frame.origin_x - 0.5 * region.side_px;
  const double top = region.centre_px.y() + 0.5 - frame.origin_y - 0.5 * region.side_px;
  for (int j = 0; j < kCropSide; ++j) {
    const Cover down = cover_of(top, step, j, frame.height);
    for (int i = 0; i < kCropSide; ++i) {
      const Cover across = cover_of(left, step, i, frame.width);
      double sum = 0.0;
      for (int y = down.first; y <= down.last; ++y) {
        const std::uint16_t* row = image.pixels.data() + static_cast<std::ptrdiff_t>(y) * frame.width;
        sum += down.share(y) * row_sum(row, across, dark_level_dn);
      }
      const auto place = static_cast<std::size_t>(j * kCropSide + i);
      out[place] = static_cast<float>(math::sqrt(sum / (step * step)));
    }
  }
  if (standardise) standardise_samples(out);
  return Status::kOk;
}

}  // namespace vbar::fsw::pose
