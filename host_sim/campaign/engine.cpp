#include "host_sim/campaign/engine.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "host_sim/campaign/command_engine.h"
#include "host_sim/campaign/shell.h"
#include "host_sim/campaign/slurm.h"
#include "host_sim/files/own_program.h"

namespace vbar::campaign {
namespace {

constexpr std::size_t kMaxWorkers = 500;
constexpr double kWorkOfWorker_s = 300.0;  // the start of a task then costs less than a percent

constexpr std::array<Engine, 2> kEngines{{{"slurm", submit_to_slurm, max_slurm_array, slurm_jobs},
                                          {"command", submit_by_command, [] { return kMaxWorkers; },
                                           [](const Folder&) { return std::vector<std::string>(); }}}};

}  // namespace

std::string Submission::worker_command(const std::string& k) const {
  std::string program;
  for (const std::string& word : files::words_that_start(std::filesystem::absolute(folder.program())))
    program += (program.empty() ? "" : " ") + shell_word(word);
  return fmt::format("{} campaign worker {} {} {} --todo {} --jobs {} --trust",
                     program,  // checked before it is submitted
                     shell_word(std::filesystem::absolute(folder.root()).string()), k, workers,
                     shell_word(std::filesystem::absolute(todo).string()), jobs);
}

const Engine* find_engine(std::string_view name) {
  const auto* const found = std::ranges::find(kEngines, name, &Engine::name);
  return found == kEngines.end() ? nullptr : found;
}

std::vector<std::string_view> engine_names() {
  std::vector<std::string_view> names{"local"};
  for (const Engine& engine : kEngines) names.push_back(engine.name);
  return names;
}

std::vector<std::string> jobs_of_campaign(const Folder& folder) {
  std::vector<std::string> jobs;
  for (const Engine& engine : kEngines) {
    const std::vector<std::string> some = engine.jobs_of(folder);
    jobs.insert(jobs.end(), some.begin(), some.end());
  }
  return jobs;
}

std::size_t workers_for(double work_s, std::size_t cases, std::size_t max_workers) {
  const double wanted = std::ceil(std::max(work_s, 0.0) / kWorkOfWorker_s);
  const std::size_t limit = std::min({kMaxWorkers, max_workers, cases});
  return wanted >= static_cast<double>(limit) ? std::max<std::size_t>(limit, 1)
                                              : std::max<std::size_t>(static_cast<std::size_t>(wanted), 1);
}

}  // namespace vbar::campaign
