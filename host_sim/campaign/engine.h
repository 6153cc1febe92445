#pragma once
// Commands of schedulers.

#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/campaign/plan.h"

namespace vbar::campaign {

struct CommandResult {
  bool succeeded = false;
  std::string output;   ///< standard output and error
  std::string trouble;  ///< "squeue: exit status 1: ..."; empty if it succeeded
};

/// Runs a program, looked up in PATH, and waits for it; it is ended after the time limit.
[[nodiscard]] CommandResult run_command(const std::vector<std::string>& arguments,
                                        std::chrono::seconds limit = std::chrono::seconds(60));

/// One word of a shell's command line that stands for `text`.
[[nodiscard]] std::string shell_word(const std::string& text);

// Engines that run the workers of a campaign outside this process: an engine submits them and reports whether any
// worker still waits or runs. A new engine is one function and one line of the list in engine.cpp.

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

// Any scheduler, by the command that starts a worker there.

/// Runs the template by a shell, once for each worker. In it {worker} is the worker's command line, {worker_word} the
/// same as one quoted word, {k} its number from 0 on, {n} how many there are; a template without a worker is refused.
[[nodiscard]] std::string submit_by_command(const Submission& submission);

/// The template of one worker with its names replaced. Throws app::Refused for an unknown name.
[[nodiscard]] std::string filled_template(const std::string& text, const std::string& worker, std::size_t k,
                                          std::size_t n);

// Slurm: a job array of workers. Only sbatch, squeue and scontrol are used: accounting is not installed everywhere.

[[nodiscard]] std::string submit_to_slurm(const Submission& submission);

/// One less than Slurm's MaxArraySize.
[[nodiscard]] std::size_t max_slurm_array();

/// "12_3 RUNNING"; a campaign's jobs have a name of their own, made of its folder. Empty without Slurm, and of a
/// campaign that was never submitted. Throws std::runtime_error if this computer has Slurm but squeue does not answer.
[[nodiscard]] std::vector<std::string> slurm_jobs(const Folder& folder);

}  // namespace vbar::campaign
