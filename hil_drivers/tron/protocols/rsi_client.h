#pragma once
// The computer's end of RSI for one robot: receives the state of a cycle and answers it. It never generates an IPOC,
// and a command is answered only if it is within the limits of speed, acceleration and range. One thread; no wall clock
// but the time-out of a datagram that never comes.
//
//   receive() -> first state: zero of the corrections -> answer() -> receive() -> answer() -> ...
//
// A caller that does not move answers with last_command().

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>

#include <Eigen/Core>

#include "hil_drivers/tron/geometry/testbed_design.h"
#include "hil_drivers/tron/protocols/rsi_messages.h"

namespace vbar::tron::rsi {

// Places of the axes of one robot, and their values on the wire.

using AxisVector = Eigen::Matrix<double, 6, 1>;

inline constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;
inline constexpr double kMillimetresPerMetre = 1000.0;

/// Holds the axes of one robot: A1 to A6 in rad, and E1, the carriage from its home, in m (0 for a robot without a
/// track).
struct AxisPositions {
  AxisVector axes_rad = AxisVector::Zero();
  double track_m = 0.0;
};

inline SixValues to_degrees(const AxisVector& axes_rad) {
  SixValues axes_deg{};
  for (std::size_t k = 0; k < kWireAxes; ++k) axes_deg[k] = axes_rad[static_cast<int>(k)] * kDegreesPerRadian;
  return axes_deg;
}

inline AxisVector to_radians(const SixValues& axes_deg) {
  AxisVector axes_rad;
  for (std::size_t k = 0; k < kWireAxes; ++k) axes_rad[static_cast<int>(k)] = axes_deg[k] / kDegreesPerRadian;
  return axes_rad;
}

// Check of a command to the axes against the limits of one cycle.

/// Holds the limits of one axis of a command.
struct CommandLimits {
  double lower = 0.0, upper = 0.0;  ///< rad (m from home)
  double speed = 0.0;               ///< rad/s (m/s)
  double acceleration = 0.0;        ///< rad/s2 (m/s2)
  CorrectionRange correction;       ///< deg (mm), of the context
};

class CommandCheck {
 public:
  CommandCheck(const std::array<CommandLimits, kWireAxes>& axes, const std::optional<CommandLimits>& track)
      : axes_(axes), track_(track) {}

  /// Starts at rest at `zero`, from which corrections count.
  void begin(const AxisPositions& zero);
  /// Accepts the command as that of the next cycle. A rejected one is ignored, and the result is one sentence with
  /// axis, value and limit.
  [[nodiscard]] std::string advance(const AxisPositions& command);

  [[nodiscard]] const AxisPositions& zero() const { return zero_; }
  [[nodiscard]] const AxisPositions& last() const { return last_; }

 private:
  std::array<CommandLimits, kWireAxes> axes_;
  std::optional<CommandLimits> track_;
  AxisPositions zero_, last_, before_last_;
};

struct State {
  AxisPositions measured;       ///< AIPos, EIPos
  std::uint64_t cycle = 0;      ///< number of states before this one since restart()
  std::uint64_t delay = 0;      ///< as counted by the controller since RSI_ON
  int delayed_in_row = 0;       ///< successive states in which that count has grown
  std::uint64_t skipped = 0;    ///< older states that had arrived as well and were not answered, since restart()
  bool ipoc_not_newer = false;  ///< its time stamp is not later than that of the state before: it has jumped back
};

struct ClientSettings {
  std::string name;           ///< name of the device in messages: "camera robot"
  std::string robot_address;  ///< datagrams from other addresses are foreign
  std::uint16_t port = 0;     ///< UDP port of this computer; 0: any free one
  EthernetXml ethernet;
  std::array<CommandLimits, kWireAxes> axes{};
  std::optional<CommandLimits> track;  ///< limits of the track that carries the robot
};

/// Returns address, port and limits of a robot of the testbed (full speed and acceleration of its design, not the
/// override). `track`: set for the robot that rides on it, by default nullptr.
[[nodiscard]] ClientSettings client_settings(const std::string& name, const Robot& robot, const Track* track,
                                             const RobotFiles& files);

/// Reports a command that would exceed a limit: a defect of the caller. One sentence with device, axis, value and
/// limit.
class CommandRefused : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reports that the socket cannot be used, or a call out of order.
class RsiError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Client {
 public:
  /// Listens. Throws RsiError.
  explicit Client(const ClientSettings& settings);
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// Waits for the next state of the robot; the newest if several have arrived. Nothing: the robot was silent for
  /// `patience` of wall clock. Foreign and unreadable datagrams are counted and ignored. Throws RsiError.
  [[nodiscard]] std::optional<State> receive(std::chrono::milliseconds patience);

  /// Answers the last state received, once: `command` is where the axes shall be, absolute. Speed and acceleration are
  /// checked against the commands before, one cycle each. Throws CommandRefused, and nothing is sent; RsiError if there
  /// is no state to answer.
  void answer(const AxisPositions& command);
  /// Answers with the last command and the stop signal, which ends the motion at the controller. Throws RsiError.
  void answer_stop();

  /// Restarts after RSI was stopped and before it is started: discards what has arrived; the next state is a first one.
  void restart();

  /// Returns the place of the robot at the first state since restart(); corrections count from there.
  [[nodiscard]] const AxisPositions& zero() const;
  /// Returns the command that was answered last; zero() before the first answer.
  [[nodiscard]] const AxisPositions& last_command() const;

  [[nodiscard]] std::uint16_t port() const;
  /// Returns the name for messages: "camera robot at RSI port 59152".
  [[nodiscard]] const std::string& description() const;
  [[nodiscard]] std::uint64_t foreign_datagrams() const;
  [[nodiscard]] std::uint64_t unreadable_datagrams() const;
  /// Returns the reason why the last unreadable datagram was ignored; empty: there was none.
  [[nodiscard]] const std::string& last_problem() const;
  [[nodiscard]] const ClientSettings& settings() const;

 private:
  struct Line;
  std::unique_ptr<Line> line_;
};

}  // namespace vbar::tron::rsi
