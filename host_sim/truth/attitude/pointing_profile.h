#pragma once
// The attitude of a pointing spacecraft: a body axis, the boresight, follows a direction without error, and the
// rotation about it keeps a second axis as close as possible to another direction. Errors of attitude control and
// knowledge are modelled elsewhere.

#include <functional>

#include "host_sim/truth/attitude/aiming.h"
#include "host_sim/truth/attitude/attitude_motion.h"

namespace vbar::truth {

/// A spacecraft's motion at one instant, GCRF.
struct OrbitalMotion {
  fsw::Vector3 position_eci = fsw::Vector3::Zero();
  fsw::Vector3 velocity_eci = fsw::Vector3::Zero();
  fsw::Vector3 acceleration_eci = fsw::Vector3::Zero();  ///< total acceleration, the point mass included
};

using MotionOfTime = std::function<OrbitalMotion(double seconds)>;

/// Geocentric direction to the Sun, m.
using SunOfTime = std::function<fsw::Vector3(double seconds)>;

/// Direction that a body axis follows.
enum class Direction {
  kZenith,       ///< away from the Earth's centre: R of RTN
  kNadir,        ///< to the Earth's centre
  kAlongTrack,   ///< T of RTN
  kOrbitNormal,  ///< N of RTN
  kSun,
  kSpacecraft,  ///< another spacecraft
};

struct PointingSettings {
  Direction boresight_to = Direction::kZenith;
  fsw::Vector3 boresight_body = fsw::Vector3::UnitZ();
  Direction second_to = Direction::kOrbitNormal;
  fsw::Vector3 second_body = fsw::Vector3::UnitY();
};

/// Returns whether two body axes (of any length) span a plane: neither zero nor parallel within kLeastAngle_rad.
[[nodiscard]] bool are_two_axes(const fsw::Vector3& a, const fsw::Vector3& b);

/// Returns whether two directions are always the same or opposite.
[[nodiscard]] bool are_one_line(Direction a, Direction b);

/// Attitude that is a pure function of the orbits: it holds no state.
class PointingProfile final : public AttitudeMotion {
 public:
  /// Makes a profile. `own` is the motion of the pointing spacecraft; `other` that of the one pointed at, and `sun`,
  /// are needed only if a direction of the settings requires them. Throws std::invalid_argument for parallel body axes,
  /// directions on one line, and for missing motions that are needed.
  PointingProfile(const PointingSettings& settings, MotionOfTime own, MotionOfTime other, SunOfTime sun);

  void advance_to(double /*seconds*/, double /*orbit_step_end*/) override {}
  void orbit_changed(double /*seconds*/) override {}

  /// Returns attitude and rate; the rate is that of the directions' own motion and exact but for the Sun's (differenced
  /// over two minutes, 1e-15 rad/s). Throws std::domain_error if the boresight lies along the second direction.
  [[nodiscard]] AttitudeState state_at(double seconds) const override;

 private:
  [[nodiscard]] MovingDirection direction_at(Direction direction, double seconds, const OrbitalMotion& own) const;

  PointingSettings settings_;
  MotionOfTime own_;
  MotionOfTime other_;
  SunOfTime sun_;
};

/// A constant inertial attitude.
class InertialAttitude final : public AttitudeMotion {
 public:
  explicit InertialAttitude(const Eigen::Quaterniond& q_body_eci)
      : attitude_{q_body_eci.normalized(), fsw::Vector3::Zero()} {}

  void advance_to(double /*seconds*/, double /*orbit_step_end*/) override {}
  void orbit_changed(double /*seconds*/) override {}
  [[nodiscard]] AttitudeState state_at(double /*seconds*/) const override { return attitude_; }

 private:
  AttitudeState attitude_;
};

}  // namespace vbar::truth
