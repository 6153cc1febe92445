#include "hil_drivers/optical_stimulator/counts/display_light.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace vbar::optical_stimulator {

DisplayLight::DisplayLight(const DisplayResponse& response, int width, int height, std::vector<float> full_electrons)
    : width_(width), height_(height), contrast_(response.contrast), full_electrons_(std::move(full_electrons)) {
  const auto is_positive = [](double number) { return std::isfinite(number) && number > 0.0; };
  if (!is_positive(response.gamma) || !is_positive(response.contrast))
    throw std::invalid_argument("the response of a display must be of positive numbers");
  if (!(response.first_count >= 0.0 && response.first_count <= 254.0))
    throw std::invalid_argument("the first count of a display must lie between 0 and 254");
  if (width < 1 || height < 1 ||
      full_electrons_.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
    throw std::invalid_argument("the light of full pixels is not that of a display of this size");
  if (!std::ranges::all_of(full_electrons_, [&](float electrons) { return is_positive(electrons); }))
    throw std::invalid_argument("the light of a full pixel must be positive");
  const double range = kFull - response.first_count;
  for (int count = 0; count <= kFull; ++count)
    fractions_[static_cast<std::size_t>(count)] =
        count > response.first_count ? std::pow((count - response.first_count) / range, response.gamma) : 0.0;
  first_lit_ = static_cast<int>(std::floor(response.first_count)) + 1;
}

std::uint8_t DisplayLight::nearest_count(double fraction) const {
  if (!(fraction > 0.0)) return 0;
  const auto next = std::ranges::lower_bound(fractions_, fraction);
  if (next == fractions_.end()) return kFull;
  const int count = static_cast<int>(next - fractions_.begin());
  const int lower = below(count);
  return static_cast<std::uint8_t>(fraction - this->fraction(lower) < this->fraction(count) - fraction ? lower : count);
}

}  // namespace vbar::optical_stimulator
