// Image files of a camera, PGM and TIFF, with arbitrary contents. Promise: an image with all of its pixels, or one
// exception that names the file.

#include <string>
#include <string_view>

#include "host_sim/star_images/grey_image.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  try {
    const vbar::star_images::GreyImage image = vbar::star_images::grey_image_of(bytes, "image.tiff");
    VBAR_FUZZ_EXPECT(image.pixels.size() ==
                     static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  } catch (const vbar::star_images::ImageRefused& error) {
    VBAR_FUZZ_EXPECT(std::string_view(error.what()).find("image.tiff") != std::string_view::npos);
  }
  return 0;
}
