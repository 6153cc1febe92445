#pragma once
// Flies cases, several at once, each in a process of its own, and records their results. Both engines end here:
// the local one with as many flights at once as there are processors, a task of a job array with its share of the
// cases.

#include <deque>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "host_sim/campaign/attempts.h"
#include "host_sim/campaign/case_flight.h"

namespace vbar::campaign {

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
