#pragma once
// Probability that two spacecraft whose relative position is normally distributed are within the sum of their radii.
//
// In proximity operations relative speeds are millimetres to metres per second: there is no short encounter, and the
// measure is the instantaneous probability, its maximum over a drift being the risk. The along-track position has the
// largest uncertainty; the probability in the RN plane treats it as unknown, which bounds the risk of such formations
// from above.

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/safety/linear_drift.h"

namespace vbar::fsw::safety {

using Vector2 = Eigen::Matrix<double, 2, 1>;
using Matrix2 = Eigen::Matrix<double, 2, 2>;

// All functions: lengths in m, covariances in m^2, `radius` is the combined hard-body radius, >= 0. kNotFinite;
// kOutOfRange for negative lengths or a covariance that is not positive definite. Results lie in [0, 1].

/// Returns the instantaneous probability for a spherical distribution with standard deviation `sigma` whose mean is
/// `distance` away: the closed form of the non-central Maxwell distribution.
Result<double> collision_probability_isotropic(double distance, double sigma, double radius);

/// Returns the instantaneous probability: the integral over the ball of a general normal distribution of the relative
/// position. Two nested quadratures are in the principal axes, the third integral is in closed form. Relative error
/// under 1e-6 where every standard deviation is above half the radius, under 1e-3 where above a thirtieth.
Result<double> collision_probability(const Vector3& mean, const Matrix3& covariance, double radius);

/// Returns the integral over the disk of a two-dimensional normal distribution: in the RN plane, or an encounter plane.
/// Relative error under 1e-6 where both standard deviations are above a tenth of the radius.
Result<double> collision_probability_in_plane(const Vector2& mean, const Matrix2& covariance, double radius);

/// Returns the probability of a short encounter (Foster and Estes 1992), from the relative state at closest approach
/// and the sum of both position covariances in one frame. The motion is straight and the covariance constant while it
/// lasts. kOutOfRange without relative velocity.
Result<double> collision_probability_short_encounter(const Vector3& relative_position, const Vector3& relative_velocity,
                                                     const Matrix3& covariance, double radius);

/// Returns the largest probability for any scaling of the covariance, for a short encounter with a radius small
/// against the miss, R^2 / (exp(1) s1 s2 d_M^2) with d_M the Mahalanobis distance (dilution; Alfano 2005): an upper
/// bound if the size of the covariance is uncertain. 1 if the miss is within the radius.
Result<double> maximum_probability_short_encounter(const Vector3& relative_position, const Vector3& relative_velocity,
                                                   const Matrix3& covariance, double radius);

// Largest probability of collision during a free drift.

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
