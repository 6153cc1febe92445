#pragma once
// Block of the errors that the keypoints of successive images have in common.
//
// A network has the same errors for the same view, so that a filter that assumed white errors would soon underestimate
// its covariance by a factor of ten. A share of each keypoint's own error, and a shift and stretch of all, are
// therefore Gauss-Markov states that decay as the target rotates: by 1/e in 11 to 14 deg, measured over ten tumbles of
// 0.3 to 1.5 deg/s. A part of the stretch is constant: it is equivalent to another range, and only known burns separate
// the two. A part of the rotation error lasts as well, over many views: without it, attitude errors of half a degree
// persisted for 10 to 30 minutes at a sigma of 0.3 deg.

#include "fsw/trunk/gauss_markov.h"

namespace vbar::fsw::trunk {

struct KeypointErrorSettings {
  double correlated_share = 0.85;     ///< share of a keypoint's variance that is common to images of the same view
  double shift_sigma_px = 0.8;        ///< of all keypoints together, per axis: likewise
  double stretch_sigma = 9e-3;        ///< of the target's apparent size: likewise
  double correlation_angle = 0.21;    ///< rad: rotation of the target over which keypoint errors decorrelate
  double correlation_time_s = 120.0;  ///< s: decorrelation for a target with a small rate
  GaussMarkov lasting_stretch{.sigma = 4e-3,
                              .time_s = 3600.0};  ///< of the apparent size in a camera, constant over all views
  GaussMarkov lasting_turn{.sigma = 1e-2, .time_s = 600.0};  ///< rad, per body axis, over all views
};

/// All errors with their stationary distribution.
void begin_keypoint_errors(Estimate& estimate, const KeypointErrorSettings& settings);
void rest_keypoint_errors(Estimate& estimate);
/// `rate`: of the target, rad/s.
void advance_keypoint_errors(Estimate& estimate, const KeypointErrorSettings& settings, double rate, double dt);

}  // namespace vbar::fsw::trunk
