#include "hil_drivers/optical_stimulator/bench/optical_path.h"

#include <cmath>

#include "hil_drivers/optical_stimulator/bench/drift.h"

namespace vbar::optical_stimulator::bench {
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
