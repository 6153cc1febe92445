#include "host_sim/files/own_program.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <system_error>

#include <fmt/format.h>
#include <sys/auxv.h>
#include <unistd.h>

namespace vbar::files {
namespace {

namespace fs = std::filesystem;

constexpr const char* kStarted = "/proc/self/exe";

/// A program that the kernel starts has a loader at this address; a loader that is started itself has none.
bool was_started_by_loader() {
  return getauxval(AT_BASE) == 0;
}

/// The file that the kernel has mapped at an address of this program, by /proc/self/maps: "begin-end rights offset
/// device inode path".
fs::path mapped_file(std::uintptr_t address) {
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    std::uintptr_t begin = 0, end = 0;
    const char* const last = line.data() + line.size();
    const auto first = std::from_chars(line.data(), last, begin, 16);
    if (first.ec != std::errc() || first.ptr == last) continue;
    if (std::from_chars(first.ptr + 1, last, end, 16).ec != std::errc()) continue;
    const std::size_t path = line.find('/');
    if (address >= begin && address < end && path != std::string::npos) return line.substr(path);
  }
  return {};
}

}  // namespace

fs::path own_program() {
  if (was_started_by_loader()) return mapped_file(reinterpret_cast<std::uintptr_t>(&own_program));
  std::error_code ignored;
  return fs::read_symlink(kStarted, ignored);
}

fs::path own_program_bytes() {
  return was_started_by_loader() ? own_program() : fs::path(kStarted);
}

fs::path program_beside(std::string_view name) {
  const bool is_name = std::ranges::all_of(name, [](char c) { return (c >= 'a' && c <= 'z') || c == '_'; });
  const fs::path own = own_program();
  if (!is_name || own.empty()) return {};
  fs::path other = own.parent_path() / fmt::format("vbar_{}", name);
  std::error_code ignored;
  return ::access(other.c_str(), X_OK) == 0 && !fs::equivalent(own, other, ignored) ? other : fs::path();
}

std::vector<std::string> words_that_start(const fs::path& program) {
  if (!was_started_by_loader()) return {program.string()};
  std::error_code ignored;
  const fs::path loader = fs::read_symlink(kStarted, ignored);
  return {loader.string(), "--library-path", loader.parent_path().string(), program.string()};
}

std::string become(const fs::path& program, std::vector<std::string> arguments) {
  std::vector<std::string> words = words_that_start(program);
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  ::execv(argv.front(), argv.data());
  return fmt::format("{} cannot be run: {}", program.string(), std::generic_category().message(errno));
}

}  // namespace vbar::files
