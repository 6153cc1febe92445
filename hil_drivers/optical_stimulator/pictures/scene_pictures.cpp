#include "hil_drivers/optical_stimulator/pictures/scene_pictures.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "host_sim/twins/camera/optics.h"

namespace vbar::optical_stimulator {

namespace {

using fsw::Vector2;
using twins::camera::CameraSettings;
using twins::camera::Region;

/// Width of a point on the display, px. A smaller one is not shown better, as half of its light then is in one pixel.
constexpr double kDisplaySpread_px = 0.5;

}  // namespace

CameraSettings calibrated_camera(const StimulatorCalibration& calibration, const CameraSettings& of_mission) {
  CameraSettings camera = of_mission;
  const CameraFigures& figures = calibration.camera;
  camera.optics.point_spread_sigma_px = figures.point_spread_sigma_px.value;
  camera.detector.bits = figures.bits;
  camera.detector.offset_dn = figures.offset_dn.value;
  camera.detector.gain_dn_per_electron = figures.gain_dn_per_electron.value;
  camera.detector.read_noise_electrons = figures.read_noise_electrons.value;
  // The black level of the display is in every image, as dark current is.
  camera.detector.dark_electrons_per_s = figures.background_electrons_per_s.value;
  return camera;
}

DisplayLight display_light(const StimulatorCalibration& calibration, double exposure_s) {
  const int width = calibration.validity.display_width_px, height = calibration.validity.display_height_px;
  std::vector<float> full;
  full.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      full.push_back(static_cast<float>(exposure_s * calibration.full_pixel_electrons_per_s(Vector2(x, y))));
  const CountsToLight& light = calibration.light;
  return {{light.gamma.value, light.first_count.value, light.contrast()}, width, height, std::move(full)};
}

CameraPixelOf camera_pixels(std::shared_ptr<const twins::camera::Projection> map, const CameraSettings& camera) {
  return [map = std::move(map), optics = twins::camera::Optics(camera)](const Vector2& display_pixel) {
    const auto pixel = optics.project(map->direction_of(display_pixel));
    constexpr double kNowhere = -1e6;
    return pixel.value_or(Vector2(kNowhere, kNowhere));
  };
}

Region display_region(const Region& camera_region, const CameraSettings& camera, const twins::camera::Projection& map,
                      int display_width, int display_height, int margin_px) {
  const twins::camera::Optics optics(camera);
  Vector2 low(1e9, 1e9), high(-1e9, -1e9);
  const auto include = [&](double x, double y) {
    const auto pixel = map.project(optics.direction_of(Vector2(x, y)));
    if (!pixel) throw std::runtime_error("the display map does not reach the region of the camera");
    low = low.cwiseMin(*pixel);
    high = high.cwiseMax(*pixel);
  };
  constexpr int kSteps = 32;  // points of each edge
  for (int k = 0; k <= kSteps; ++k) {
    const double x = camera_region.x + k * (camera_region.width - 1.0) / kSteps;
    const double y = camera_region.y + k * (camera_region.height - 1.0) / kSteps;
    include(x, camera_region.y);
    include(x, camera_region.y + camera_region.height - 1.0);
    include(camera_region.x, y);
    include(camera_region.x + camera_region.width - 1.0, y);
  }
  if (!(low.minCoeff() >= 0.0 && high.x() <= display_width - 1.0 && high.y() <= display_height - 1.0))
    throw std::runtime_error(fmt::format(
        "the display does not fill the region of the camera: it would need its pixels ({:.0f}, {:.0f}) to ({:.0f}, "
        "{:.0f}) of {} x {}",
        low.x(), low.y(), high.x(), high.y(), display_width, display_height));
  const int left = std::max(0, static_cast<int>(std::floor(low.x())) - margin_px);
  const int top = std::max(0, static_cast<int>(std::floor(low.y())) - margin_px);
  const int right = std::min(display_width - 1, static_cast<int>(std::ceil(high.x())) + margin_px);
  const int bottom = std::min(display_height - 1, static_cast<int>(std::ceil(high.y())) + margin_px);
  return {left, top, right - left + 1, bottom - top + 1};
}

CameraSettings display_camera(const CameraSettings& camera, const twins::camera::Projection& map, const Region& region,
                              int display_width, int display_height) {
  CameraSettings display = camera;
  display.optics.point_spread_sigma_px = kDisplaySpread_px;
  display.optics.halo_fraction = 0.0;
  display.optics.vignetting = 0.0;
  // Per pixel of the display, which subtends another solid angle.
  const double pixels = camera.focal_length_px() / map.focal_length_px();
  display.optics.stray_light_electrons *= pixels * pixels;
  display.detector.width = display_width;
  display.detector.height = display_height;
  display.region = region;
  return display;
}

namespace {

/// Light beside the image that the camera's point spread brings into it. Less than the black rows below the frame
/// strip.
constexpr int kMargin_px = 8;

}  // namespace

ScenePictures::ScenePictures(const StimulatorCalibration& calibration, std::shared_ptr<const DisplayMap> map,
                             const DisplayLight& light, const twins::camera::CameraSettings& camera,
                             const MakeScene& make_scene)
    : maker_(light) {
  const int width = calibration.validity.display_width_px, height = calibration.validity.display_height_px;
  const auto region = display_region(camera.region, camera, *map, width, height, kMargin_px);
  const auto settings = display_camera(camera, *map, region, width, height);
  scene_ = make_scene(settings, std::move(map));
}

PictureFigures ScenePictures::draw(const twins::camera::Exposure& exposure, Picture& picture) {
  scene_->render(exposure, wanted_);
  return maker_.draw(wanted_, picture);
}

}  // namespace vbar::optical_stimulator
