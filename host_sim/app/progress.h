#pragma once
// One line that says how far a run is: on a terminal, and silent in a pipe.

#include <chrono>

#include "fsw/core/gps_time.h"

namespace vbar::app {

class ProgressLine {
 public:
  /// Draws the line of a run that simulates `total`; `quiet` draws nothing.
  ProgressLine(fsw::Duration total, bool quiet);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Redraws the line at most five times a second.
  void update(fsw::Duration simulated);

 private:
  using Clock = std::chrono::steady_clock;
  void erase();

  fsw::Duration total_;
  Clock::time_point started_;
  Clock::time_point drawn_;
  bool on_terminal_;
  bool visible_ = false;
};

}  // namespace vbar::app
