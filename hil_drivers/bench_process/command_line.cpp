#include "hil_drivers/bench_process/command_line.h"

#include <filesystem>
#include <sstream>
#include <system_error>

#include "host_sim/files/replaced.h"

namespace vbar::bench_process {
namespace {

std::string program_path(const std::string& name) {
  if (name.find('/') != std::string::npos) return name;
  std::error_code ignored;
  const auto beside = std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path() / name;
  return std::filesystem::exists(beside, ignored) ? beside.string() : name;
}

}  // namespace

std::vector<std::string> arguments_of(const std::string& command_line, std::span<const Replacement> replacements) {
  std::vector<std::string> arguments;
  std::istringstream words(command_line);
  for (std::string word; words >> word;) {
    for (const auto& [what, by] : replacements) word = files::replaced(std::move(word), what, by);
    arguments.push_back(word);
  }
  if (!arguments.empty()) arguments.front() = program_path(arguments.front());
  return arguments;
}

}  // namespace vbar::bench_process
