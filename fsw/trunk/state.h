#pragma once
// The state of the relative estimator, x = [roe(6), push(2), emp(3) | turn(3), rate(3), body(2) | com(3),
// bearing_bias(2), mounts(4), sun_off(1), wander(2), kp_common(8), kp_err(22), range_bias(1), ant_s(3), ant_t(3),
// pcv(3), clk(1), cb(3), iono(3), amb(56), phase_wander(56)].
//
// One estimate for all sensors: each block is inactive (variance zero, no influence, no cost behind the last active
// one) until a source needs it. The blocks at the head are nonlinear and propagated by sigma points; all others enter
// linearly. The servicer's own orbit is a separate estimate (own_orbit.h): a relative measurement observes it only by
// its error divided by the semi-major axis, 3e-7 of the separation, so that the joint covariance is block-diagonal.

#include "fsw/estimation/estimate.h"
#include "fsw/estimation/layout.h"
#include "fsw/estimation/rows.h"
#include "fsw/network/sizes.h"
#include "fsw/packets/message_list.h"

namespace vbar::fsw::trunk {

inline constexpr int kPhaseChannelCount = 56;

struct Roe {
  static constexpr int kSize = 6;  ///< osculating, of the target with respect to the servicer, dimensionless
};
struct DifferentialAccelerations {
  static constexpr int kSize = 2;  ///< m/s^2, of the target: along track (drag), away from the Sun (in sunlight)
};
struct EmpiricalAcceleration {
  static constexpr int kSize = 3;  ///< m/s^2, of the target in its RTN
};
struct Turn {
  static constexpr int kSize =
      3;  ///< target's attitude, generalised Rodrigues parameters about a reference (USQUE), rad
};
struct Rate {
  static constexpr int kSize = 3;  ///< target's rate with respect to ECI, body axes, rad/s
};
struct InertiaRatios {
  static constexpr int kSize = 2;  ///< logarithms of J_yy / J_xx and J_zz / J_xx over those of the model
};
struct KeypointOrigin {
  static constexpr int kSize = 3;  ///< of the keypoints' frame from the centre of mass, body axes, m
};
struct BearingBias {
  static constexpr int kSize = 2;  ///< of bearings among stars, in the rows of bearing_axes(), rad
};
struct CameraMounts {
  static constexpr int kPerCamera = 2;  ///< error of the boresight against the star tracker, likewise, rad
  static constexpr int kSize = kPerCamera * static_cast<int>(packets::kCameras);
};
struct BrightnessOffset {
  static constexpr int kSize = 1;  ///< centre of brightness from the centre of mass, towards the Sun, m
};
struct CentroidWander {
  static constexpr int kSize = 2;  ///< of the centroid of a resolved shape, in the rows of bearing_axes(), m
};
struct KeypointCommon {
  /// Of all keypoints: shift (px, px), stretch, the lasting stretch of each camera (shares), and the lasting turn, body
  /// axes, rad.
  static constexpr int kLastingStretch = 3;
  static constexpr int kLastingTurn = kLastingStretch + static_cast<int>(packets::kCameras);
  static constexpr int kSize = kLastingTurn + 3;
};
struct KeypointErrors {
  static constexpr int kSize = 2 * network::kKeypoints;  ///< each over its standard deviation
};
struct RangeBias {
  static constexpr int kSize = 1;  ///< of a range finder, constant, m
};
struct ServicerAntenna {
  static constexpr int kSize = 3;  ///< offset from the nominal phase centre, body axes, m
};
struct TargetAntenna {
  static constexpr int kSize = 3;
};
struct PhaseCentreJitter {
  static constexpr int kSize = 3;  ///< of the pair of phase centres, new at each epoch, ECI, m
};
struct ClockDifference {
  static constexpr int kSize = 1;  ///< target minus servicer, new at each epoch, m
};
struct CodeBiases {
  static constexpr int kSize = 3;  ///< of GPS L2, Galileo E1, BeiDou B1I over GPS L1, m
};
struct Ionosphere {
  /// Vertical group delay of L1 by the electrons above the servicer, m, and its change along the track and the orbit
  /// normal, m per 1000 km.
  static constexpr int kSize = 3;
};
struct Ambiguities {
  static constexpr int kSize = kPhaseChannelCount;  ///< of single differences, m
};
struct PhaseWander {
  static constexpr int kSize = kPhaseChannelCount;  ///< time-correlated error of single differences of phase, m
};

using State = estimation::Layout<Roe, DifferentialAccelerations, EmpiricalAcceleration, Turn, Rate, InertiaRatios,
                                 KeypointOrigin, BearingBias, CameraMounts, BrightnessOffset, CentroidWander,
                                 KeypointCommon, KeypointErrors, RangeBias, ServicerAntenna, TargetAntenna,
                                 PhaseCentreJitter, ClockDifference, CodeBiases, Ionosphere, Ambiguities, PhaseWander>;
using Estimate = estimation::Estimate<State::kSize>;

/// Most rows of one measurement: two of each keypoint.
inline constexpr int kMaxRows = 2 * network::kKeypoints;
using Rows = estimation::Rows<State::kSize, kMaxRows>;

/// Index of the first component of a block.
template <class Block>
inline constexpr int kAt = State::offset<Block>();
/// The same of the mount of a camera.
constexpr int mount_at(std::size_t camera) {
  return kAt<CameraMounts> + CameraMounts::kPerCamera * static_cast<int>(camera);
}

/// The blocks of the orbit and of the attitude that are sampled together; both stand at the head of the state.
inline constexpr int kOrbitSize = Roe::kSize + DifferentialAccelerations::kSize + EmpiricalAcceleration::kSize;
inline constexpr int kAttitudeSize = Turn::kSize + Rate::kSize + InertiaRatios::kSize;
inline constexpr int kHeadSize = kOrbitSize + kAttitudeSize;
static_assert(kAt<Turn> == kOrbitSize && kAt<KeypointOrigin> == kHeadSize);

}  // namespace vbar::fsw::trunk
