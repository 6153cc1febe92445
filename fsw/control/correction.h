#pragma once
// The smallest change of existing burns that corrects their arrival.

#include <array>
#include <cstddef>
#include <span>

#include "fsw/control/arrival.h"
#include "fsw/control/plan.h"

namespace vbar::fsw::control {

/// Weights of a correction: cost of changes against arrival error.
struct CorrectionSettings {
  /// Weight of a radial impulse relative to a transverse or normal one: above one keeps R components small, so they
  /// are used only where necessary, across the phase of the eccentricity vector.
  double radial_price = 2.0;
  /// A direction of the arrival with a gain below this share of the largest is not corrected: it would
  /// cost more delta-v than justified, and another plan corrects it for less.
  double min_gain = 0.02;
};

/// Changes of impulses, m/s, in the sign of the effects they were found with.
struct Correction {
  std::array<Vector3, kMaxBurns> dv{};
  std::size_t count = 0;
};

/// The least-norm change of burns, with 6x3 effects E_k on the dimensionless ROE per m/s, such that sum E_k dv_k =
/// residual but for the truncated directions. kInvalidArgument without burns or with more than kMaxBurns; kNotFinite;
/// kSingular if all effects vanish.
Result<Correction> least_norm_correction(std::span<const Matrix63> effects, const Vector6& residual,
                                         const CorrectionSettings& settings = {});

/// `plan`, flown after all of `committed`, with its impulses, not its times, corrected for arrival: Newton steps
/// of least norm on the nonlinear prediction. It may still miss in directions that its times do not control; evaluate
/// it. kInvalidArgument for a plan without burns; errors of arrival_error() and least_norm_correction().
Result<Plan> correct_plan(const MeanOrbits& orbits, const Plan& committed, const Plan& plan, const Waypoint& waypoint,
                          const CorrectionSettings& settings = {});

/// Distance (m) at the waypoint's time between actual and desired position of the target, for an arrival error in
/// ROE. kNotFinite.
Result<double> arrival_distance(const MeanOrbits& orbits, const Waypoint& waypoint, const Vector6& roe_error);

}  // namespace vbar::fsw::control
