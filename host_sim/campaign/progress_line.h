#pragma once
// One line that says how far a campaign is: on a terminal, and silent in a pipe.

#include <chrono>
#include <string>

namespace vbar::campaign {

class ProgressLine {
 public:
  explicit ProgressLine(bool quiet);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void draw(const std::string& text);

 private:
  bool on_terminal_;
  bool visible_ = false;
};

/// Time that is left of work of which `done` of `all` took the time since the start; negative if it is unknown.
class TimeLeft {
 public:
  [[nodiscard]] double seconds(std::size_t done, std::size_t all) const;

 private:
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
};

}  // namespace vbar::campaign
