#include "hil_drivers/optical_stimulator/bench/screen/panel.h"

#include <algorithm>

namespace vbar::optical_stimulator::bench {

Pictures Panel::show(Pictures pictures, const PanelFaults& faults) {
  Pictures shown = faults.is_late && !screen_before_.empty() ? screen_before_ : pictures;
  screen_before_ = std::move(pictures);
  if (faults.is_frozen && !shown_before_.empty()) {
    shown = shown_before_;
  } else {
    shown_before_ = shown;
  }
  for (Picture& picture : shown) picture = with(picture, faults);
  return shown;
}

Picture Panel::with(const Picture& picture, const PanelFaults& faults) const {
  if (!faults.is_covered && !faults.is_mirrored && !faults.is_rotated) return picture;
  constexpr std::uint8_t kWindowCount = 128;
  auto counts = std::make_shared<std::vector<std::uint8_t>>(*picture.counts);
  const auto row_begin = [&](int row) { return counts->begin() + static_cast<std::ptrdiff_t>(row) * width_; };
  if (faults.is_covered)
    for (int row = height_ / 4; row < 3 * height_ / 4; ++row)
      std::fill(row_begin(row) + width_ / 4, row_begin(row) + 3 * width_ / 4, kWindowCount);
  if (faults.is_rotated) std::reverse(counts->begin(), counts->end());
  if (faults.is_mirrored)
    for (int row = 0; row < height_; ++row) std::reverse(row_begin(row), row_begin(row) + width_);
  return {std::move(counts), picture.fraction};
}

}  // namespace vbar::optical_stimulator::bench
