#include "host_sim/truth/attitude/attitude_sequence.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

namespace vbar::truth {
namespace {

using Eigen::Quaterniond;
using fsw::Matrix3;
using fsw::Vector3;

Matrix3 cross_matrix(const Vector3& v) {
  Matrix3 matrix;
  matrix << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return matrix;
}

/// Right Jacobian of the rotation group: a rotation exp(p) that goes from body to reference axes rotates at J(p) p' in
/// body axes (Chirikjian 2012, eq. 10.86).
Matrix3 right_jacobian(const Vector3& p) {
  const double angle = p.norm();
  const Matrix3 cross = cross_matrix(p);
  // Below this angle the next terms of the series are below rounding.
  constexpr double kSmall = 1e-4;
  if (angle < kSmall) return Matrix3::Identity() - 0.5 * cross + cross * cross / 6.0;
  const double square = angle * angle;
  return Matrix3::Identity() - (1.0 - std::cos(angle)) / square * cross +
         (angle - std::sin(angle)) / (square * angle) * cross * cross;
}

Quaterniond rotation_of(const Vector3& p) {
  const double angle = p.norm();
  return angle > 0.0 ? Quaterniond(Eigen::AngleAxisd(angle, p / angle)) : Quaterniond::Identity();
}

}  // namespace

AttitudeState slewed_attitude(const SlewStart& start, const AttitudeState& to, double elapsed_s, double slew_s) {
  // To axes of the next motion from body axes, and the rate of the body with respect to that motion, in body axes.
  const Quaterniond q_to_body = start.to.q_body_eci * start.from.q_body_eci.conjugate();
  const Eigen::AngleAxisd rotation(q_to_body.normalized());
  const Vector3 p_start = rotation.angle() * rotation.axis();
  const Vector3 rate_start = start.from.rate_body - q_to_body.conjugate() * start.to.rate_body;
  const Vector3 p_rate_start = right_jacobian(p_start).inverse() * rate_start;

  const double s = elapsed_s / slew_s;
  const Vector3 p = (1.0 - s) * (1.0 - s) * ((1.0 + 2.0 * s) * p_start + s * slew_s * p_rate_start);
  const Vector3 p_rate = 6.0 * s * (s - 1.0) / slew_s * p_start + (1.0 - s) * (1.0 - 3.0 * s) * p_rate_start;
  const Quaterniond q_body_to = rotation_of(p).conjugate();
  AttitudeState state;
  state.q_body_eci = (q_body_to * to.q_body_eci).normalized();
  state.rate_body = q_body_to * to.rate_body + right_jacobian(p) * p_rate;
  return state;
}

AttitudeSequence::AttitudeSequence(std::unique_ptr<AttitudeMotion> first, std::vector<Later> later)
    : first_(std::move(first)), later_(std::move(later)) {
  if (!first_ || later_.empty()) throw std::invalid_argument("a sequence of attitudes needs two of them");
  for (std::size_t k = 0; k < later_.size(); ++k) {
    if (!later_[k].motion) throw std::invalid_argument("a sequence of attitudes lacks one of them");
    if (!(later_[k].slew_s > 0.0)) throw std::invalid_argument("a slew between two attitudes takes time");
    if (k > 0 && !(later_[k].from_s >= later_[k - 1].from_s + later_[k - 1].slew_s))
      throw std::invalid_argument(fmt::format(
          "the slew that begins {} s after the epoch has not ended when the next one begins", later_[k - 1].from_s));
  }
  starts_.resize(later_.size());
}

void AttitudeSequence::advance_to(double seconds, double orbit_step_end) {
  for (const Later& later : later_) later.motion->advance_to(seconds, orbit_step_end);
  if (!starts_.front()) first_->advance_to(std::min(seconds, later_.front().from_s), orbit_step_end);
  for (std::size_t k = 0; k < later_.size() && later_[k].from_s <= seconds; ++k)
    if (!starts_[k]) starts_[k] = start_of(k);
}

void AttitudeSequence::orbit_changed(double seconds) {
  if (seconds <= later_.front().from_s) first_->orbit_changed(seconds);
  for (std::size_t k = 0; k < later_.size(); ++k) {
    later_[k].motion->orbit_changed(seconds);
    if (seconds <= later_[k].from_s) starts_[k].reset();
  }
}

SlewStart AttitudeSequence::start_of(std::size_t k) const {
  const double seconds = later_[k].from_s;
  const AttitudeMotion& before = k > 0 ? *later_[k - 1].motion : *first_;
  return {before.state_at(seconds), later_[k].motion->state_at(seconds)};
}

AttitudeState AttitudeSequence::state_at(double seconds) const {
  const auto after = std::ranges::find_if(later_, [&](const Later& later) { return later.from_s > seconds; });
  if (after == later_.begin()) return first_->state_at(seconds);
  const std::size_t k = static_cast<std::size_t>(after - later_.begin()) - 1;
  const AttitudeState to = later_[k].motion->state_at(seconds);
  const double elapsed_s = seconds - later_[k].from_s;
  if (elapsed_s >= later_[k].slew_s) return to;
  return slewed_attitude(starts_[k] ? *starts_[k] : start_of(k), to, elapsed_s, later_[k].slew_s);
}

}  // namespace vbar::truth
