#pragma once
// Hypotheses on bearings that contradict the orbit, side by side: the orbit is as estimated, or it has changed as by an
// unknown burn of one of several sizes; with each, bearings scatter by one of several factors. All share the same
// window of bearings, and are compared by the likelihood of that window with the orbit integrated out (Bayes factors:
// Kass, Raftery 1995; a static multiple-model estimator, Bar-Shalom, Li, Kirubarajan 2001, section 11.6.2):
//
//   -2 ln L = y' S^-1 y + ln det S,   S = k R + J P J',
//
// P: covariance of the orbit under the hypothesis, k: factor of the scatter. The estimate itself changes only when one
// alternative has won: scatter of the bearings alone leaves a correct estimate as it is, whatever its size.

#include <cstddef>

#include "fsw/core/result.h"
#include "fsw/measurements/bearings/bearing_batch.h"

namespace vbar::fsw::measurements {

/// The orbit as navigation estimates it at the last bearing of a window.
struct EstimatedOrbit {
  orbit::CartesianState servicer;
  Vector6 roe = Vector6::Zero();
  Matrix6 covariance = Matrix6::Zero();
  double common_sigma = 0.0;  ///< rad, error that all bearings of the window have in common, each axis
  double distance_m = 0.0;    ///< to the target
  double unseen_s = 0.0;      ///< time since the last bearing before the window: when an unknown burn may have been
  orbit::EarthOrientation earth;
  Vector3 sun_eci = Vector3::UnitX();
};

/// The most likely hypotheses of a window.
struct OrbitVerdict {
  static constexpr int kAsEstimated = -1;
  int best = kAsEstimated;    ///< of the alternatives: the most likely one, its index
  double log_odds = 0.0;      ///< its log-likelihood less that of the orbit as estimated
  double scatter = 1.0;       ///< factor of the variances of the bearings, if the orbit is as estimated
  double best_scatter = 1.0;  ///< the same under the most likely alternative
};

/// Weighs the hypotheses on the bearings of a window. Errors: those of BearingBatch::normal_equations; kSingular.
Result<OrbitVerdict> weigh_orbits(BearingBatch& window, const EstimatedOrbit& estimated);

/// ROE and covariance by the window under the most likely alternative. kDidNotConverge, kSingular, or as above.
struct RevisedOrbit {
  Vector6 roe = Vector6::Zero();
  Matrix6 covariance = Matrix6::Zero();
};
Result<RevisedOrbit> revised_orbit(BearingBatch& window, const EstimatedOrbit& estimated, const OrbitVerdict& verdict);

/// Covariance of the orbit after the largest unknown burn among the hypotheses: what a new batch begins with.
Result<Matrix6> widest_covariance(const EstimatedOrbit& estimated);

}  // namespace vbar::fsw::measurements
