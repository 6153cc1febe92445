#pragma once
// Ctrl-C ends a run between two steps, so that its folder is left whole and says that it is incomplete.

#include <chrono>
#include <string>

#include "fsw/core/gps_time.h"

namespace vbar::app {

/// From now on SIGINT, SIGTERM and SIGHUP only set a flag; a second one ends the program. A reader of standard output
/// that goes away does not end the program.
void catch_stop_signals();

[[nodiscard]] bool stop_requested();

// One line that says how far a run is: on a terminal, and silent in a pipe.

/// A line of text on a terminal, which each text replaces and the end erases.
class StatusLine {
 public:
  explicit StatusLine(bool quiet);
  ~StatusLine();
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  /// Returns whether anything is drawn: not in a pipe, nor if it is quiet.
  [[nodiscard]] bool is_drawn() const { return on_terminal_; }
  void draw(const std::string& text);

 private:
  bool on_terminal_;
  bool visible_ = false;
};

class ProgressLine {
 public:
  /// Draws the line of a run that simulates `total`; `quiet` draws nothing.
  ProgressLine(fsw::Duration total, bool quiet);

  /// Redraws the line at most five times a second.
  void update(fsw::Duration simulated);

 private:
  using Clock = std::chrono::steady_clock;

  fsw::Duration total_;
  Clock::time_point started_;
  Clock::time_point drawn_;
  StatusLine line_;
};

}  // namespace vbar::app
