#include "hil_drivers/tron/image/binning.h"

#include <stdexcept>

#include <fmt/format.h>

namespace vbar::tron {

std::vector<std::uint16_t> binned_by_two(std::span<const std::uint16_t> dn, int width, int height) {
  if (width < 2 || height < 2 || width % 2 != 0 || height % 2 != 0 ||
      dn.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
    throw std::invalid_argument(
        fmt::format("{} pixels are not an image of {} x {} that can be binned by two", dn.size(), width, height));
  const auto columns = static_cast<std::size_t>(width);
  std::vector<std::uint16_t> means(dn.size() / 4);
  std::size_t k = 0;
  for (std::size_t row = 0; row < dn.size(); row += 2 * columns) {
    const std::uint16_t* const upper = dn.data() + row;
    const std::uint16_t* const lower = upper + columns;
    for (std::size_t x = 0; x < columns; x += 2)
      means[k++] = static_cast<std::uint16_t>((upper[x] + upper[x + 1] + lower[x] + lower[x + 1] + 2U) / 4U);
  }
  return means;
}

}  // namespace vbar::tron
