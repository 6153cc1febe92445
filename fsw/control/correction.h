#pragma once
// The smallest change of existing burns that moves where they arrive.

#include <array>
#include <cstddef>
#include <span>

#include "fsw/control/plan.h"

namespace vbar::fsw::control {

/// How a correction weighs what it may change against what it must reach.
struct CorrectionSettings {
  /// Price of a radial impulse against a transverse or normal one: above one keeps R components small, so that they
  /// serve where nothing else does, across the phase of the eccentricity vector.
  double radial_price = 2.0;
  /// A direction of the arrival whose gain is below this share of the strongest is left alone: closing it would cost
  /// more delta-v than it is worth and the next plan closes it for less.
  double least_gain = 0.02;
};

/// Changes of the impulses, in the sign of the effects.
struct Correction {
  std::array<Vector3, kMaxBurns> dv{};
  std::size_t count = 0;
};

/// The least-norm change of burns, with 6x3 effects E_k on the dimensionless ROE per m/s, such that sum E_k dv_k =
/// residual in all directions but the truncated ones. Rows are scaled by fixed values. kInvalidArgument without burns
/// or with more than kMaxBurns, kNotFinite, kSingular if all effects vanish, kDidNotConverge from the eigenvalue
/// iteration.
Result<Correction> least_norm_correction(std::span<const Matrix63> effects, const Vector6& residual,
                                         const CorrectionSettings& settings = {});

}  // namespace vbar::fsw::control
