#pragma once
// Append-only files of JSON lines, each with a checksum: one writer a file, so that no lock is needed between
// computers, and a line that was cut by a crash is recognised.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "host_sim/campaign/plan.h"
#include "host_sim/io/file_descriptor.h"

namespace vbar::campaign {

using Json = nlohmann::ordered_json;

/// A line without its end: the members of `object`, then "crc32" of the text without that member.
[[nodiscard]] std::string line_of(const Json& object);

class RecordFile {
 public:
  enum class Sync { kNo, kYes };

  /// Makes the file, which must not exist, and holds a lock on it as long as this object lives. Throws
  /// std::runtime_error that names the file, here and below.
  explicit RecordFile(std::filesystem::path file);

  /// Appends one line; with kYes it survives a loss of power when this returns.
  void append(const Json& object, Sync sync);

  [[nodiscard]] const std::filesystem::path& path() const { return file_; }

 private:
  std::filesystem::path file_;
  io::FileDescriptor descriptor_;
};

/// Whether the writer of the file lives: its lock is held.
[[nodiscard]] bool is_being_written(const std::filesystem::path& file);

struct ReadLines {
  std::vector<Json> lines;
  std::size_t damaged = 0;  ///< lines that fail their checksum, but for one without an end
};

/// Throws std::runtime_error that names the file if it cannot be read.
[[nodiscard]] ReadLines read_lines_of(const std::filesystem::path& file);

// The numbers of a summary.json by dotted keys: what criteria of a campaign name and results.csv holds.

/// Numbers in the order of the file, without those that are null. Elements of arrays stand by what identifies them:
/// waypoints.10.navigation_error_m, samples.39.5h.nees, sources.servicer/gnss.epochs. Means and deviations have their
/// unit last: navigation_error_mean_m. Wall-clock times and the provenance are left out.
using Numbers = std::vector<std::pair<std::string, double>>;

[[nodiscard]] Numbers numbers_of(const Json& summary);

/// SHA-256 of what the summary says of the waypoints.
[[nodiscard]] std::string waypoints_sha256(const Json& summary);

[[nodiscard]] std::optional<double> find_number(const Numbers& numbers, const std::string& key);

// Flights that were started: the case, the worker, and whether it was killed.

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

// Result of a case, as recorded by the worker that flew it.

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
