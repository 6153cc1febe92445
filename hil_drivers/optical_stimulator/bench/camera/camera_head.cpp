#include "hil_drivers/optical_stimulator/bench/camera/camera_head.h"

#include <algorithm>
#include <cmath>

namespace vbar::optical_stimulator::bench {

using twins::camera::CameraSettings;
using twins::camera::Detector;
using twins::camera::PhotonImage;
using twins::camera::Region;

namespace {

constexpr const char* kName = "bench/camera";
/// A detector's fixed pattern costs as much as a few exposures; a calibration changes between few settings.
constexpr std::size_t kMaxDetectors = 6;

bool are_equal(const CameraSettings& a, const CameraSettings& b) {
  return a.region == b.region && a.exposure_s == b.exposure_s &&
         a.detector.gain_dn_per_electron == b.detector.gain_dn_per_electron &&
         a.detector.offset_dn == b.detector.offset_dn;
}

}  // namespace

CameraHead::CameraHead(const CameraSettings& camera, std::uint64_t seed, bool has_noise)
    : camera_(camera),
      seed_(seed),
      has_noise_(has_noise),
      hot_pixels_(twins::camera::draw_hot_pixels(camera.detector, {0, 0, camera.detector.width, camera.detector.height},
                                                 seed, kName)) {}

CameraSettings CameraHead::settings_for(const Region& region, const ReadOut& read_out) const {
  CameraSettings settings = camera_;
  settings.region = region;
  settings.exposure_s = read_out.exposure_s;
  settings.detector.gain_dn_per_electron *= std::pow(10.0, read_out.gain_db / 20.0);
  settings.detector.offset_dn = read_out.black_level_dn;
  return settings;
}

Detector& CameraHead::detector_for(const CameraSettings& settings) {
  const auto found =
      std::ranges::find_if(detectors_, [&](const Configured& c) { return are_equal(c.settings, settings); });
  if (found != detectors_.end()) {
    detectors_.splice(detectors_.begin(), detectors_, found);
  } else {
    detectors_.push_front({settings, Detector(settings, seed_, kName, hot_pixels_)});
    if (detectors_.size() > kMaxDetectors) detectors_.pop_back();
  }
  return detectors_.front().detector;
}

void CameraHead::expose(const PhotonImage& image, const ReadOut& read_out, std::uint64_t number,
                        std::vector<std::uint16_t>& dn) {
  const CameraSettings settings = settings_for(image.region, read_out);
  if (has_noise_) return detector_for(settings).expose(image, static_cast<std::int64_t>(number), dn);
  const auto& detector = settings.detector;
  const double most = (1 << detector.bits) - 1;
  dn.resize(image.electrons.size());
  for (std::size_t k = 0; k < dn.size(); ++k) {
    const double electrons = std::min(static_cast<double>(image.electrons[k]), detector.full_well_electrons);
    const double level = detector.offset_dn + detector.gain_dn_per_electron * electrons;
    dn[k] = static_cast<std::uint16_t>(std::lround(std::clamp(level, 0.0, most)));
  }
}

}  // namespace vbar::optical_stimulator::bench
