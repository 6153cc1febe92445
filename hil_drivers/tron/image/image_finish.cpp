#include "hil_drivers/tron/image/image_finish.h"

#include <utility>

#include "hil_drivers/tron/image/binning.h"

namespace vbar::tron {

ImageFinish::ImageFinish(const twins::camera::CameraSettings& camera, const twins::camera::CadModel& model,
                         const std::vector<std::uint16_t>& dark, std::uint64_t key)
    : camera_(camera), lens_(camera), silhouette_(model), expected_(model), dark_(dark_level(binned(dark))), key_(key) {}

std::vector<std::uint16_t> ImageFinish::binned(const std::vector<std::uint16_t>& frame) const {
  return binned_by_two(frame, 2 * camera_.region.width, 2 * camera_.region.height);
}

FinishedImage ImageFinish::finish(const std::vector<std::uint16_t>& frame, std::int64_t image,
                                  const Eigen::Isometry3d& T_C_B, const std::optional<TargetLight>& light) {
  FinishedImage finished{binned(frame), std::nullopt};
  std::vector<std::uint8_t> mask(finished.dn.size(), 0);
  if (light) {
    Outline outline = outline_of(silhouette_, lens_, T_C_B, camera_.region);
    subtract_background(outline, dark_, finished.dn);
    mask = std::move(outline.mask);
    const double predicted = expected_.electrons(T_C_B, *light, camera_);
    // Of fewer electrons the noise of the mask's pixels decides.
    constexpr double kLeast = 1e5;
    if (predicted > kLeast)
      finished.light_level =
          measured_electrons(finished.dn, mask, dark_.offset_dn, camera_.detector.gain_dn_per_electron) / predicted;
  }
  const auto full_scale = static_cast<std::uint16_t>((1U << static_cast<unsigned>(camera_.detector.bits)) - 1U);
  replace_background(mask, dark_, key_, image, full_scale, finished.dn);
  return finished;
}

}  // namespace vbar::tron
