#include <cstddef>

#include "host_sim/twins/camera/detector.h"

namespace vbar::twins::camera {
namespace {

struct Excess {
  std::size_t pixel;
  float electrons;
};

}  // namespace

double bloom(const BloomingSettings& settings, int width, int height, std::vector<float>& charge) {
  const auto full_well = static_cast<float>(settings.full_well_electrons);
  const auto columns = static_cast<std::size_t>(width), rows = static_cast<std::size_t>(height);
  double drained = 0.0;
  std::vector<std::size_t> suspects;  // pixels that may exceed the full well
  for (std::size_t pixel = 0; pixel < columns * rows; ++pixel)
    if (charge[pixel] > full_well) suspects.push_back(pixel);

  std::vector<Excess> excesses;
  for (int round = 0; !suspects.empty(); ++round) {
    excesses.clear();
    for (const std::size_t pixel : suspects) {
      if (!(charge[pixel] > full_well)) continue;  // processed before, or below the full well
      excesses.push_back({pixel, charge[pixel] - full_well});
      charge[pixel] = full_well;
    }
    suspects.clear();
    const double spilled_fraction = round < kBloomingRounds ? settings.spilled_fraction : 0.0;
    for (const Excess& excess : excesses) {
      const auto share = static_cast<float>(0.25 * spilled_fraction * static_cast<double>(excess.electrons));
      drained += static_cast<double>(excess.electrons) - 4.0 * static_cast<double>(share);
      const std::size_t column = excess.pixel % columns, row = excess.pixel / columns;
      const auto give = [&](bool is_inside, std::size_t neighbour) {
        if (!is_inside) {
          drained += static_cast<double>(share);
        } else if (share > 0.0F) {
          charge[neighbour] += share;
          suspects.push_back(neighbour);
        }
      };
      give(column > 0, excess.pixel - 1);
      give(column + 1 < columns, excess.pixel + 1);
      give(row > 0, excess.pixel - columns);
      give(row + 1 < rows, excess.pixel + columns);
    }
  }
  return drained;
}

}  // namespace vbar::twins::camera
