#pragma once
// Result of a case, as recorded by the worker that flew it.

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/campaign/plan.h"
#include "host_sim/campaign/summary_numbers.h"

namespace vbar::campaign {

/// State of a case. The first five are those of a result.
enum class State { kComplete, kFailed, kOverTime, kLost, kVoid, kNotBegun, kFlying, kKilled };
[[nodiscard]] std::string_view name_of(State state);

struct Result {
  std::size_t number = 0;  ///< number of the case
  std::string attempt;     ///< its name, which no other attempt has
  State state = State::kComplete;
  std::string reason;   ///< reason of a failure, in one sentence
  std::string verdict;  ///< on the mission of a complete case (host_sim/report/verdict.h)
  std::string host, processor;
  double wall_s = 0.0, cpu_s = 0.0;
  std::string commands_sha256, telemetry_sha256, waypoints_sha256;
  std::string case_sha256;  ///< hash of the overrides that were flown (identity_of)
  std::string folder;       ///< that was kept, relative to the campaign's; empty if none was
  Numbers numbers;          ///< numbers of the summary

  [[nodiscard]] bool has_same_outputs(const Result& other) const {
    return commands_sha256 == other.commands_sha256 && telemetry_sha256 == other.telemetry_sha256 &&
           waypoints_sha256 == other.waypoints_sha256;
  }
};

/// The results of one worker, a line each. The names of their numbers stand in a line of their own, once for all
/// results that have the same ones: with them in each line, ten thousand results would be twice as large.
class ResultFile {
 public:
  /// Throws as RecordFile, here and below.
  explicit ResultFile(std::filesystem::path file) : file_(std::move(file)) {}
  /// Appends a result, which survives a loss of power once this returns.
  void append(const Result& result);

 private:
  RecordFile file_;
  std::vector<std::string> names_;  ///< content of the last line of names
  std::size_t name_lines_ = 0;
};

/// The keys of the criteria that the case does not meet; a number that is missing meets none. Of complete cases.
[[nodiscard]] std::vector<std::string> failed_limits(const Plan& plan, const Result& result);
[[nodiscard]] bool has_passed(const Plan& plan, const Result& result);

struct AllResults {
  std::map<std::size_t, Result> of_case;
  std::size_t damaged_lines = 0;
  std::vector<std::string> conflicts;  ///< a sentence for each case that was flown twice with different outputs
};

/// The results of all workers. Of a case with several, a complete one prevails, then the last of the last file.
[[nodiscard]] AllResults read_results(const std::filesystem::path& result_files);

}  // namespace vbar::campaign
