#include "host_sim/truth/attitude/commanded_attitude.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>

#include "host_sim/truth/attitude/pointing_profile.h"

namespace vbar::truth {
namespace {

using fsw::Matrix3;
using fsw::Vector3;

constexpr double kZenithClearance_rad = 0.0087;  // half a degree

/// A direction given in RTN, and its rate there, in ECI. The frame rotates at (r f_N / h, 0, h / r^2): the acceleration
/// across the plane tilts it about the position, the other component is the motion along the orbit.
MovingDirection in_eci(const OrbitalMotion& own, const Vector3& along_rtn, const Vector3& rate_rtn) {
  const Vector3& position = own.position_eci;
  const Vector3 momentum = position.cross(own.velocity_eci);
  const double r = position.norm(), h = momentum.norm();
  Matrix3 R_eci_rtn;
  R_eci_rtn.col(0) = position / r;
  R_eci_rtn.col(2) = momentum / h;
  R_eci_rtn.col(1) = R_eci_rtn.col(2).cross(R_eci_rtn.col(0));
  const Vector3 frame_rate_rtn(r * own.acceleration_eci.dot(R_eci_rtn.col(2)) / h, 0.0, h / (r * r));
  return {R_eci_rtn * along_rtn, R_eci_rtn * (rate_rtn + frame_rate_rtn.cross(along_rtn))};
}

/// A rotation vector and its time derivative.
struct Turn {
  Vector3 angle = Vector3::Zero();
  Vector3 rate = Vector3::Zero();
};

Turn turn_of(const ControlError& error, double seconds) {
  Turn turn;
  for (std::size_t axis = 0; axis < error.size(); ++axis) {
    const auto place = static_cast<Eigen::Index>(axis);
    for (const Sinusoid& one : error[axis]) {
      const double argument = one.rate_radps * seconds + one.phase;
      turn.angle(place) += one.amplitude * std::sin(argument);
      turn.rate(place) += one.amplitude * one.rate_radps * std::cos(argument);
    }
  }
  return turn;
}

/// `commanded`, with the body rotated further by `turn` in its own axes. The body's rate against the commanded one is
/// J(angle) rate with the right Jacobian of the rotation group (Chirikjian 2011, section 10.6), here to second order:
/// the third is below 1e-16 of the rate for errors of some arc minutes.
AttitudeState turned(const AttitudeState& commanded, const Turn& turn) {
  const double angle = turn.angle.norm();
  if (!(angle > 0.0)) return {commanded.q_body_eci, commanded.rate_body + turn.rate};
  const Eigen::Quaterniond q_body_commanded(Eigen::AngleAxisd(-angle, turn.angle / angle));
  const Vector3 first = turn.angle.cross(turn.rate), second = turn.angle.cross(first);
  return {(q_body_commanded * commanded.q_body_eci).normalized(),
          q_body_commanded * commanded.rate_body + turn.rate - 0.5 * first + second / 6.0};
}

}  // namespace

bool leaves_zenith_clear(const Vector3& boresight_rtn, const Vector3& rate_rtn) {
  if (!boresight_rtn.allFinite() || !rate_rtn.allFinite() || !(boresight_rtn.norm() > 0.0)) return false;
  // The tangent of the angle to that line is |across| / |R|; along a straight line its square has one minimum or
  // maximum at most, where across . (across' R - across R') = 0. That and the ends are looked at.
  const auto is_clear = [&](double seconds) {
    const Vector3 v = boresight_rtn + seconds * rate_rtn;
    return std::hypot(v.y(), v.z()) > kZenithClearance_rad * v.norm();
  };
  const Eigen::Vector2d across = boresight_rtn.tail<2>(), across_rate = rate_rtn.tail<2>();
  const Eigen::Vector2d turn = across_rate * boresight_rtn.x() - across * rate_rtn.x();
  const double extreme_s = -across.dot(turn) / across_rate.dot(turn);
  const bool is_inside = extreme_s > 0.0 && extreme_s < kLongestLine_s;  // false for a NaN
  return is_clear(0.0) && is_clear(kLongestLine_s) && (!is_inside || is_clear(extreme_s));
}

CommandedAttitude::CommandedAttitude(const CommandedAxes& axes, const ControlError& control_error, MotionOfTime own)
    : axes_(axes), control_error_(control_error), own_(std::move(own)) {
  if (!own_) throw std::invalid_argument("a commanded attitude needs the spacecraft's orbit");
  if (!are_two_axes(axes.boresight_body, axes.second_body))
    throw std::invalid_argument("boresight and second body axis must be two different axes");
  if (!leaves_zenith_clear(axes.initial_boresight_rtn, Vector3::Zero()))
    throw std::invalid_argument("the initial boresight must not lie at the zenith or the nadir");
  commands_.push_back({-std::numeric_limits<double>::infinity(), axes.initial_boresight_rtn, Vector3::Zero()});
}

bool CommandedAttitude::take(const PointingCommand& command) {
  if (!std::isfinite(command.seconds) || !leaves_zenith_clear(command.boresight_rtn, command.boresight_rate_rtn))
    return false;
  while (commands_.size() > 1 && commands_.back().seconds >= command.seconds) commands_.pop_back();
  commands_.push_back(command);
  return true;
}

AttitudeState CommandedAttitude::state_at(double seconds) const {
  const auto after = std::ranges::upper_bound(commands_, seconds, {}, &PointingCommand::seconds);
  const PointingCommand& command = *std::prev(after);
  const double age_s = seconds - command.seconds;
  const bool moves = age_s <= kLongestLine_s;
  const Vector3 rate_rtn = moves ? command.boresight_rate_rtn : Vector3::Zero();
  // The age of the first command is unbounded; its rate is zero.
  const Vector3 along_rtn = command.boresight_rtn + std::min(age_s, kLongestLine_s) * command.boresight_rate_rtn;
  const OrbitalMotion own = own_(seconds);
  const AttitudeState commanded = aimed_attitude(
      axes_.boresight_body, axes_.second_body, in_eci(own, along_rtn, rate_rtn), {own.position_eci, own.velocity_eci});
  return turned(commanded, turn_of(control_error_, seconds));
}

}  // namespace vbar::truth
