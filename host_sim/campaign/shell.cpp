#include "host_sim/campaign/shell.h"

#include <system_error>

#include <fmt/format.h>

#include "host_sim/io/child_process.h"

namespace vbar::campaign {

CommandResult run_command(const std::vector<std::string>& arguments, std::chrono::seconds limit) {
  constexpr std::size_t kMaxOutput = 1 << 20;
  try {
    io::ChildProcess child(arguments, {});
    child.keep_processes_left_behind();  // workers that a submission starts in the background
    const bool has_ended = child.wait_for_end(limit);
    if (!has_ended) child.terminate(std::chrono::milliseconds(0));
    CommandResult result{has_ended && child.exit_status() == 0, child.output_tail(kMaxOutput), {}};
    if (!result.succeeded)
      result.trouble =
          fmt::format("{}: {}: {}", arguments.front(),
                      has_ended ? child.status_text() : fmt::format("no answer in {} s", limit.count()), result.output);
    return result;
  } catch (const std::system_error& error) {
    return {false, {}, error.what()};
  }
}

std::string shell_word(const std::string& text) {
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

}  // namespace vbar::campaign
