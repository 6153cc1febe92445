#pragma once
// Largest probability of collision during a free drift.

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/safety/linear_drift.h"

namespace vbar::fsw::safety {

/// Holds the largest instantaneous probabilities of a drift that the bodies are within the sum of their radii.
struct DriftProbability {
  double spatial = 0.0;
  double radial_normal = 0.0;  ///< in the RN plane: position along track unknown
};

/// Returns the largest probabilities of a drift, from the mean ROE times a (m) at its start and their covariance (m^2);
/// `radius`, m, is the combined one. The probability is integrated at the three samples whose surfaces lie the fewest
/// standard deviations from the mean.
/// Errors of collision_probability.
Result<DriftProbability> drift_probability(const LinearDrift& drift, const Vector6& a_roe_m,
                                           const Matrix6& covariance_m2, double radius);

}  // namespace vbar::fsw::safety
