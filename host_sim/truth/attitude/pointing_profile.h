#pragma once
// Attitude from two directions: a primary one, which a body axis follows, and a secondary one, which fixes the rotation
// about that axis; and the angular rate, from the rates of the directions: exact, without finite differences.

#include <functional>

#include "fsw/core/types.h"
#include "host_sim/truth/attitude/attitude_motion.h"

namespace vbar::truth {

/// A direction in ECI and its time derivative. Need not be a unit vector; any unit of length.
struct MovingDirection {
  fsw::Vector3 along = fsw::Vector3::Zero();
  fsw::Vector3 rate = fsw::Vector3::Zero();
};

/// Aligns body axis `boresight_body` exactly with `primary` and, with the remaining freedom, `second_body` as closely
/// as possible with `secondary` (both body axes of any length, not parallel). Within kMinAngle_rad of parallel or
/// antiparallel the secondary does not fix the rotation about the boresight: throws std::domain_error, as it does for
/// directions that are zero or not finite. Towards that limit the rate about the boresight grows as 1 / angle.
AttitudeState aimed_attitude(const fsw::Vector3& boresight_body, const fsw::Vector3& second_body,
                             const MovingDirection& primary, const MovingDirection& secondary);

/// An arcsecond: the triad's third axis then still has ten correct digits.
inline constexpr double kMinAngle_rad = 5e-6;

// The attitude of a pointing spacecraft: a body axis, the boresight, follows a direction without error, and the
// rotation about it keeps a second axis as close as possible to another direction. Errors of attitude control and
// knowledge are modelled elsewhere.

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

/// Returns whether two body axes (of any length) span a plane: neither zero nor parallel within kMinAngle_rad.
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
