#include "host_sim/campaign/attempts.h"

#include "host_sim/campaign/folder.h"

namespace vbar::campaign {
namespace {

void add(const Json& line, std::map<std::string, std::size_t>& open, AllAttempts& all) {
  const auto number = line.at("case").get<std::size_t>();
  const auto attempt = line.at("attempt").get<std::string>();
  Attempts& attempts = all.of_case[number];
  if (!line.contains("end")) {
    ++attempts.begun;
    open[attempt] = number;
    return;
  }
  open.erase(attempt);
  attempts.last_end = line.at("end").get<std::string>();
  if (line.at("kill").get<bool>()) ++attempts.killed;
}

}  // namespace

AllAttempts read_attempts(const std::filesystem::path& attempt_files) {
  AllAttempts all;
  for (const std::filesystem::path& file : record_files(attempt_files)) {
    const bool lives = is_being_written(file);
    if (lives) all.living_workers.push_back(file.stem().string());
    std::map<std::string, std::size_t> open;
    for (const Json& line : read_lines_of(file).lines) {
      try {
        add(line, open, all);
      } catch (const Json::exception&) {
        continue;  // counts nothing; the results decide
      }
    }
    if (!lives) continue;
    for (const auto& [attempt, number] : open) all.of_case[number].flies = true;
  }
  return all;
}

Json begin_line(std::size_t number, const std::string& attempt, const std::string& host, std::int64_t process) {
  return {{"case", number}, {"attempt", attempt}, {"host", host}, {"process", process}};
}

Json end_line(std::size_t number, const std::string& attempt, const std::string& end, bool is_kill) {
  return {{"case", number}, {"attempt", attempt}, {"end", end}, {"kill", is_kill}};
}

}  // namespace vbar::campaign
