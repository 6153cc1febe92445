// Images of a camera with arbitrary contents: frame strip and centroids. Promises: a strip that is read is the one that
// would have been drawn, and a centroid lies on the image.

#include <algorithm>
#include <cmath>
#include <vector>

#include "hil_drivers/optical_stimulator/imaging/self_check.h"
#include "hil_drivers/optical_stimulator/pictures/frame_strip.h"
#include "tests/fuzz/fuzz_target.h"

using namespace vbar::optical_stimulator;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr int kWidth = 500;
  if (size < 3) return 0;
  // The first byte chooses between cells of the bytes and pixels of the bytes.
  std::vector<std::uint16_t> dn(static_cast<std::size_t>(kWidth) * kStripRows, 64);
  for (int y = 0; y < kStripRows; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const int cell = std::clamp((x - cells_left(kWidth)) / kCellSide, 0, kCells - 1);
      const std::size_t place =
          data[0] % 2 == 0 ? static_cast<std::size_t>(cell) : static_cast<std::size_t>(y * kWidth + x);
      dn[static_cast<std::size_t>(y * kWidth + x)] = static_cast<std::uint16_t>(16 * data[1 + place % (size - 1)]);
    }
  const StripReading reading = read_strip(dn, kWidth, 300.0);
  if (reading.status == StripStatus::kRead) {
    VBAR_FUZZ_EXPECT(reading.white_dn > reading.black_dn);
    VBAR_FUZZ_EXPECT(cells_of(reading.frame)[1] && !cells_of(reading.frame)[0]);
  }
  const vbar::fsw::Vector2 near(2.0 * data[1], 0.2 * data[2]);
  if (const auto spot = windowed_centroid(dn, kWidth, near, 64.0, 1.2, 100.0))
    VBAR_FUZZ_EXPECT(spot->centre.allFinite() && spot->centre.x() > -1.0 && spot->centre.x() < kWidth &&
                     spot->centre.y() > -1.0 && spot->centre.y() < kStripRows);
  return 0;
}
