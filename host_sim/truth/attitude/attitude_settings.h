#pragma once
// The attitude of a spacecraft as the mission file specifies it, in SI units, after all random draws.

#include <string>
#include <variant>
#include <vector>

#include "host_sim/truth/attitude/attitude_motion.h"
#include "host_sim/truth/attitude/commanded_attitude.h"
#include "host_sim/truth/attitude/pointing_profile.h"
#include "host_sim/truth/attitude/torques.h"

namespace vbar::truth {

enum class TorqueKind { kGravityGradient, kAerodynamic, kRadiation };

/// A rigid body, torque-free or under torques.
struct TumbleSettings {
  Body body;
  std::vector<TorqueKind> torques;
  double drag_coefficient = 0.0;  ///< coefficient of the facets, for the aerodynamic torque
  AttitudeState start;
};

/// A body with a constant inertial attitude.
struct InertialSettings {
  Eigen::Quaterniond q_body_eci = Eigen::Quaterniond::Identity();
};

/// A body that follows a pointing profile.
struct PointedSettings {
  PointingSettings pointing;
  std::string spacecraft;  ///< pointed at, if a direction of `pointing` is kSpacecraft
};

/// A body that follows pointing commands.
struct CommandedSettings {
  CommandedAxes axes;
  ControlError control_error{};
};

using AttitudeSettings = std::variant<TumbleSettings, InertialSettings, PointedSettings, CommandedSettings>;

/// The attitude from `from_s` (s after the truth model's epoch) on, reached after a slew of `slew_s`
/// (attitude_sequence.h). A pointing profile must not point at a spacecraft.
struct LaterAttitudeSettings {
  double from_s = 0.0;
  double slew_s = 0.0;
  std::variant<InertialSettings, PointedSettings> attitude;
};

}  // namespace vbar::truth
