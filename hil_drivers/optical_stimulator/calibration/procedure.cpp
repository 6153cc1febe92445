#include "hil_drivers/optical_stimulator/calibration/procedure.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "hil_drivers/optical_stimulator/calibration/light_fit.h"

namespace vbar::optical_stimulator::calibrate {

namespace {

/// The display fills the detector, unrotated.
DisplayMapParameters nominal_map(const Bench& bench, const ProcedureSettings& settings) {
  DisplayMapParameters map;
  map.width_px = bench.screen.width();
  map.height_px = bench.screen.height();
  map.lens.centre_px = {0.5 * (map.width_px - 1), 0.5 * (map.height_px - 1)};
  map.lens.scale_px = settings.camera.focal_length_px() * map.width_px / bench.eye.width();
  return map;
}

/// Cameras set exposures in these.
double whole_microseconds(double span_s) {
  return 1e-6 * std::round(1e6 * span_s);
}

double nth_greatest(const std::vector<float>& values, std::size_t n) {
  std::vector<float> greatest(n);
  std::partial_sort_copy(values.begin(), values.end(), greatest.begin(), greatest.end(), std::greater<>());
  return static_cast<double>(greatest.back());
}

}  // namespace

ProcedureSettings quick(ProcedureSettings settings) {
  settings.geometry_grid = {24, 15};
  settings.held_out_grid = {18, 12};
  settings.focus_steps = 7;
  settings.fine_focus_steps = 5;
  settings.grey_levels = 3;
  settings.count_level_step = 2;
  settings.frames = 2;
  return settings;
}

Session::Session(const Bench& bench_in, const ProcedureSettings& settings_in, Progress progress)
    : bench(bench_in),
      settings(settings_in),
      optics_(settings_in.camera),
      map_(nominal_map(bench_in, settings_in)),
      progress_(std::move(progress)) {
  const auto& detector = settings.camera.detector;
  if (bench.eye.width() != detector.width || bench.eye.height() != detector.height)
    throw std::runtime_error("the camera's frames do not have the size of the detector in its file");
}

CameraPicture Session::picture(double exposure_s, int frames) {
  CameraPicture mean{bench.eye.width(), bench.eye.height(), {}};
  for (int frame = 0; frame < frames; ++frame) {
    const std::vector<std::uint16_t> dn = bench.eye.take(exposure_s);
    if (frame == 0) mean.dn.assign(dn.size(), 0.0F);
    for (std::size_t k = 0; k < dn.size(); ++k) mean.dn[k] += static_cast<float>(dn[k]);
  }
  for (float& value : mean.dn) value /= static_cast<float>(frames);
  repair(mean, result.camera.hot_pixels);
  return mean;
}

CameraPicture Session::well_exposed(double& exposure_s, int frames) {
  constexpr std::size_t kHighest = 5;
  constexpr double kLow = 0.3, kHigh = 0.75, kWanted = 0.5;
  exposure_s = whole_microseconds(exposure_s);
  const double black = result.camera.offset_dn.value, span = range_dn() - black;
  for (int attempt = 0; attempt < 12; ++attempt) {
    CameraPicture taken = picture(exposure_s, 1);
    const double share = (nth_greatest(taken.dn, kHighest) - black) / span;
    const bool at_limit = share < kLow ? exposure_s >= settings.exposure_max_s : exposure_s <= settings.exposure_min_s;
    if ((share >= kLow && share <= kHigh) || at_limit) return frames > 1 ? picture(exposure_s, frames) : taken;
    // A saturated picture says only that it is too bright.
    const double factor = share > 0.95 ? 0.15 : kWanted / std::max(share, 0.02);
    exposure_s = whole_microseconds(exposure_s * factor);
    exposure_s = std::clamp(exposure_s, settings.exposure_min_s, settings.exposure_max_s);
  }
  throw std::runtime_error("no exposure suits the dots: their light changes from frame to frame");
}

fsw::Vector2 Session::expected_px(const fsw::Vector2& display_px) const {
  return optics_.project(map_.direction_of(display_px)).value_or(fsw::Vector2(-1e6, -1e6));
}

bool Session::is_on_detector(const fsw::Vector2& camera_px, double margin_px) const {
  return camera_px.x() >= margin_px && camera_px.y() >= margin_px &&
         camera_px.x() <= bench.eye.width() - 1 - margin_px && camera_px.y() <= bench.eye.height() - 1 - margin_px;
}

void Session::set_map(const DisplayMapParameters& parameters) {
  map_ = DisplayMap(parameters);
}

Dot Session::dot_of(const fsw::Vector2& display_px, const fsw::Vector2& camera_px) const {
  return {display_px, camera_px, optics_.direction_of(camera_px)};
}

ProcedureResult calibrate(const Bench& bench, const ProcedureSettings& settings, Session::Progress progress) {
  Session session(bench, settings, std::move(progress));
  Validity& validity = session.result.validity;
  validity.display_width_px = bench.screen.width();
  validity.display_height_px = bench.screen.height();
  validity.region = settings.camera.region;
  validity.exposure_s = settings.camera.exposure_s;
  bench.rails.home();
  bench.rails.move_to(settings.lens_mm, settings.display_mm);
  measure_noise(session);
  find_display(session);
  focus(session);
  find_display(session);  // the scale has changed with the focus
  measure_gain(session);
  measure_light(session);
  measure_geometry(session);
  bench.screen.show(Picture(bench.screen.width(), bench.screen.height()));
  return {session.result, session.residuals};
}

}  // namespace vbar::optical_stimulator::calibrate
