#include "fsw/gnc/attitude_gate.h"

#include "fsw/math/math.h"

namespace vbar::fsw::gnc {
namespace {

/// Angle of the rotation between two attitudes, rad; accurate for small ones.
double angle_between(const Matrix3& R_eci_a, const Matrix3& R_eci_b) {
  const double squared = (R_eci_a - R_eci_b).squaredNorm();  // 8 sin^2(angle / 2)
  const double sine = math::sqrt(squared / 8.0);
  return 2.0 * math::asin(sine < 1.0 ? sine : 1.0);
}

}  // namespace

bool AttitudeGate::accepts(const navigation::AttitudeSample& sample, const navigation::AttitudeHistory& history,
                           const std::optional<Matrix3>& R_body_eci_commanded) {
  const std::optional<Matrix3> propagated = history.R_eci_body_at(sample.time);
  difference_ = 0.0;
  if (R_body_eci_commanded) {
    difference_ = angle_between(sample.R_eci_body, R_body_eci_commanded->transpose());
    if (difference_ <= kLargestDifference) {
      follows_commands_ = true;
      return true;
    }
  }
  if (propagated) {
    const double from_propagated = angle_between(sample.R_eci_body, *propagated);
    if (!R_body_eci_commanded || from_propagated < difference_) difference_ = from_propagated;
    return from_propagated <= kLargestDifference;
  }
  return !(R_body_eci_commanded && follows_commands_);
}

}  // namespace vbar::fsw::gnc
