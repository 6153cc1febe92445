#include "host_sim/campaign/slurm.h"

#include <charconv>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>

#include "host_sim/app/exit_codes.h"
#include "host_sim/campaign/shell.h"
#include "host_sim/files/remove_link.h"
#include "host_sim/files/sha256.h"

namespace vbar::campaign {
namespace {

constexpr std::size_t kDefaultMaxArraySize = 1001;

std::string job_name(const Folder& folder) {
  const std::string path = std::filesystem::weakly_canonical(folder.root()).string();
  return "vbar-" + files::sha256_of(path).substr(0, 16);
}

/// The jobs that were submitted, one a line.
std::filesystem::path jobs_file(const Folder& folder) {
  return folder.submissions() / "slurm_jobs.txt";
}

bool has_slurm() {
  return run_command({"/bin/sh", "-c", "command -v squeue"}).succeeded;
}

}  // namespace

std::size_t max_slurm_array() {
  const CommandResult config = run_command({"scontrol", "show", "config"});
  std::istringstream lines(config.output);
  std::size_t size = kDefaultMaxArraySize;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("MaxArraySize")) continue;
    const std::size_t digits = line.find_first_of("0123456789");
    if (digits != std::string::npos) std::from_chars(line.data() + digits, line.data() + line.size(), size);
  }
  return size > 1 ? size - 1 : 1;
}

std::string submit_to_slurm(const Submission& submission) {
  const std::filesystem::path output = std::filesystem::absolute(submission.folder.submissions()) / "%A_%a.txt";
  // Never again by itself: a case must not fly twice at once.
  const std::string command =
      fmt::format("exec sbatch --parsable --no-requeue --job-name={} --array=0-{} --output={} {} --wrap={}",
                  shell_word(job_name(submission.folder)), submission.workers - 1, shell_word(output.string()),
                  submission.options, shell_word("exec " + submission.worker_command("$SLURM_ARRAY_TASK_ID")));
  const CommandResult result = run_command({"/bin/sh", "-c", command});
  if (!result.succeeded) throw app::Refused("Slurm does not take the workers: " + result.trouble);
  const std::string job = result.output.substr(0, result.output.find_first_of(";\n"));
  files::remove_link(jobs_file(submission.folder));
  std::ofstream(jobs_file(submission.folder), std::ios::app) << job << '\n';
  return fmt::format("Slurm job {}: {} workers for {} cases", job, submission.workers, submission.cases.size());
}

std::vector<std::string> slurm_jobs(const Folder& folder) {
  // A computer may have Slurm's programs without a cluster; a campaign that was never submitted does not depend on one.
  if (!std::filesystem::exists(jobs_file(folder)) || !has_slurm()) return {};
  const CommandResult result =
      run_command({"squeue", "--noheader", "--array", "--format=%F_%K %T", "--name=" + job_name(folder)});
  if (!result.succeeded) throw std::runtime_error(result.trouble);
  std::vector<std::string> jobs;
  std::istringstream lines(result.output);
  for (std::string line; std::getline(lines, line);)
    if (!line.empty()) jobs.push_back(line);
  return jobs;
}

}  // namespace vbar::campaign
