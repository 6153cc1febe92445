#pragma once
// Pictures of exposures: the twin's renderer with the display map in the place of the lens puts the photo-electrons
// that each pixel of the display shall cause in the camera on that pixel. No image is warped or interpolated.

#include <functional>
#include <memory>

#include "hil_drivers/optical_stimulator/counts/picture_maker.h"
#include "hil_drivers/optical_stimulator/scene/calibrated_display.h"
#include "host_sim/twins/camera/scene.h"

namespace vbar::optical_stimulator {

using MakeScene = std::function<std::unique_ptr<twins::camera::SceneRenderer>(
    const twins::camera::CameraSettings& settings, std::shared_ptr<const twins::camera::Projection> projection)>;

class ScenePictures {
 public:
  /// `camera`: as the mission has it. Throws std::runtime_error if the display does not fill its region.
  ScenePictures(const BenchCalibration& calibration, std::shared_ptr<const DisplayMap> map, const DisplayLight& light,
                const twins::camera::CameraSettings& camera, const MakeScene& make_scene);

  /// Draws into the region of the display that the camera's image sees; the rest of the picture stays.
  PictureFigures draw(const twins::camera::Exposure& exposure, Picture& picture);

 private:
  std::unique_ptr<twins::camera::SceneRenderer> scene_;
  PictureMaker maker_;
  twins::camera::PhotonImage wanted_;
};

}  // namespace vbar::optical_stimulator
