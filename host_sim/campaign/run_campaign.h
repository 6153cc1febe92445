#pragma once
// vbar campaign run: begins a campaign, or flies what is left of one.

#include <filesystem>
#include <functional>
#include <string>

#include "host_sim/campaign/status.h"
#include "host_sim/campaign/worker.h"

namespace vbar::campaign {

struct RunRequest {
  std::filesystem::path campaign;  ///< a campaign file, or the folder of a campaign
  std::filesystem::path out;       ///< folder of a new campaign; empty: runs/campaign-NAME
  Build build;                     ///< of this program
  std::string seeds_from;          ///< commit of which the seeds of a new campaign are drawn; empty: this program's
  std::string engine = "local";
  std::string engine_options;  ///< slurm: of sbatch; command: the template
  int jobs = 0;                ///< flights at once; 0: local as there are processors, elsewhere 1 a worker
  std::size_t workers = 0;     ///< number for an engine that is not local; 0: by the work
  std::string cases;           ///< a selection; empty: all
  bool retry_failed = false;
  bool wait = true;    ///< for the workers of an engine that is not local
  bool trust = false;  ///< the program of a folder that is not this one, and what its mission names, may be used
  bool quiet = false;
  std::function<bool()> stop_requested;
  CommandLine command_line = {};  ///< as in WorkerOptions
};

/// The exit code: kDone if every case has its result and the requirement is met, kFailed if it is not met, cases were
/// lost or two flights of one differ, kInterrupted if cases are left to fly. Throws app::Refused before anything is
/// flown, std::runtime_error if no more can be flown.
[[nodiscard]] int run_campaign(const RunRequest& request);

/// One worker of an engine: its share k of n of the cases, of those listed in `todo` or, without it, of all.
struct WorkerRequest {
  std::filesystem::path folder;
  std::size_t k = 0, n = 1;
  std::filesystem::path todo;
  int jobs = 1;
  bool trust = false;  ///< as of RunRequest
  std::function<bool()> stop_requested;
  CommandLine command_line = {};
};
[[nodiscard]] int run_worker(const WorkerRequest& request);

// Flies one case again, with all its records, and compares its outputs with those on record.

struct Rerun {
  enum class Verdict { kIdentical, kDifferent, kNothingToCompare, kFailed, kInterrupted };
  Verdict verdict = Verdict::kFailed;
  std::string sentence;
  std::filesystem::path folder = {};  ///< run folder; empty if none stays
};

/// `out` empty: runs/NUMBER of the campaign. Throws app::Refused for an unknown case, a folder in use or, unless it is
/// trusted, one that would execute another program (copies.h), std::runtime_error if it cannot be flown here.
[[nodiscard]] Rerun rerun(const Folder& folder, std::size_t number, const std::filesystem::path& out, bool is_trusted,
                          const std::function<bool()>& stop_requested);

}  // namespace vbar::campaign
