#pragma once
// Camera and display of a testbed, as its calibration describes them.

#include "hil_drivers/optical_stimulator/calibration_file/bench_calibration.h"
#include "hil_drivers/optical_stimulator/counts/display_light.h"
#include "hil_drivers/optical_stimulator/strip/frame_strip.h"
#include "host_sim/twins/camera/camera_settings.h"

namespace vbar::optical_stimulator {

/// Returns the camera of the mission with the figures of the calibration: offset, gain, noise, point spread. Its
/// geometry is that of the mission, which the display map was calibrated for.
[[nodiscard]] twins::camera::CameraSettings calibrated_camera(const BenchCalibration& calibration,
                                                              const twins::camera::CameraSettings& of_mission);

/// Returns the light of the display's pixels in one exposure.
[[nodiscard]] DisplayLight display_light(const BenchCalibration& calibration, double exposure_s);

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

}  // namespace vbar::optical_stimulator
