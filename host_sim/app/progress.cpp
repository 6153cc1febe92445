#include "host_sim/app/progress.h"

#include <fmt/core.h>
#include <unistd.h>

namespace vbar::app {

ProgressLine::ProgressLine(fsw::Duration total, bool quiet)
    : total_(total), started_(Clock::now()), drawn_(started_), on_terminal_(!quiet && isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine() {
  erase();
}

void ProgressLine::update(fsw::Duration simulated) {
  const Clock::time_point now = Clock::now();
  if (!on_terminal_ || now - drawn_ < std::chrono::milliseconds(200)) return;
  drawn_ = now;
  const double wall = std::chrono::duration<double>(now - started_).count();
  const double factor = fsw::seconds(simulated) / wall;
  const double left = factor > 0.0 ? (fsw::seconds(total_) - fsw::seconds(simulated)) / factor : 0.0;
  fmt::print(stderr, "\r\x1b[K{:6.2f} of {:.2f} h simulated   {:8.0f} x real time   {:4.0f} s left",
             fsw::seconds(simulated) / 3600.0, fsw::seconds(total_) / 3600.0, factor, left);
  std::fflush(stderr);
  visible_ = true;
}

void ProgressLine::erase() {
  if (visible_) fmt::print(stderr, "\r\x1b[K");
}

}  // namespace vbar::app
