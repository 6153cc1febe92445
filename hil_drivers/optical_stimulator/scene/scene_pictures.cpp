#include "hil_drivers/optical_stimulator/scene/scene_pictures.h"

#include <utility>

namespace vbar::optical_stimulator {
namespace {

/// Light beside the image that the camera's point spread brings into it. Less than the black rows below the frame
/// strip.
constexpr int kMargin_px = 8;

}  // namespace

ScenePictures::ScenePictures(const BenchCalibration& calibration, std::shared_ptr<const DisplayMap> map,
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
