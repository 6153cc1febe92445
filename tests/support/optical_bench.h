#pragma once
// The optics of the emulated bench without processes and wires: what its display shows is what its camera sees. And its
// calibration as it would be without measurement errors, from the bench's true optics.

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "emulators/optical_stimulator/optical_path.h"
#include "hil_drivers/optical_stimulator/calibration/geometry_fit.h"
#include "hil_drivers/optical_stimulator/imaging/image_exchange.h"
#include "hil_drivers/optical_stimulator/optics/calibration.h"
#include "host_sim/twins/camera/optics.h"

namespace vbar::optical_stimulator {

inline constexpr double kBlackLevel_dn = 64.0;  // of the emulated camera

/// Display and camera of a bench at its best focus.
class PathBench final : public Screen, public FrameCamera {
 public:
  PathBench(const bench::BenchSettings& settings, const twins::camera::CameraSettings& camera,
            const twins::camera::Region& region)
      : path_(settings, camera), places_{settings.lenses.separation_mm, settings.lenses.infinity_mm()} {
    request_.region = region;
    request_.read_out = {camera.exposure_s, 0.0, kBlackLevel_dn};
  }

  void show(const Picture& picture) override {
    counts_ = std::make_shared<const std::vector<std::uint8_t>>(picture.counts);
  }
  CameraFrame take() override {
    CameraFrame frame;
    path_.expose({{counts_, 1.0}}, request_, places_, faults, frames_++, frame.dn);
    return frame;
  }
  void reopen() override {}

  [[nodiscard]] bench::OpticalPath& path() { return path_; }

  bench::ExposureFaults faults;

 private:
  bench::OpticalPath path_;
  bench::RailPlaces places_;
  bench::ExposureRequest request_;
  std::shared_ptr<const std::vector<std::uint8_t>> counts_;
  std::uint64_t frames_ = 0;
};

/// The zeros of the rails are taken as exact. `camera`: of the bench (camera_of); `of_mission`: whose geometry the
/// flight software has.
inline StimulatorCalibration true_calibration(const bench::BenchSettings& settings,
                                              const twins::camera::CameraSettings& camera,
                                              const twins::camera::CameraSettings& of_mission) {
  using fsw::Vector2;
  const int width = settings.display.width, height = settings.display.height;
  const bench::ErrorField field(settings.field, settings.seed, width, height);
  bench::BenchOptics optics(settings.lenses, settings.pose, settings.optics, field, camera, width, height);
  bench::BenchState state;
  state.separation_mm = settings.lenses.separation_mm;
  state.display_mm = settings.lenses.infinity_mm();
  optics.set_state(state);

  StimulatorCalibration calibration;
  Validity& validity = calibration.validity;
  validity.date_utc = "2026-01-01T00:00:00Z";
  validity.emulated = true;
  validity.camera_vendor = settings.identity.vendor;
  validity.camera_model = settings.identity.model;
  validity.rail_lens_mm = settings.lenses.separation_mm - settings.rails.lens_zero_mm;
  validity.rail_display_mm = settings.lenses.infinity_mm() - settings.rails.display_zero_mm;
  validity.display_width_px = width;
  validity.display_height_px = height;
  validity.display_rate_hz = settings.display.refresh_hz;
  validity.region = of_mission.region;
  validity.exposure_s = of_mission.exposure_s;

  const twins::camera::Optics lens(of_mission);
  std::vector<calibrate::Dot> dots;
  constexpr int kAcross = 48, kDown = 30;
  for (int j = 0; j < kDown; ++j)
    for (int i = 0; i < kAcross; ++i) {
      const Vector2 shown(8.0 + (width - 17.0) * i / (kAcross - 1), 8.0 + (height - 17.0) * j / (kDown - 1));
      const bench::SeenPixel seen = optics.seen(shown.x(), shown.y());
      const Vector2 pixel = seen.pixel + seen.coma_px;
      dots.push_back({shown, pixel, lens.direction_of(pixel)});
    }
  DisplayMapParameters start;
  start.width_px = width;
  start.height_px = height;
  start.lens.scale_px = 1e3 * settings.lenses.focal_length_mm() / settings.pose.pitch_um;
  calibration.geometry = calibrate::fit_geometry(dots, start).map;

  const double electrons_per_lux_s =
      bench::photons_per_lux(camera.zero_magnitude_photons) * camera.electrons_per_photon_m2();
  UniformityGrid& grid = calibration.uniformity;
  grid.columns = 33;
  grid.rows = 21;
  grid.step_px = {(width - 1.0) / (grid.columns - 1), (height - 1.0) / (grid.rows - 1)};
  double mean = 0.0;
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const bench::SeenPixel seen = optics.seen(column * grid.step_px.x(), row * grid.step_px.y());
      grid.values.push_back(seen.solid_angle * seen.transmitted);
      mean += grid.values.back() / (grid.columns * grid.rows);
    }
  for (double& value : grid.values) value /= mean;
  grid.first_px = {0.0, 0.0};
  CountsToLight& light = calibration.light;
  light.full_pixel_electrons_per_s.value = electrons_per_lux_s * settings.light.full_luminance * mean;
  light.black_pixel_electrons_per_s.value = light.full_pixel_electrons_per_s.value / settings.light.contrast;
  light.gamma.value = settings.light.gamma;
  light.first_count.value = settings.light.first_count;

  CameraFigures& figures = calibration.camera;
  figures.offset_dn.value = kBlackLevel_dn + settings.camera.offset_dn;
  figures.gain_dn_per_electron.value = camera.detector.gain_dn_per_electron;
  figures.read_noise_electrons.value = camera.detector.read_noise_electrons;
  figures.background_electrons_per_s.value =
      light.black_pixel_electrons_per_s.value + camera.detector.dark_electrons_per_s;
  // Lens and bench together, and a display pixel's own light of sigma 0.5 pixels.
  figures.point_spread_sigma_px.value = std::hypot(settings.optics.point_spread_sigma_px, 0.5);
  figures.bits = camera.detector.bits;
  calibration.centroid_floor_px = 0.05;
  return calibration;
}

}  // namespace vbar::optical_stimulator
