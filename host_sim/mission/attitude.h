#pragma once
// The attitude of a spacecraft in a mission file, with the draws by the seed.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <Eigen/Geometry>

#include "fsw/core/types.h"
#include "host_sim/truth/attitude/attitude_settings.h"

namespace vbar::mission {

/// profile = "tumble": a rigid body, from the start of the run on.
struct Tumble {
  std::optional<Eigen::Quaterniond> q_body_eci;  ///< at the start; default: drawn
  std::optional<fsw::Vector3> rate_body;         ///< at the start, rad/s; default: drawn between the next two
  double slowest_radps = 0.0;
  double fastest_radps = 0.0;
  std::string body;                          ///< names its file in data/bodies
  std::optional<fsw::Matrix3> inertia_kgm2;  ///< replaces that of the file
  std::vector<truth::TorqueKind> torques;
};

/// profile = "inertial".
struct Inertial {
  std::optional<Eigen::Quaterniond> q_body_eci;  ///< default: drawn
};

/// profile = "commanded": the flight software commands the boresight.
struct Commanded {
  truth::CommandedAxes axes;
  double control_error = 0.0;  ///< rad, 1 sigma of each axis over time
};

/// Any profile; the pointing profiles need no draws.
using Attitude = std::variant<Tumble, Inertial, truth::PointedSettings, Commanded>;

/// An element of attitude.then: the profile that replaces the one before.
struct LaterAttitude {
  double from_s = 0.0;  ///< after the epoch of the mission
  double slew_s = 0.0;  ///< from the attitude and rate before to the profile
  std::variant<Inertial, truth::PointedSettings> profile;
};

/// Returns an attitude drawn for a spacecraft: uniform over all rotations.
[[nodiscard]] Eigen::Quaterniond drawn_attitude(std::uint64_t seed, std::string_view spacecraft);

/// Returns a rate in body axes, rad/s: about an axis uniform on the sphere, its size uniform from `slowest` to
/// `fastest`.
[[nodiscard]] fsw::Vector3 drawn_rate(std::uint64_t seed, std::string_view spacecraft, double slowest, double fastest);

/// Returns the attitude control error, each body axis independently: five sinusoids with periods of 20 to 600 s and
/// phases drawn by the seed, of equal amplitude, so that the root mean square over a long time is `sigma` (rad).
[[nodiscard]] truth::ControlError drawn_control_error(std::uint64_t seed, std::string_view spacecraft, double sigma);

/// Returns the true minus nominal mass of a spacecraft, kg: normal with `sigma_kg`.
[[nodiscard]] double drawn_mass_error_kg(std::uint64_t seed, std::string_view spacecraft, double sigma_kg);

/// Returns the attitude at the start of the run, drawn where the file does not specify it.
[[nodiscard]] truth::AttitudeState start_of(const Tumble& tumble, std::uint64_t seed, std::string_view spacecraft);

}  // namespace vbar::mission
