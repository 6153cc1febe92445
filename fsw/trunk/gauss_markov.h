#pragma once
// Blocks whose components are first-order Gauss-Markov processes, independent of each other.

#include "fsw/math/math.h"
#include "fsw/trunk/state.h"

namespace vbar::fsw::trunk {

/// Correlation time of a constant: its decay is exactly 1.
inline constexpr double kConstant = 1e300;

/// A stationary process: standard deviation, correlation time (s), and the mean to which it decays.
struct GaussMarkov {
  double sigma = 0.0;
  double time_s = kConstant;
  double mean = 0.0;

  bool operator==(const GaussMarkov&) const = default;

  [[nodiscard]] double decay(double dt) const { return math::exp(-dt / time_s); }
  /// Variance of the process noise that keeps the stationary variance over a step with this decay.
  [[nodiscard]] double renewed_variance(double decay) const { return sigma * sigma * (1.0 - decay * decay); }
};

/// Component `i` activated with the stationary distribution.
inline void begin_process(Estimate& estimate, int i, const GaussMarkov& process) {
  estimate.reset(i, process.mean, process.sigma * process.sigma);
}

/// Propagates component `i`; no effect while it is inactive.
inline void advance_process(Estimate& estimate, int i, const GaussMarkov& process, double decay) {
  if (estimate.is_idle(i)) return;
  estimate.scale(i, decay);
  estimate.shift(i, (1.0 - decay) * process.mean);
  estimate.add_noise(i, process.renewed_variance(decay));
}

template <class Block>
void begin_block(Estimate& estimate, const GaussMarkov& process) {
  for (int k = 0; k < Block::kSize; ++k) begin_process(estimate, kAt<Block> + k, process);
}

template <class Block>
void advance_block(Estimate& estimate, const GaussMarkov& process, double dt) {
  if (estimate.is_idle(kAt<Block>)) return;
  const double decay = process.decay(dt);
  for (int k = 0; k < Block::kSize; ++k) advance_process(estimate, kAt<Block> + k, process, decay);
}

/// Deactivates a block: variance zero, mean zero. No other block changes.
template <class Block>
void rest_block(Estimate& estimate) {
  for (int k = Block::kSize; k-- > 0;) estimate.reset(kAt<Block> + k, 0.0, 0.0);
}

template <class Block>
[[nodiscard]] bool is_active(const Estimate& estimate) {
  return !estimate.is_idle(kAt<Block>);
}

}  // namespace vbar::fsw::trunk
