#include "fsw/navigation/attitude_gate.h"

#include "fsw/math/math.h"

namespace vbar::fsw::navigation {
namespace {

using measurements::AttitudeHistory;
using measurements::AttitudeSample;

// A platform that was this close to its command at the last measurement is assumed to have the commanded attitude.
// Otherwise the gyro is more accurate.
constexpr double kCloseControl = 2e-3;  // rad

/// Returns the angle of the rotation between two attitudes, rad; accurate for small angles.
double angle_between(const Matrix3& R_eci_a, const Matrix3& R_eci_b) {
  const double squared = (R_eci_a - R_eci_b).squaredNorm();  // 8 sin^2(angle / 2)
  const double sine = math::sqrt(squared / 8.0);
  return 2.0 * math::asin(sine < 1.0 ? sine : 1.0);
}

}  // namespace

/// Propagates by the mean of the rates at both ends. Returns nothing if the interval is too long for the mean, or the
/// propagation too old.
std::optional<Matrix3> AttitudeGate::propagated_to(const AttitudeSample& sample) const {
  if (!gyro_) return std::nullopt;
  const Duration apart = sample.time < gyro_->time ? gyro_->time - sample.time : sample.time - gyro_->time;
  if (apart > AttitudeHistory::kReach || sample.time - anchored_ > kLongestPropagation) return std::nullopt;
  const Vector3 rate_body = 0.5 * (gyro_->rate_body + sample.rate_body);
  return measurements::rotated(gyro_->R_eci_body, seconds(sample.time - gyro_->time) * rate_body);
}

AttitudeGate::Verdict AttitudeGate::judge(const AttitudeSample& sample,
                                          const std::optional<Matrix3>& R_body_eci_commanded) {
  const std::optional<Matrix3> propagated = propagated_to(sample);
  const double from_command =
      R_body_eci_commanded ? angle_between(sample.R_eci_body, R_body_eci_commanded->transpose()) : 0.0;
  const double from_gyro = propagated ? angle_between(sample.R_eci_body, *propagated) : 0.0;
  const bool is_as_commanded = R_body_eci_commanded && from_command <= kLargestDifference;
  const bool is_as_propagated = propagated && from_gyro <= kLargestDifference;
  const bool has_judge = propagated || (R_body_eci_commanded && follows_commands_);
  difference_ = R_body_eci_commanded ? from_command : from_gyro;
  if (propagated && from_gyro < difference_) difference_ = from_gyro;

  is_refusing_ = has_judge && !is_as_commanded && !is_as_propagated;
  if (!is_refusing_) {
    follows_commands_ = follows_commands_ || is_as_commanded;
    control_error_ = from_command;
    gyro_ = sample;
    anchored_ = sample.time;
    return {.is_accepted = true, .used = sample};
  }
  if (!propagated) {
    gyro_.reset();
    return {};
  }
  AttitudeSample substitute = sample;
  substitute.R_eci_body = *propagated;
  gyro_ = substitute;
  const bool is_close = R_body_eci_commanded && follows_commands_ && control_error_ <= kCloseControl &&
                        angle_between(R_body_eci_commanded->transpose(), *propagated) <= kLargestDifference;
  if (is_close) substitute.R_eci_body = R_body_eci_commanded->transpose();
  return {.is_accepted = false, .used = substitute};
}

void AttitudeGate::take_stars(GpsTime time, const Matrix3& R_eci_body) {
  const AttitudeSample stars{
      .time = time, .R_eci_body = R_eci_body, .rate_body = gyro_ ? gyro_->rate_body : Vector3::Zero()};
  const std::optional<Matrix3> propagated = propagated_to(stars);
  const bool contradicts = propagated && angle_between(R_eci_body, *propagated) > kLargestDifference;
  if (!contradicts && !is_refusing_) return;
  if (gyro_ && time < gyro_->time) {
    // The propagation continues from the last sample.
    gyro_->R_eci_body = measurements::rotated(R_eci_body, seconds(gyro_->time - time) * gyro_->rate_body);
  } else {
    gyro_ = stars;
  }
  anchored_ = time;
}

}  // namespace vbar::fsw::navigation
