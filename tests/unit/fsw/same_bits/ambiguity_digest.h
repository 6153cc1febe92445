#pragma once
// Digest of decisions on float ambiguities over random problems: factorisation, reduction, search and validation.

#include <array>
#include <cstddef>
#include <memory>
#include <span>

#include "fsw/gnss/ambiguity_validation.h"
#include "tests/unit/fsw/same_bits/digest.h"

namespace vbar::same_bits {

/// Double differences of one epoch: directions in space times an uncertain baseline, and a noise with one satellite in
/// common. From four to 48 ambiguities, strong to hopeless.
inline std::uint64_t ambiguity_digest() {
  namespace gnss = fsw::gnss;
  Arguments arguments(7);
  Digest digest;
  const auto workspace = std::make_unique<gnss::ValidationWorkspace>();
  constexpr std::size_t kMax = 48;
  std::array<double, kMax> floats{};
  std::array<double, kMax * kMax> covariance{};
  std::array<std::array<double, 3>, kMax> direction{};
  for (std::size_t k = 0; k < 90; ++k) {
    const std::size_t n = 4 + k / 2;
    const double baseline_cycles2 = arguments.between(0.05, 9.0);
    const double noise_cycles2 = arguments.between(1e-5, 1e-3);
    for (std::size_t i = 0; i < n; ++i) {
      for (double& component : direction[i]) component = arguments.between(-1.0, 1.0);
      floats[i] = arguments.between(-1e5, 1e5);
    }
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t i = 0; i < n; ++i) {
        double along = 0.0;
        for (std::size_t axis = 0; axis < 3; ++axis) along += direction[i][axis] * direction[j][axis];
        covariance[i + j * n] = baseline_cycles2 * along + noise_cycles2 * (i == j ? 2.0 : 1.0);
      }
    }
    // Near integers for half of them: along a baseline error, with noise.
    if (k % 2 == 0) {
      std::array<double, 3> error{};
      for (double& component : error) component = arguments.between(-0.3, 0.3);
      for (std::size_t i = 0; i < n; ++i) {
        floats[i] = static_cast<double>(i * i) + arguments.between(-0.01, 0.01);
        for (std::size_t axis = 0; axis < 3; ++axis) floats[i] += direction[i][axis] * error[axis];
      }
    }
    const fsw::Result<gnss::AmbiguityDecision> result =
        gnss::decide_ambiguities(std::span(floats).first(n), std::span(covariance).first(n * n), {}, *workspace);
    const gnss::AmbiguityDecision& decision = result.value();
    digest.add(static_cast<double>(result.status()));
    digest.add(static_cast<double>(decision.rejection_reason));
    digest.add(static_cast<double>(decision.tried));
    for (std::size_t i = 0; i < decision.count; ++i) {
      digest.add(static_cast<double>(decision.position[i]));
      digest.add(decision.whole[i]);
    }
    for (const double number : {decision.success_rate, decision.ratio, decision.residual}) digest.add(number);
  }
  return digest.value();
}

}  // namespace vbar::same_bits
