#include "host_sim/truth/attitude/pointing_profile.h"

#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

namespace vbar::truth {

namespace {

using fsw::Matrix3;
using fsw::Vector3;

/// Orthonormal axes in the columns: the first along `first`, the third across both, the second nearest to `second`.
Matrix3 axes_of(const Vector3& first, const Vector3& second) {
  Matrix3 axes;
  axes.col(0) = first.normalized();
  axes.col(2) = axes.col(0).cross(second).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

/// Derivative of v / |v|.
Vector3 unit_rate(const Vector3& v, const Vector3& rate) {
  const Vector3 unit = v.normalized();
  return (rate - unit * unit.dot(rate)) / v.norm();
}

}  // namespace

AttitudeState aimed_attitude(const Vector3& boresight_body, const Vector3& second_body, const MovingDirection& primary,
                             const MovingDirection& secondary) {
  const Vector3 across = primary.along.cross(secondary.along);
  // Written so that a NaN is rejected as well.
  if (!(across.norm() > kMinAngle_rad * primary.along.norm() * secondary.along.norm())) {
    throw std::domain_error("the boresight lies along the direction that should fix the rotation about it");
  }
  const Matrix3 axes_eci = axes_of(primary.along, secondary.along);
  const Matrix3 axes_body = axes_of(boresight_body, second_body);

  // Axes e1, e2, e3 that rotate at w have e1' e2 = w3, e3' e1 = w2, e3' e2 = -w1.
  const Vector3 across_rate = primary.rate.cross(secondary.along) + primary.along.cross(secondary.rate);
  const Vector3 e1_rate = unit_rate(primary.along, primary.rate);
  const Vector3 e3_rate = unit_rate(across, across_rate);
  const Vector3 rate_axes(-e3_rate.dot(axes_eci.col(1)), e3_rate.dot(axes_eci.col(0)), e1_rate.dot(axes_eci.col(1)));

  AttitudeState attitude;
  attitude.q_body_eci = Eigen::Quaterniond(Matrix3(axes_body * axes_eci.transpose())).normalized();
  attitude.rate_body = axes_body * rate_axes;
  return attitude;
}

namespace {

/// The Sun moves 2e-7 rad/s: over two minutes 2.4e-5 rad, with negligible curvature and rounding of 1e-18 rad/s.
constexpr double kSunDifference_s = 60.0;

}  // namespace

bool are_two_axes(const Vector3& a, const Vector3& b) {
  // Written so that a NaN is rejected as well.
  return a.cross(b).norm() > kMinAngle_rad * a.norm() * b.norm();
}

bool are_one_line(Direction a, Direction b) {
  const auto vertical = [](Direction d) { return d == Direction::kZenith || d == Direction::kNadir; };
  return a == b || (vertical(a) && vertical(b));
}

PointingProfile::PointingProfile(const PointingSettings& settings, MotionOfTime own, MotionOfTime other, SunOfTime sun)
    : settings_(settings), own_(std::move(own)), other_(std::move(other)), sun_(std::move(sun)) {
  if (!are_two_axes(settings.boresight_body, settings.second_body)) {
    throw std::invalid_argument("boresight and second body axis must be two different axes");
  }
  if (are_one_line(settings.boresight_to, settings.second_to)) {
    throw std::invalid_argument("boresight and second body axis must point in two different directions");
  }
  const auto needs = [&](Direction d) { return settings.boresight_to == d || settings.second_to == d; };
  if (!own_) throw std::invalid_argument("a pointing profile needs the spacecraft's orbit");
  if (needs(Direction::kSpacecraft) && !other_) throw std::invalid_argument("there is no spacecraft to point at");
  if (needs(Direction::kSun) && !sun_) throw std::invalid_argument("there is no Sun to point at");
}

AttitudeState PointingProfile::state_at(double seconds) const {
  const OrbitalMotion own = own_(seconds);
  try {
    return aimed_attitude(settings_.boresight_body, settings_.second_body,
                          direction_at(settings_.boresight_to, seconds, own),
                          direction_at(settings_.second_to, seconds, own));
  } catch (const std::domain_error& error) {
    throw std::domain_error(fmt::format("no attitude {} s after the epoch: {}", seconds, error.what()));
  }
}

MovingDirection PointingProfile::direction_at(Direction direction, double seconds, const OrbitalMotion& own) const {
  const Vector3 &r = own.position_eci, &v = own.velocity_eci, &a = own.acceleration_eci;
  switch (direction) {
    case Direction::kZenith:
      return {r, v};
    case Direction::kNadir:
      return {-r, -v};
    case Direction::kOrbitNormal:
      return {r.cross(v), r.cross(a)};
    case Direction::kAlongTrack:
      return {r.cross(v).cross(r), r.cross(a).cross(r) + r.cross(v).cross(v)};
    case Direction::kSun: {
      const Vector3 rate =
          (sun_(seconds + kSunDifference_s) - sun_(seconds - kSunDifference_s)) / (2.0 * kSunDifference_s);
      return {sun_(seconds) - r, rate - v};
    }
    case Direction::kSpacecraft: {
      const OrbitalMotion other = other_(seconds);
      return {other.position_eci - r, other.velocity_eci - v};
    }
  }
  throw std::invalid_argument("not a direction");
}

}  // namespace vbar::truth
