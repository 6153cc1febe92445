#include "hil_drivers/optical_stimulator/pictures/display_light.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>
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

namespace {

constexpr std::size_t kPixels = std::tuple_size_v<Patch<double>>;
constexpr int kRounds = 24;
constexpr double kFluxWeight = 0.3;  // px

/// Flux and first moments about the middle of the patch.
struct Moments {
  double flux = 0.0, x = 0.0, y = 0.0;
};

constexpr double column(std::size_t pixel) {
  return static_cast<double>(pixel % kPatchSide) - kPatchReach;
}
constexpr double row(std::size_t pixel) {
  return static_cast<double>(pixel / kPatchSide) - kPatchReach;
}

Moments moments_of(const Patch<double>& electrons) {
  Moments sum;
  for (std::size_t pixel = 0; pixel < kPixels; ++pixel) {
    sum.flux += electrons[pixel];
    sum.x += electrons[pixel] * column(pixel);
    sum.y += electrons[pixel] * row(pixel);
  }
  return sum;
}

/// A step of one count of one pixel.
struct Step {
  std::size_t pixel = 0;
  int count = 0;
  Moments change;
};

class Search {
 public:
  Search(const DisplayLight& light, int x, int y, const Patch<double>& electrons)
      : light_(light), wanted_(moments_of(electrons)) {
    for (std::size_t pixel = 0; pixel < kPixels; ++pixel) {
      full_[pixel] = light.full_electrons(x + static_cast<int>(column(pixel)), y + static_cast<int>(row(pixel)));
      counts_[pixel] = light.nearest_count(electrons[pixel] / full_[pixel]);
    }
  }

  Patch<std::uint8_t> run() {
    for (int round = 0; round < kRounds && wanted_.flux > 0.0; ++round)
      if (!improve()) break;
    Patch<std::uint8_t> counts;
    std::ranges::transform(counts_, counts.begin(), [](int count) { return static_cast<std::uint8_t>(count); });
    return counts;
  }

 private:
  [[nodiscard]] double cost(const Moments& shown) const {
    if (!(shown.flux > 0.0)) return 1e300;
    const double flux = kFluxWeight * (shown.flux - wanted_.flux) / wanted_.flux;
    const double x = shown.x / shown.flux - wanted_.x / wanted_.flux;
    const double y = shown.y / shown.flux - wanted_.y / wanted_.flux;
    return flux * flux + x * x + y * y;
  }

  void collect_steps() {
    Patch<double> electrons;
    step_count_ = 0;
    for (std::size_t pixel = 0; pixel < kPixels; ++pixel) {
      const int count = counts_[pixel];
      electrons[pixel] = full_[pixel] * light_.fraction(count);
      for (const int other : {light_.below(count), light_.above(count)}) {
        if (other == count) continue;
        const double change = full_[pixel] * light_.fraction(other) - electrons[pixel];
        steps_[step_count_++] = {pixel, other, {change, change * column(pixel), change * row(pixel)}};
      }
    }
    // From the pixels and not by increments: no error accumulates, and the result does not depend on the path.
    shown_ = moments_of(electrons);
  }

  bool improve() {
    collect_steps();
    double best = cost(shown_);
    const Step *first = nullptr, *second = nullptr;
    const auto plus = [](const Moments& a, const Moments& b) { return Moments{a.flux + b.flux, a.x + b.x, a.y + b.y}; };
    for (std::size_t i = 0; i < step_count_; ++i) {
      const Moments one = plus(shown_, steps_[i].change);
      if (const double single = cost(one); single < best) {
        best = single;
        first = &steps_[i];
        second = nullptr;
      }
      for (std::size_t j = i + 1; j < step_count_; ++j) {
        if (steps_[j].pixel == steps_[i].pixel) continue;
        const double paired = cost(plus(one, steps_[j].change));
        if (!(paired < best)) continue;
        best = paired;
        first = &steps_[i];
        second = &steps_[j];
      }
    }
    if (first == nullptr) return false;
    for (const Step* const step : {first, second})
      if (step != nullptr) counts_[step->pixel] = step->count;
    return true;
  }

  const DisplayLight& light_;
  Moments wanted_, shown_;
  Patch<double> full_{};
  Patch<int> counts_{};
  std::array<Step, 2 * kPixels> steps_;
  std::size_t step_count_ = 0;
};

}  // namespace

Patch<std::uint8_t> matched_counts(const DisplayLight& light, int x, int y, const Patch<double>& electrons) {
  return Search(light, x, y, electrons).run();
}

}  // namespace vbar::optical_stimulator
