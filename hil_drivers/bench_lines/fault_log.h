#pragma once
// Faults of an emulator that have taken effect, one line of JSON each.

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

namespace vbar::bench_lines {

/// Receives the line of a fault that has taken effect.
using Acknowledge = std::function<void(const std::string& line)>;

class FaultLog {
 public:
  /// Opens the file. Throws std::runtime_error if it cannot be made.
  explicit FaultLog(const std::filesystem::path& file);

  /// Writes the line at once, since the program may be killed, then calls `acknowledge`, if there is one.
  void write(const std::string& line, const Acknowledge& acknowledge);

 private:
  std::ofstream file_;
};

}  // namespace vbar::bench_lines
