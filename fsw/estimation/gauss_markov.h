#pragma once
// First-order Gauss-Markov processes of components of an estimate, and blocks that consist of them.
//
//   x <- d x + (1 - d) mean + w,  d = exp(-dt / time),  variance of w: sigma^2 (1 - d^2)

#include "fsw/estimation/estimate.h"
#include "fsw/estimation/state_layout.h"
#include "fsw/math/math.h"

namespace vbar::fsw::estimation {

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

/// Activates component `i` with the stationary distribution.
template <int N>
void initialize_process(Estimate<N>& estimate, int i, const GaussMarkov& process) {
  estimate.reset(i, process.mean, process.sigma * process.sigma);
}

/// Propagates component `i`; has no effect while it is inactive.
template <int N>
void propagate_process(Estimate<N>& estimate, int i, const GaussMarkov& process, double decay) {
  if (estimate.is_inactive(i)) return;
  estimate.scale(i, decay);
  estimate.shift(i, (1.0 - decay) * process.mean);
  estimate.add_noise(i, process.renewed_variance(decay));
}

/// Propagates the active components of a block, all by the same process.
template <class State, class Block>
void propagate_components(Estimate<State::kSize>& estimate, const GaussMarkov& process, const BlockStep& step) {
  constexpr int kFirst = State::template offset<Block>();
  const double decay = process.decay(step.dt_s);
  for (int k = 0; k < Block::kSize; ++k) propagate_process(estimate, kFirst + k, process, decay);
}

/// Base of a block of independent processes with equal settings: `struct Bias : GaussMarkovBlock<Bias, 2>`, with
/// `static constexpr GaussMarkov kDefaults`.
template <class Block, int kComponents>
struct GaussMarkovBlock {
  static constexpr int kSize = kComponents;
  using Settings = GaussMarkov;

  template <class State>
  static void propagate(Estimate<State::kSize>& estimate, const Settings& process, const BlockStep& step) {
    propagate_components<State, Block>(estimate, process, step);
  }
};

}  // namespace vbar::fsw::estimation
