#pragma once
// Identity that the emulated camera states.

#include <string>

namespace vbar::gige {

/// Describes the camera; defaults are those of the Optical Stimulator's camera.
struct Description {
  std::string manufacturer = "Point Grey Research";
  std::string model = "Grasshopper3 GS3-PGE-23S6M";
  std::string version = "emulated";
  std::string manufacturer_info =
      "emulated GigE Vision device of vbar";  ///< names the emulation, at most 47 characters
  std::string serial = "00000001";
  int sensor_width = 1920, sensor_height = 1200;
  int converter_bits = 12;  ///< 8 to 16, left-aligned in Mono16
};

}  // namespace vbar::gige
