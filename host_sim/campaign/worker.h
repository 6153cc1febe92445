#pragma once
// Selection of the run folders of a campaign that stay.

#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/campaign/case_records.h"
#include "host_sim/campaign/plan.h"
#include "host_sim/io/child_process.h"

namespace vbar::campaign {

/// Largest number of failed cases that keep their folders.
inline constexpr std::size_t kMaxFailedRuns = 100;

/// Whether the folder of `result` is to stay, given the results of the same worker before it: all, those that did not
/// pass, or those that are among the worst so far by a criterion.
[[nodiscard]] bool is_kept(const Plan& plan, const Result& result, const std::vector<Result>& before,
                           const Folder& folder);

/// Moves a run folder to runs/NUMBER, in place of one that is there; its path relative to the campaign's folder. Throws
/// std::runtime_error.
std::string keep_run(const Folder& folder, const std::filesystem::path& run_folder, std::size_t number);

/// The cases that are the worst `plan.keep.worst` by any criterion.
[[nodiscard]] std::vector<std::size_t> worst_cases(const Plan& plan, const std::vector<Result>& results);

/// keep = "worst:N": removes the folders of cases that others have outdone since.
void remove_outdone_runs(const Plan& plan, const std::vector<Result>& results, const Folder& folder);

// One flight of a case: `vbar run` in a process of its own, and what it left.

/// Name of this computer, and the type of its processor.
struct Computer {
  std::string host, processor;
};
[[nodiscard]] Computer this_computer();

/// Executes the arguments that follow the program's name; the result is its exit code.
using CommandLine = std::function<int(const std::vector<std::string>& arguments)>;

class CaseFlight {
 public:
  struct Request {
    const Folder& folder;
    const Plan& plan;
    const Case& one;
    std::string attempt;  ///< its name: of the run folder while it flies
    bool full_record = false;
    /// Runs a command line of vbar, without the program, in this process; null: the copied program is started.
    const CommandLine* command_line = nullptr;
  };

  /// Starts the process, in a folder that no other attempt has. Throws std::runtime_error if it cannot be started.
  explicit CaseFlight(const Request& request);
  ~CaseFlight();
  CaseFlight(const CaseFlight&) = delete;
  CaseFlight& operator=(const CaseFlight&) = delete;

  /// kResult: the case succeeded or failed by itself. kKilled: it is to be flown again. kTrouble: the computer or the
  /// campaign failed, not the case (a full disk, a program that does not start); nothing more can be flown here.
  struct End {
    enum class Kind { kResult, kKilled, kTrouble };
    Kind kind = Kind::kResult;
    Result result = {};
    std::string reason = {};
  };

  /// Returns the end once the process has ended, or has flown for too long and was ended.
  [[nodiscard]] std::optional<End> poll();

  [[nodiscard]] const Case& one() const { return one_; }
  [[nodiscard]] const std::string& attempt() const { return attempt_; }
  [[nodiscard]] const std::filesystem::path& run_folder() const { return run_folder_; }
  [[nodiscard]] std::int64_t process() const { return child_->pid(); }

 private:
  [[nodiscard]] End judge();
  [[nodiscard]] End judge_failure(Result result, const Json& summary) const;

  const Case one_;
  const std::string attempt_, identity_;
  const double time_limit_s_;
  std::filesystem::path run_folder_;
  std::unique_ptr<io::ChildProcess> child_;
  std::chrono::steady_clock::time_point started_;
  bool over_time_ = false;
};

// Flies cases, several at once, each in a process of its own, and records their results. Both engines end here:
// the local one with as many flights at once as there are processors, a task of a job array with its share of the
// cases.

struct WorkerOptions {
  std::string name;  ///< name of its files, which no other worker ever has
  int jobs = 1;      ///< flights at once
  std::function<bool()> stop_requested;
  /// Command line of this program, for flights in copies of this process where that is the same.
  CommandLine command_line = {};
  /// Is called after each result and at least once a second with the results of this worker so far and its flights
  /// under way.
  std::function<void(const std::vector<Result>& results, std::size_t flying)> progress = {};
};

class Worker {
 public:
  /// Checks the copies. Throws std::runtime_error.
  Worker(const Folder& folder, const Plan& plan, WorkerOptions options);

  enum class End { kDone, kInterrupted, kStoppedAfterFailures };

  /// Flies the cases in this order; one that is killed once more after the others, until it is lost. Throws
  /// std::runtime_error if no more can be flown here, after all that is under way was ended.
  End fly(const std::vector<Case>& cases);

 private:
  void begin(const Case& one);
  void finish(CaseFlight& flight, CaseFlight::End end);
  void record(CaseFlight& flight, Result result);
  [[nodiscard]] std::string keep(const CaseFlight& flight, const Result& result);
  void end_flights(const std::string& reason);
  [[nodiscard]] bool stops_after_failures() const;

  const Folder& folder_;
  const Plan& plan_;
  WorkerOptions options_;
  bool flies_in_copies_ = false;  ///< flights are copies of this process
  RecordFile attempts_;
  ResultFile results_;
  std::map<std::size_t, std::size_t> kills_;  ///< number for each case, by earlier workers too
  std::deque<Case> waiting_;
  std::vector<std::unique_ptr<CaseFlight>> flights_;
  std::vector<Result> flown_;
  std::size_t begun_ = 0, failures_ = 0;
};

/// A name for a worker of this process: engine, UTC time, host, process.
[[nodiscard]] std::string new_worker_name(const std::string& engine);

/// Removes the run folders of attempts whose workers do not live. To be called while no worker starts.
void remove_abandoned_flights(const Folder& folder);

}  // namespace vbar::campaign
