#pragma once
// Burns found in an orbit alone: where a velocity change explains what a fit leaves over.
//
// For an impulse at any time the reduction of the sum of squares follows from the design of the fit by its orthogonal
// factor: with Phi(t) = Q6(t) R66 the normal matrix of an impulse at tb is B^T (M - W W^T) B, M = sum Q6^T Q6 and
// W = sum Q6^T Q over the positions behind tb, B = R66 Phi(tb)^-1 [0; R_eci_rtn]. Sums from the end of the arc give it
// for all times at once, and for all pairs.

#include <optional>
#include <string>
#include <vector>

#include "host_sim/orbit_fit/batch.h"

namespace vbar::orbit_fit {

/// Impulses that would explain most of what a fit leaves over, and the rms (m) that would remain by linear theory.
struct Break {
  std::vector<Burn> burns;  ///< one, or two within a few revolutions of each other
  double rms_m = 0.0;
};

/// Returns the best single impulse, or the best pair about it where a pair halves what the single one leaves; nothing
/// if impulses do not halve the rms of the fit, or for an arc below three
/// revolutions.
[[nodiscard]] std::optional<Break> find_break(const Batch& batch, const FittedOrbit& fitted,
                                              const Estimated& estimated);

/// Adds burns where the residuals break, up to `largest` of them, and fits again with them.
[[nodiscard]] FittedOrbit fit_with_found_burns(const Batch& batch, FittedOrbit fitted, const Estimated& estimated,
                                               std::size_t largest);

}  // namespace vbar::orbit_fit
