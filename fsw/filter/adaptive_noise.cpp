#include "fsw/filter/adaptive_noise.h"

#include <algorithm>

namespace vbar::fsw::filter {
namespace {

// The correlation of 60 pairs of white samples has a standard deviation of 0.13: thresholds at three of it and at one.
constexpr double kLagging = 0.39;
constexpr double kWhite = 0.13;
constexpr double kExpectedSquares = 2.0;  // of two normalised innovations
constexpr double kRaise = 10.0;
constexpr double kLower = 0.5;

}  // namespace

void AdaptiveNoise::add(const Vector2& normalised, Correlation correlation) {
  if (has_last_) {
    products_ += normalised.dot(last_);
    squares_ += 0.5 * (normalised.squaredNorm() + last_.squaredNorm());
    ++pairs_;
  }
  last_ = normalised;
  has_last_ = true;
  if (pairs_ < kWindow) return;
  const bool exceeds = squares_ > kExpectedSquares * kWindow;
  const bool may_lag = correlation == Correlation::kOfLag || (correlation == Correlation::kOfEitherBySize && exceeds);
  if (products_ > kLagging * squares_) {
    if (may_lag) psd_ = std::min(psd_ * kRaise, settings_.psd_max);
  } else if (products_ < (may_lag ? kWhite : kLagging) * squares_) {
    psd_ = std::max(psd_ * kLower, settings_.psd_min);
  }
  interrupt();
}

void AdaptiveNoise::interrupt() {
  has_last_ = false;
  pairs_ = 0;
  products_ = 0.0;
  squares_ = 0.0;
}

}  // namespace vbar::fsw::filter
