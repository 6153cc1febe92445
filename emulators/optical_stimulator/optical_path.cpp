#include "emulators/optical_stimulator/optical_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "host_sim/engine/random_stream.h"

namespace vbar::optical_stimulator::bench {

namespace {

/// In a direction, and towards a scale, drawn from the stream.
Displacement drawn(engine::RandomStream stream, double length_um, double scale_ppm) {
  const double direction = stream.uniform(0.0, 2.0 * std::numbers::pi);
  const double sign = stream.uniform() < 0.5 ? -1.0 : 1.0;
  return {{length_um * std::cos(direction), length_um * std::sin(direction)}, sign * scale_ppm};
}

}  // namespace

Displacement drift_at(const DriftSettings& drift, std::uint64_t seed, std::uint64_t frame) {
  const auto step = static_cast<double>(frame / kDriftStep * kDriftStep);
  const double share = std::min(1.0, step / drift.run_frames);
  const Displacement run = drawn({seed, fmt::format("bench/drift/run/{}", drift.day)}, share * drift.run_shift_um,
                                 share * drift.run_scale_ppm);
  if (drift.day == 0) return run;
  const Displacement day =
      drawn({seed, fmt::format("bench/drift/day/{}", drift.day)}, drift.day_shift_um, drift.day_scale_ppm);
  return {{day.um[0] + run.um[0], day.um[1] + run.um[1]}, day.scale_ppm + run.scale_ppm};
}

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

namespace {

LightPathSettings light_settings(const BenchSettings& settings, const twins::camera::CameraSettings& camera) {
  return {settings.display.width, settings.display.height, settings.light, camera, settings.seed};
}

}  // namespace

OpticalPath::OpticalPath(const BenchSettings& settings, const twins::camera::CameraSettings& camera)
    : settings_(settings),
      field_(settings.field, settings.seed, settings.display.width, settings.display.height),
      optics_(settings.lenses, settings.pose, settings.optics, field_, camera, settings.display.width,
              settings.display.height),
      light_(light_settings(settings, camera), optics_),
      camera_(camera, settings.seed, settings.noise) {}

void OpticalPath::bump(double x_um, double y_um) {
  bumped_um_[0] += x_um;
  bumped_um_[1] += y_um;
}

void OpticalPath::set_state(const RailPlaces& rails, std::uint64_t frame) {
  const Displacement drift = drift_at(settings_.drift, settings_.seed, frame);
  BenchState state;
  state.separation_mm = rails.lens_mm;
  state.display_mm = rails.display_mm;
  state.display_moved_um = {bumped_um_[0] + drift.um[0], bumped_um_[1] + drift.um[1]};
  state.scale_ppm = drift.scale_ppm;
  if (state == optics_.state()) return;
  optics_.set_state(state);
  light_.optics_changed();
}

void OpticalPath::expose(const Pictures& pictures, const ExposureRequest& request, const RailPlaces& rails,
                         const ExposureFaults& faults, std::uint64_t frame, std::vector<std::uint16_t>& dn) {
  set_state(rails, frame);
  std::vector<ShownFrame> shown;
  for (const Picture& picture : pictures) shown.push_back({*picture.counts, picture.fraction});
  image_.region = request.region;
  ReadOut read_out = request.read_out;
  read_out.exposure_s *= faults.exposure_factor;
  read_out.gain_db += 20.0 * std::log10(faults.gain_factor);
  read_out.black_level_dn += settings_.camera.offset_dn;
  light_.expose(shown, read_out.exposure_s, faults.brightness_factor, image_);
  camera_.expose(image_, read_out, frame, dn);
}

}  // namespace vbar::optical_stimulator::bench
