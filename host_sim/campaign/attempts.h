#pragma once
// Flights that were started: the case, the worker, and whether it was killed.

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "host_sim/campaign/record_file.h"

namespace vbar::campaign {

/// Flights of one case.
struct Attempts {
  std::size_t begun = 0;
  std::size_t killed = 0;  ///< by a signal, while its worker lived
  bool flies = false;      ///< the last one has no end, and its worker lives
  std::string last_end;    ///< "killed by signal 9 (Killed)"
};

struct AllAttempts {
  std::map<std::size_t, Attempts> of_case;
  std::vector<std::string> living_workers;
};

[[nodiscard]] AllAttempts read_attempts(const std::filesystem::path& attempt_files);

[[nodiscard]] Json begin_line(std::size_t number, const std::string& attempt, const std::string& host,
                              std::int64_t process);
[[nodiscard]] Json end_line(std::size_t number, const std::string& attempt, const std::string& end, bool is_kill);

}  // namespace vbar::campaign
