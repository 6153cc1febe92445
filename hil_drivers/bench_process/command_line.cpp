#include "hil_drivers/bench_process/command_line.h"

#include <filesystem>
#include <sstream>
#include <system_error>

#include "host_sim/files/own_program.h"
#include "host_sim/files/replaced.h"

namespace vbar::bench_process {
namespace {

/// The words that start a program.
std::vector<std::string> start_of(const std::string& name) {
  if (name.find('/') != std::string::npos) return {name};
  std::error_code ignored;
  const auto beside = files::own_program().parent_path() / name;
  return std::filesystem::exists(beside, ignored) ? files::words_that_start(beside) : std::vector{name};
}

}  // namespace

std::vector<std::string> arguments_of(const std::string& command_line, std::span<const Replacement> replacements) {
  std::vector<std::string> arguments;
  std::istringstream words(command_line);
  for (std::string word; words >> word;) {
    for (const auto& [what, by] : replacements) word = files::replaced(std::move(word), what, by);
    arguments.push_back(word);
  }
  if (arguments.empty()) return arguments;
  std::vector<std::string> started = start_of(arguments.front());
  started.insert(started.end(), arguments.begin() + 1, arguments.end());
  return started;
}

}  // namespace vbar::bench_process
