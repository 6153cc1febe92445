#pragma once
// Client of a controller that speaks Zaber's ASCII protocol, over a serial line or TCP: moves its axes. One thread.

#include <chrono>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include "hil_drivers/wire/bytes.h"
#include "hil_drivers/zaber/messages.h"
#include "host_sim/io/byte_channel.h"

namespace vbar::zaber {

struct ClientSettings {
  std::string line;  ///< serial device, or "host:port"
  unsigned baud = 115200;
  int device = 1;
  double microstep_um = 0.047625;
  double overshoot_um = 50.0;  ///< every place is approached from this far below it
  double tolerance_um = 1.0;   ///< tolerance of the place reported after a move
  std::chrono::milliseconds answer_limit{2000};
  std::chrono::milliseconds move_limit{60000};
};

/// Reports one sentence with the line, the axis and what the controller reported.
class RailError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Client {
 public:
  /// Opens the line and asks for the state. Throws RailError.
  explicit Client(const ClientSettings& settings);
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  // Axes count from 1; 0 is all of them. All throw RailError for a line that does not answer, a command that is
  // rejected and an axis with a fault (FS, FF, FD, FQ).

  /// Homes the axis if it has no reference (WR, WH), and waits.
  void home_if_needed(int axis);
  /// Moves to the place, always from below, waits and compares the place reported with the one asked for.
  void move_to_um(int axis, double um);
  [[nodiscard]] double position_um(int axis);
  /// Throws also if the axis moves, was displaced (WM), was interrupted (NI), has no reference, or is not within the
  /// tolerance of `um`.
  void check_held_at_um(int axis, double um);
  /// Stops all axes.
  void stop();

  /// Returns the reply to one command. Throws for a rejection and a fault.
  Message command(int axis, const std::string& text);

  [[nodiscard]] const std::string& line() const { return settings_.line; }

 private:
  Message wait_until_idle(int axis);
  std::string next_line(io::Clock::time_point deadline);
  [[noreturn]] void fail(int axis, const std::string& problem) const;

  ClientSettings settings_;
  std::unique_ptr<io::ByteChannel> channel_;
  wire::LineBuffer lines_;
};

/// Returns the meaning of a warning of the protocol: "stalled" for FS.
[[nodiscard]] std::string meaning_of(const std::string& warning);

}  // namespace vbar::zaber
