#pragma once
// Images of a camera as files: portable grey maps (PGM) and TIFF, one grey value a pixel.

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace vbar::star_images {

/// what() is "file: found ..., accepted: ...".
class ImageRefused : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An image in the depth that the flight software processes.
struct GreyImage {
  int width = 0;
  int height = 0;
  int bits = 12;                      ///< 8 or 12 bits a pixel
  std::vector<std::uint16_t> pixels;  ///< rows from the top, pixels from the left
};

/// Reads PGM (binary, up to 16 bits) and TIFF (8 or 16 bits, uncompressed). Values of 16 bits above 4095 in any pixel
/// are divided by 16: cameras of 12 bits write either form. Throws ImageRefused.
[[nodiscard]] GreyImage read_grey_image(const std::filesystem::path& file);

/// The same for the bytes of a file with this name.
[[nodiscard]] GreyImage grey_image_of(const std::string& bytes, const std::string& file);

}  // namespace vbar::star_images
