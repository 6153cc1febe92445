#pragma once
// The smallest change of existing burns that corrects their arrival.

#include <array>
#include <cstddef>
#include <span>

#include "fsw/control/arrival.h"
#include "fsw/control/plan.h"

namespace vbar::fsw::control {

/// Holds the weights of a correction: cost of changes against arrival error.
struct CorrectionSettings {
  /// Weight of a radial impulse relative to a transverse or normal one. A weight above one keeps R components small:
  /// they are used only where necessary, across the phase of the eccentricity vector.
  double radial_price = 2.0;
  /// Smallest gain, as a share of the largest, of a direction of the arrival that is corrected. Other directions would
  /// cost more delta-v than justified, and another plan corrects them for less.
  double min_gain = 0.02;
};

/// Holds changes of impulses, m/s, with the sign of the effects that they were found with.
struct Correction {
  std::array<Vector3, kMaxBurns> dv{};
  std::size_t count = 0;
};

/// Returns the least-norm change of burns, with 6x3 effects E_k on the dimensionless ROE per m/s, such that sum E_k
/// dv_k = residual but for the truncated directions. kInvalidArgument without burns or with more than kMaxBurns;
/// kNotFinite; kSingular if all effects vanish.
Result<Correction> least_norm_correction(std::span<const Matrix63> effects, const Vector6& residual,
                                         const CorrectionSettings& settings = {});

/// Returns `plan`, flown after all of `committed`, with its impulses corrected for arrival, not its times: Newton steps
/// of least norm on the nonlinear prediction. The result may still miss in directions that its times do not control,
/// and must be evaluated. kInvalidArgument for a plan without burns; errors of arrival_error() and
/// least_norm_correction().
Result<Plan> correct_plan(const MeanOrbits& orbits, const Plan& committed, const Plan& plan, const Waypoint& waypoint,
                          const CorrectionSettings& settings = {});

/// Returns the distance (m) at the waypoint's time between actual and desired position of the target, for an arrival
/// error in ROE. kNotFinite.
Result<double> arrival_distance(const MeanOrbits& orbits, const Waypoint& waypoint, const Vector6& roe_error);

}  // namespace vbar::fsw::control
