#pragma once
// An Xvfb of a test on a free display number, which it finds itself; it ends with the test. It does not start over when
// its last client leaves: meanwhile it would refuse the next one.

#include <chrono>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include "host_sim/io/child_process.h"

namespace vbar::optical_stimulator {

class Xvfb {
 public:
  Xvfb(int width, int height) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    const io::FileDescriptor reading(ends[0]);
    std::vector<io::FileDescriptor> inherited;
    inherited.emplace_back(ends[1]);
    const std::string screen = std::to_string(width) + "x" + std::to_string(height) + "x24";
    process_.emplace(
        std::vector<std::string>{"Xvfb", "-displayfd", "3", "-screen", "0", screen, "-nolisten", "tcp", "-noreset"},
        std::move(inherited));
    std::string number;
    constexpr int kPatience_ms = 60'000;
    pollfd readable{reading.get(), POLLIN, 0};
    while (!number.ends_with('\n')) {
      char byte = 0;
      if (::poll(&readable, 1, kPatience_ms) != 1 || ::read(reading.get(), &byte, 1) != 1)
        throw std::runtime_error("Xvfb does not start: " + process_->output_tail());
      number += byte;
    }
    number.pop_back();
    name_ = ":" + number;
  }
  ~Xvfb() { process_->terminate(std::chrono::seconds(5)); }
  Xvfb(const Xvfb&) = delete;
  Xvfb& operator=(const Xvfb&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] pid_t pid() const { return process_->pid(); }

 private:
  std::optional<io::ChildProcess> process_;
  std::string name_;
};

}  // namespace vbar::optical_stimulator
