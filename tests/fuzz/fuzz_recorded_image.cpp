// The record of an image of arbitrary bytes, alone and in a log. Promises: pixels of the stated number and bits, or one
// error with a message; memory is bounded by what an image on the link can have.

#include <stdexcept>
#include <utility>

#include "host_sim/twins/camera/logged_image.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace vbar;
using namespace vbar::twins::camera;

void decode(std::span<const std::uint8_t> bytes) {
  const auto header = header_of_recorded_image(bytes);
  try {
    const std::vector<std::uint16_t> dn = pixels_of_recorded_image(bytes);
    VBAR_FUZZ_EXPECT(header.has_value());
    VBAR_FUZZ_EXPECT(dn.size() ==
                     static_cast<std::size_t>(header->region.width) * static_cast<std::size_t>(header->region.height));
    for (const std::uint16_t value : dn) VBAR_FUZZ_EXPECT(value < 1 << header->bits);
  } catch (const std::runtime_error& error) {
    VBAR_FUZZ_EXPECT(error.what()[0] != '\0');
  }
}

void restore(std::span<const std::uint8_t> bytes) {
  twins::ImagesOfLog log;
  log.file = "fuzz.lcmlog";
  log.recordings.push_back({28, {bytes.begin(), bytes.end()}});
  const auto header = header_of_recorded_image(bytes);
  try {
    TileRestorer restorer(std::move(log), {});
    VBAR_FUZZ_EXPECT(header.has_value());
    const twins::ImageKey key = header->key();
    static_cast<void>(restorer.packets_of({key.spacecraft, key.unit, key.image, 0, 1, 0}));
  } catch (const std::runtime_error& error) {
    VBAR_FUZZ_EXPECT(std::string_view(error.what()).starts_with("fuzz.lcmlog: "));
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // An image of tens of megapixels takes a second to decode and shows nothing that a small one does not.
  constexpr int kPixelsMax = 1 << 16;
  const auto header = header_of_recorded_image({data, size});
  if (header && header->region.width * header->region.height > kPixelsMax) return 0;
  decode({data, size});
  restore({data, size});
  return 0;
}
