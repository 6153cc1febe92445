#pragma once
// Makes the attitude of one spacecraft from its settings and from what surrounds it.

#include <functional>
#include <memory>

#include "host_sim/truth/attitude/aerodynamic_torque.h"
#include "host_sim/truth/attitude/attitude_motion.h"
#include "host_sim/truth/attitude/attitude_settings.h"
#include "host_sim/truth/attitude/radiation_torque.h"
#include "host_sim/truth/attitude/rigid_body.h"

namespace vbar::truth {

/// Inputs of the attitude models. Those that the settings of a spacecraft do not require may be empty.
struct AttitudeSurroundings {
  double gm = 0.0;         ///< gravitational parameter of the Earth, m^3/s^2
  double tolerance = 0.0;  ///< tolerance of the integration (RigidBody)
  double seconds = 0.0;    ///< now
  RigidBody::OrbitOfTime orbit;
  std::unique_ptr<Air> air;
  std::unique_ptr<Sunlight> sunlight;
  MotionOfTime own;
  MotionOfTime other;  ///< motion of the spacecraft pointed at
  SunOfTime sun;
};

/// Throws std::invalid_argument for inconsistent settings, and for settings that require what the surroundings lack.
[[nodiscard]] std::unique_ptr<AttitudeMotion> make_attitude(const AttitudeSettings& settings,
                                                            AttitudeSurroundings surroundings);

}  // namespace vbar::truth
