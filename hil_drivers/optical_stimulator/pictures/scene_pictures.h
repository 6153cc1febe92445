#pragma once
// Pictures of exposures: the twin's renderer with the display map in the place of the lens puts the photo-electrons
// that each pixel of the display shall cause in the camera on that pixel. No image is warped or interpolated.

#include <functional>
#include <memory>

#include "hil_drivers/optical_stimulator/optics/calibration.h"
#include "hil_drivers/optical_stimulator/pictures/display_light.h"
#include "hil_drivers/optical_stimulator/pictures/frame_strip.h"
#include "hil_drivers/optical_stimulator/pictures/picture_maker.h"
#include "host_sim/twins/camera/camera_settings.h"
#include "host_sim/twins/camera/scene.h"

namespace vbar::optical_stimulator {

// Camera and display of a testbed, as its calibration describes them.

/// Returns the camera of the mission with the figures of the calibration: offset, gain, noise, point spread. Its
/// geometry is that of the mission, which the display map was calibrated for.
[[nodiscard]] twins::camera::CameraSettings calibrated_camera(const StimulatorCalibration& calibration,
                                                              const twins::camera::CameraSettings& of_mission);

/// Returns the light of the display's pixels in one exposure.
[[nodiscard]] DisplayLight display_light(const StimulatorCalibration& calibration, double exposure_s);

/// Returns the camera's own model: where a display pixel is seen on the detector.
[[nodiscard]] CameraPixelOf camera_pixels(std::shared_ptr<const twins::camera::Projection> map,
                                          const twins::camera::CameraSettings& camera);

/// Returns the pixels of the display that illuminate the region of the camera, grown by `margin_px` on each side.
/// Throws std::runtime_error if the display does not fill the region.
[[nodiscard]] twins::camera::Region display_region(const twins::camera::Region& camera_region,
                                                   const twins::camera::CameraSettings& camera,
                                                   const twins::camera::Projection& map, int display_width,
                                                   int display_height, int margin_px);

/// Returns a "camera" whose pixels are the display's, for the renderer: no vignetting, no halo, a point spread of half
/// a pixel.
[[nodiscard]] twins::camera::CameraSettings display_camera(const twins::camera::CameraSettings& camera,
                                                           const twins::camera::Projection& map,
                                                           const twins::camera::Region& region, int display_width,
                                                           int display_height);

using MakeScene = std::function<std::unique_ptr<twins::camera::SceneRenderer>(
    const twins::camera::CameraSettings& settings, std::shared_ptr<const twins::camera::Projection> projection)>;

class ScenePictures {
 public:
  /// `camera`: as the mission has it. Throws std::runtime_error if the display does not fill its region.
  ScenePictures(const StimulatorCalibration& calibration, std::shared_ptr<const DisplayMap> map,
                const DisplayLight& light, const twins::camera::CameraSettings& camera, const MakeScene& make_scene);

  /// Draws into the region of the display that the camera's image sees; the rest of the picture stays.
  PictureFigures draw(const twins::camera::Exposure& exposure, Picture& picture);

 private:
  std::unique_ptr<twins::camera::SceneRenderer> scene_;
  PictureMaker maker_;
  twins::camera::PhotonImage wanted_;
};

}  // namespace vbar::optical_stimulator
