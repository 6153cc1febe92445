#include "host_sim/campaign/progress_line.h"

#include <cstdio>

#include <fmt/core.h>
#include <unistd.h>

namespace vbar::campaign {

ProgressLine::ProgressLine(bool quiet) : on_terminal_(!quiet && ::isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine() {
  if (visible_) fmt::print(stderr, "\r\x1b[K");
}

void ProgressLine::draw(const std::string& text) {
  if (!on_terminal_) return;
  fmt::print(stderr, "\r\x1b[K{}", text);
  std::fflush(stderr);
  visible_ = true;
}

double TimeLeft::seconds(std::size_t done, std::size_t all) const {
  if (done == 0) return -1.0;
  const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
  return elapsed_s / static_cast<double>(done) * static_cast<double>(all - done);
}

}  // namespace vbar::campaign
