#include "host_sim/simulation/run_control.h"

#include <csignal>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

namespace vbar::app {

namespace {

volatile std::sig_atomic_t stop_flag = 0;

void on_signal(int signal) {
  stop_flag = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void catch_stop_signals() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  std::signal(SIGHUP, on_signal);
  std::signal(SIGPIPE, SIG_IGN);
}

bool stop_requested() {
  return stop_flag != 0;
}

StatusLine::StatusLine(bool quiet) : on_terminal_(!quiet && ::isatty(STDERR_FILENO) == 1) {}

StatusLine::~StatusLine() {
  if (visible_) fmt::print(stderr, "\r\x1b[K");
}

void StatusLine::draw(const std::string& text) {
  if (!on_terminal_) return;
  fmt::print(stderr, "\r\x1b[K{}", text);
  std::fflush(stderr);
  visible_ = true;
}

ProgressLine::ProgressLine(fsw::Duration total, bool quiet)
    : total_(total), started_(Clock::now()), drawn_(started_), line_(quiet) {}

void ProgressLine::update(fsw::Duration simulated) {
  const Clock::time_point now = Clock::now();
  if (!line_.is_drawn() || now - drawn_ < std::chrono::milliseconds(200)) return;
  drawn_ = now;
  const double wall = std::chrono::duration<double>(now - started_).count();
  const double factor = fsw::seconds(simulated) / wall;
  const double left = factor > 0.0 ? (fsw::seconds(total_) - fsw::seconds(simulated)) / factor : 0.0;
  line_.draw(fmt::format("{:6.2f} of {:.2f} h simulated   {:8.0f} x real time   {:4.0f} s left",
                         fsw::seconds(simulated) / 3600.0, fsw::seconds(total_) / 3600.0, factor, left));
}

}  // namespace vbar::app
