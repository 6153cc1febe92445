#pragma once
// The state of the relative estimator: blocks of the orbit and the attitude of the target, and those of the measurement
// sources (fsw/measurements/state_blocks/state_blocks.h).
//
//   x = [roe(6) -, push(2) m/s^2, emp(3) m/s^2 | turn(3) rad, rate(3) rad/s, body(2) - | com(3) m, bearing_bias(2) rad,
//        mounts(4) rad, sun_off(1) m, wander(2) m, kp_common(8) px - rad, kp_err(22) -, range_bias(1) m, ant_s(3) m,
//        ant_t(3) m, pcv(3) m, clk(1) m, cb(3) m, iono(3) m m/1000 km, amb(56) m, phase_wander(56) m]
//
// One estimate serves all sensors: each block is inactive (variance zero, no influence, no cost behind the last active
// one) until a source needs it. The blocks at the head are nonlinear and propagated by sigma points; all others enter
// linearly. The servicer's absolute orbit is a separate estimate (absolute_orbit.h): a relative measurement observes it
// only by its error divided by the semi-major axis, 3e-7 of the separation, so that the joint covariance is
// block-diagonal.

#include "fsw/estimation/estimate.h"
#include "fsw/estimation/gauss_markov.h"
#include "fsw/estimation/measurement_batch.h"
#include "fsw/estimation/state_layout.h"
#include "fsw/measurements/state_blocks/state_blocks.h"

namespace vbar::fsw::filter {

using estimation::GaussMarkov;

struct Roe {
  static constexpr int kSize = 6;  ///< osculating, of the target with respect to the servicer, dimensionless
};
struct DifferentialAccelerations {
  static constexpr int kSize =
      2;  ///< m/s^2, of the target: along its velocity through the air (drag), away from the Sun (in sunlight)
};
struct EmpiricalAcceleration {
  static constexpr int kSize = 3;  ///< m/s^2, of the target in its RTN
};
struct AttitudeError {
  static constexpr int kSize =
      3;  ///< target's attitude, generalised Rodrigues parameters about a reference (USQUE), rad
};
struct Rate {
  static constexpr int kSize = 3;  ///< target's rate with respect to ECI, body axes, rad/s
};
struct InertiaRatios {
  static constexpr int kSize = 2;  ///< logarithms of J_yy / J_xx and J_zz / J_xx over those of the model
};

using Head =
    estimation::Layout<Roe, DifferentialAccelerations, EmpiricalAcceleration, AttitudeError, Rate, InertiaRatios>;
using MeasurementBlocks = measurements::MeasurementBlocks;
using State = estimation::JoinedLayout<Head, MeasurementBlocks>;
using Estimate = estimation::Estimate<State::kSize>;
using MeasurementBatch = estimation::MeasurementBatch<State::kSize, measurements::kMaxMeasurements>;

/// Index of the first component of a block.
template <class Block>
inline constexpr int kAt = State::offset<Block>();

/// The blocks of the orbit and of the attitude that are sampled together; both stand at the head of the state.
inline constexpr int kOrbitSize = Roe::kSize + DifferentialAccelerations::kSize + EmpiricalAcceleration::kSize;
inline constexpr int kAttitudeSize = AttitudeError::kSize + Rate::kSize + InertiaRatios::kSize;
inline constexpr int kHeadSize = Head::kSize;
static_assert(kAt<AttitudeError> == kOrbitSize && kHeadSize == kOrbitSize + kAttitudeSize);

/// Activates a block with the stationary distribution of its process.
template <class Block>
void initialize_block(Estimate& estimate, const GaussMarkov& process) {
  for (int k = 0; k < Block::kSize; ++k) initialize_process(estimate, kAt<Block> + k, process);
}

/// Deactivates a block: variance zero, mean zero. No other block changes.
template <class Block>
void deactivate_block(Estimate& estimate) {
  for (int k = Block::kSize; k-- > 0;) estimate.reset(kAt<Block> + k, 0.0, 0.0);
}

template <class Block>
[[nodiscard]] bool is_active(const Estimate& estimate) {
  return !estimate.is_inactive(kAt<Block>);
}

}  // namespace vbar::fsw::filter
