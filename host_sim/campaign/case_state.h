#pragma once
// State of each case of a campaign, from the files of its workers.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "host_sim/campaign/attempts.h"
#include "host_sim/campaign/folder.h"
#include "host_sim/campaign/result.h"

namespace vbar::campaign {

struct CaseStatus {
  State state = State::kNotBegun;
  std::size_t attempts = 0;
  const Result* result = nullptr;  ///< null of a case without one
  std::string last_end;            ///< end of a killed flight, if a worker saw it
};

/// Numbers of cases.
struct Progress {
  std::size_t done = 0, all = 0, passed = 0, failed = 0, flying = 0;
};

struct Standing {
  Plan plan;
  std::vector<Case> cases;
  AllResults results;
  AllAttempts attempts;

  [[nodiscard]] CaseStatus status_of(std::size_t number) const;
  [[nodiscard]] std::map<State, std::size_t> counts() const;
  [[nodiscard]] std::size_t passed() const;
  [[nodiscard]] Progress progress() const;
  /// Cases without a result, and with `retry_failed` those that failed, took too long or were lost.
  [[nodiscard]] std::vector<Case> left_to_fly(bool retry_failed) const;
};

/// Throws app::Refused for a folder that is no campaign's, std::runtime_error for one that is damaged.
[[nodiscard]] Standing read_standing(const Folder& folder);

/// One line: done, passed, failed, flying; `left_s` < 0: unknown.
[[nodiscard]] std::string progress_text(const Progress& progress, double left_s);

}  // namespace vbar::campaign
