#pragma once
// How the attitude of a spacecraft comes about: what a mission file says of it, in SI units, nothing left to draw.

#include <string>
#include <variant>
#include <vector>

#include "host_sim/truth/attitude/attitude_state.h"
#include "host_sim/truth/attitude/body.h"
#include "host_sim/truth/attitude/commanded_attitude.h"
#include "host_sim/truth/attitude/pointing_profile.h"

namespace vbar::truth {

enum class TorqueKind { kGravityGradient, kAerodynamic, kRadiation };

/// A rigid body left to itself (torque-free) or to torques.
struct TumbleSettings {
  Body body;
  std::vector<TorqueKind> torques;
  double drag_coefficient = 0.0;  ///< of the facets, for the aerodynamic torque
  AttitudeState start;
};

/// A body that keeps still among the stars.
struct InertialSettings {
  Eigen::Quaterniond q_body_eci = Eigen::Quaterniond::Identity();
};

/// A body that points.
struct PointedSettings {
  PointingSettings pointing;
  std::string spacecraft;  ///< pointed at, if a direction of `pointing` is kSpacecraft
};

/// A body that points where it is told.
struct CommandedSettings {
  CommandedAxes axes;
  ControlError control_error{};
};

using AttitudeSettings = std::variant<TumbleSettings, InertialSettings, PointedSettings, CommandedSettings>;

}  // namespace vbar::truth
