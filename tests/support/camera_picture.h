#pragma once
// A camera's image as a picture for people: grey, square root of the light.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <vector>

#include <png.h>

#include "host_sim/twins/camera/photon_image.h"

namespace vbar::test {

/// White at `white_electrons` and above. False if it cannot be written.
inline bool write_picture(const twins::camera::PhotonImage& image, double white_electrons,
                          const std::filesystem::path& file) {
  std::vector<std::uint8_t> grey;
  for (const float light : image.electrons)
    grey.push_back(static_cast<std::uint8_t>(std::min(255.0, 255.0 * std::sqrt(light / white_electrons))));
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.region.width);
  png.height = static_cast<png_uint_32>(image.region.height);
  png.format = PNG_FORMAT_GRAY;
  return png_image_write_to_file(&png, file.c_str(), 0, grey.data(), 0, nullptr) != 0;
}

}  // namespace vbar::test
