#pragma once
// The attitude of a spacecraft whose flight software commands the boresight: a direction in the spacecraft's own
// RTN, moving there along a straight line, with a second body axis kept as close as possible to the zenith and a small
// control error about all three axes. A new command takes effect at once: between two commands the attitude may jump,
// as that of a real platform would not; the flight software has to command what a platform could follow.

#include <array>
#include <vector>

#include "host_sim/truth/attitude/attitude_motion.h"
#include "host_sim/truth/attitude/pointing_profile.h"

namespace vbar::truth {

struct Sinusoid {
  double amplitude = 0.0;   ///< rad
  double rate_radps = 0.0;  ///< rate of its argument
  double phase = 0.0;       ///< at the epoch
};

/// Control error: a rotation vector in body axes, each component a sum of sinusoids of time.
using ControlError = std::array<std::array<Sinusoid, 5>, 3>;

struct CommandedAxes {
  fsw::Vector3 initial_boresight_rtn = -fsw::Vector3::UnitY();  ///< until the first command
  fsw::Vector3 boresight_body = fsw::Vector3::UnitZ();
  fsw::Vector3 second_body = -fsw::Vector3::UnitY();  ///< as close as possible to the zenith
};

/// Commanded motion of the boresight from a time on.
struct PointingCommand {
  double seconds = 0.0;                                    ///< after the epoch
  fsw::Vector3 boresight_rtn = fsw::Vector3::Zero();       ///< unit vector
  fsw::Vector3 boresight_rate_rtn = fsw::Vector3::Zero();  ///< 1/s, as seen in RTN
};

/// The line of a command is followed for this time; then the boresight stays at its end.
inline constexpr double kLongestLine_s = 600.0;

/// Returns whether a line that begins at `boresight_rtn` (any length) and goes on by `rate_rtn` stays for
/// kLongestLine_s half a degree away from zenith and nadir, where the second axis is undefined. False for input that is
/// zero or not finite.
[[nodiscard]] bool leaves_zenith_clear(const fsw::Vector3& boresight_rtn, const fsw::Vector3& rate_rtn);

/// Attitude that is a pure function of the orbit and the commands.
class CommandedAttitude final : public AttitudeMotion {
 public:
  /// Throws std::invalid_argument for parallel axes, or an initial boresight at the zenith or nadir.
  CommandedAttitude(const CommandedAxes& axes, const ControlError& control_error, MotionOfTime own);

  /// Follows a command from its time on; replaces commands for that time and later. False, and nothing has changed, for
  /// one that comes near the zenith or is not finite (leaves_zenith_clear). Attitudes already returned do not change:
  /// the caller ensures that the time is not in the past.
  bool take(const PointingCommand& command);

  void advance_to(double /*seconds*/, double /*orbit_step_end*/) override {}
  void orbit_changed(double /*seconds*/) override {}

  /// Returns attitude and rates, which are exact: those of the RTN frame with the true forces, of the command and of
  /// the control error.
  [[nodiscard]] AttitudeState state_at(double seconds) const override;

 private:
  CommandedAxes axes_;
  ControlError control_error_;
  MotionOfTime own_;
  std::vector<PointingCommand> commands_;  ///< in order of time; the first holds from the beginning
};

}  // namespace vbar::truth
