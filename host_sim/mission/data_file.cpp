#include "host_sim/mission/data_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "host_sim/files/own_program.h"
#include "host_sim/mission/mission_error.h"

namespace vbar::mission {

namespace {

/// Returns the data folder of an installation, which lies beside the folder of the running program.
std::filesystem::path installed_data() {
  std::error_code error;
  const std::filesystem::path program = files::own_program();
  const std::filesystem::path folder = program.parent_path().parent_path() / "share/vbar/data";
  return !program.empty() && std::filesystem::is_directory(folder, error) ? folder : std::filesystem::path();
}

}  // namespace

std::filesystem::path data_directory() {
  const char* const chosen = std::getenv("VBAR_DATA");
  const std::filesystem::path installed = chosen == nullptr ? installed_data() : std::filesystem::path();
  const std::filesystem::path folder = chosen != nullptr ? chosen : installed.empty() ? VBAR_DATA_DIRECTORY : installed;
  if (!std::filesystem::is_directory(folder)) {
    throw std::runtime_error(folder.string() + ": no such data folder; set VBAR_DATA to the project's data folder");
  }
  return folder;
}

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kOverride = "--set ";

fs::path resolved(const TableReader& section, std::string_view key, const std::string& text, const Mission& mission) {
  if (text.empty()) section.refuse_value(key, "a file of the data folder, or one seen from the mission file (./...)");
  if (fs::path on_command_line = file_on_command_line(section, key, text); !on_command_line.empty())
    return on_command_line;
  return is_seen_from_file(text) ? fs::absolute(mission.file).parent_path() / text : fs::path(text);
}

fs::path noted(const TableReader& section, std::string_view key, const std::string& text, const Mission& mission) {
  fs::path file = resolved(section, key, text, mission);
  if (section.has(key)) section.note_data_file(key, text, file);
  return file;
}

/// Why a file cannot be read; empty if it can.
std::string reason_unreadable(const fs::path& file) {
  std::error_code error;
  if (::access(file.c_str(), R_OK) != 0) return std::strerror(errno);  // NOLINT(concurrency-mt-unsafe): while loading
  return fs::is_directory(file, error) ? std::strerror(EISDIR) : "";   // NOLINT(concurrency-mt-unsafe)
}

std::string quoted_toml(const std::string& text) {
  std::string quoted;
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return '"' + quoted + '"';
}

}  // namespace

bool is_seen_from_file(std::string_view text) {
  return text.starts_with("./") || text.starts_with("../");
}

fs::path file_on_command_line(const TableReader& section, std::string_view key, const std::string& text) {
  if (!section.where(key).starts_with(kOverride)) return {};
  std::error_code error;
  const fs::path file = fs::absolute(text, error).lexically_normal();
  return !error && fs::exists(file, error) ? file : fs::path();
}

fs::path data_file(const TableReader& section, std::string_view key, const fs::path& default_value,
                   const Mission& mission, std::span<const std::string_view> words) {
  const std::string text = section.text(key, default_value.string());
  if (std::ranges::find(words, text) != words.end()) return text;
  return noted(section, key, text, mission);
}

std::vector<fs::path> data_files(const TableReader& section, std::string_view key, const Mission& mission) {
  std::vector<fs::path> files;
  for (const std::string& text : section.texts(key)) files.push_back(noted(section, key, text, mission));
  return files;
}

void check_data_files(const Mission& mission, const fs::path& data_directory) {
  for (const NamedFile& named : mission.data_files) {
    const fs::path file = data_directory / named.file;
    const std::string reason = reason_unreadable(file);
    if (reason.empty()) continue;
    throw MissionError(
        named.where, named.key, fmt::format("\"{}\": {}: {}", named.text, file.string(), reason),
        fmt::format("a file of the data folder {}; with ./ or ../ before it one seen from the folder {} of the mission "
                    "file; an absolute path; with --set also one seen from the working directory",
                    data_directory.string(), fs::absolute(mission.file).parent_path().string()));
  }
}

std::vector<std::string> with_absolute_files(std::vector<std::string> overrides, const Mission& mission) {
  for (std::string& assignment : overrides) {
    std::vector<std::string> files;
    bool is_moved = false;
    for (const NamedFile& named : mission.data_files) {
      if (named.where != std::string(kOverride) + assignment) continue;
      const bool is_of_data_folder = named.file.is_relative();
      files.push_back(quoted_toml(is_of_data_folder ? named.text : named.file.string()));
      is_moved = is_moved || (!is_of_data_folder && !fs::path(named.text).is_absolute());
    }
    if (!is_moved) continue;
    const std::size_t value = assignment.find('=') + 1;
    const bool is_array = assignment.find_first_not_of(" \t", value) != std::string::npos &&
                          assignment[assignment.find_first_not_of(" \t", value)] == '[';
    assignment = assignment.substr(0, value) + (is_array ? fmt::format("[{}]", fmt::join(files, ", ")) : files.front());
  }
  return overrides;
}

}  // namespace vbar::mission
