#pragma once
// Commands of schedulers.

#include <chrono>
#include <string>
#include <vector>

namespace vbar::campaign {

struct CommandResult {
  bool succeeded = false;
  std::string output;   ///< standard output and error
  std::string trouble;  ///< "squeue: exit status 1: ..."; empty if it succeeded
};

/// Runs a program, looked up in PATH, and waits for it; it is ended after the time limit.
[[nodiscard]] CommandResult run_command(const std::vector<std::string>& arguments,
                                        std::chrono::seconds limit = std::chrono::seconds(60));

/// One word of a shell's command line that stands for `text`.
[[nodiscard]] std::string shell_word(const std::string& text);

}  // namespace vbar::campaign
