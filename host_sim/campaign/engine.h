#pragma once
// Engines that run the workers of a campaign outside this process: an engine submits them and reports whether any
// worker still waits or runs. A new engine is one function and one line of the list in engine.cpp.

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/campaign/folder.h"
#include "host_sim/campaign/plan.h"

namespace vbar::campaign {

struct Submission {
  const Folder& folder;
  std::vector<Case> cases;     ///< cases that are left to fly
  std::size_t workers = 1;     ///< each flies its share of the cases: k, k + workers, ...
  std::filesystem::path todo;  ///< the numbers of the cases, one a line
  std::string options;         ///< slurm: options of sbatch; command: the template
  int jobs = 1;                ///< flights at once of each worker

  /// The command line of a worker; `k` is its number or the shell's name for it.
  [[nodiscard]] std::string worker_command(const std::string& k) const;
};

struct Engine {
  std::string_view name;
  /// Throws app::Refused if it does not take the workers. One sentence about what was submitted.
  std::string (*submit)(const Submission& submission);
  /// The most workers that one submission may have.
  std::size_t (*max_workers)();
  /// Jobs of the campaign that wait or run, as this engine lists them; nothing where it cannot know.
  std::vector<std::string> (*jobs_of)(const Folder& folder);
};

/// Returns null for an unknown name.
[[nodiscard]] const Engine* find_engine(std::string_view name);
[[nodiscard]] std::vector<std::string_view> engine_names();

/// Lists the jobs of the campaign in all engines.
[[nodiscard]] std::vector<std::string> jobs_of_campaign(const Folder& folder);

/// Work in pieces of some five minutes, at most 500 and at most as the engine takes.
[[nodiscard]] std::size_t workers_for(double work_s, std::size_t cases, std::size_t max_workers);

}  // namespace vbar::campaign
