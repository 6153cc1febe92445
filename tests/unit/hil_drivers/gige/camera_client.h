#pragma once
// Settings of a client for an emulated camera, and an image or an exception.

#include <stdexcept>
#include <utility>

#include "hil_drivers/gige/camera/camera.h"
#include "tests/unit/emulators/gige/running_device.h"

namespace vbar::gige::test {

/// Small images and generous time limits.
inline Camera::Settings settings_for(const RunningDevice& device) {
  Camera::Settings settings;
  settings.address = device.address();
  settings.exposure_s = 0.01;
  settings.region = {64, 32, 200, 100};
  settings.timeout_s = 20.0;
  return settings;
}

inline Frame taken(Camera& camera) {
  auto result = camera.take();
  if (auto* failure = std::get_if<NoFrame>(&result)) throw std::runtime_error(failure->text);
  return std::get<Frame>(std::move(result));
}

inline Image picture_of(const Camera& camera, std::int64_t number, int bits = 12) {
  return numbered_picture({camera.settings().region, 0.0, 0.0, 0.0, number}, bits);
}

/// The message of the CameraError, empty without one.
inline std::string error_of_open(const Camera::Settings& settings) {
  try {
    Camera camera(settings);
    camera.open();
  } catch (const CameraError& error) {
    return error.what();
  }
  return "";
}

}  // namespace vbar::gige::test
