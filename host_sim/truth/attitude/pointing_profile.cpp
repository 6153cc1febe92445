#include "host_sim/truth/attitude/pointing_profile.h"

#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

namespace vbar::truth {
namespace {

using fsw::Vector3;

/// The Sun moves 2e-7 rad/s: over two minutes 2.4e-5 rad, with negligible curvature and rounding of 1e-18 rad/s.
constexpr double kSunDifference_s = 60.0;

}  // namespace

bool are_two_axes(const Vector3& a, const Vector3& b) {
  // Written so that a NaN is rejected as well.
  return a.cross(b).norm() > kLeastAngle_rad * a.norm() * b.norm();
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
