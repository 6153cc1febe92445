#include "host_sim/campaign/engine.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "host_sim/files/data_stream.h"
#include "host_sim/files/output_file.h"
#include "host_sim/files/own_program.h"
#include "host_sim/io/child_process.h"
#include "host_sim/simulation/exit_codes.h"

namespace vbar::campaign {

CommandResult run_command(const std::vector<std::string>& arguments, std::chrono::seconds limit) {
  constexpr std::size_t kMaxOutput = 1 << 20;
  try {
    io::ChildProcess child(arguments, {});
    child.keep_processes_left_behind();  // workers that a submission starts in the background
    const bool has_ended = child.wait_for_end(limit);
    if (!has_ended) child.terminate(std::chrono::milliseconds(0));
    CommandResult result{has_ended && child.exit_status() == 0, child.output_tail(kMaxOutput), {}};
    if (!result.succeeded)
      result.trouble =
          fmt::format("{}: {}: {}", arguments.front(),
                      has_ended ? child.status_text() : fmt::format("no answer in {} s", limit.count()), result.output);
    return result;
  } catch (const std::system_error& error) {
    return {false, {}, error.what()};
  }
}

std::string shell_word(const std::string& text) {
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

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

std::string filled_template(const std::string& text, const std::string& worker, std::size_t k, std::size_t n) {
  const std::array<std::pair<std::string, std::string>, 4> names{{{"{worker}", worker},
                                                                  {"{worker_word}", shell_word(worker)},
                                                                  {"{k}", std::to_string(k)},
                                                                  {"{n}", std::to_string(n)}}};
  std::string filled;
  bool has_worker = false;
  for (std::size_t place = 0; place < text.size();) {
    const auto named = [&]() -> const std::pair<std::string, std::string>* {
      for (const auto& one : names)
        if (text.compare(place, one.first.size(), one.first) == 0) return &one;
      return nullptr;
    }();
    if (named == nullptr) {
      filled += text[place++];
      continue;
    }
    has_worker = has_worker || named->first.starts_with("{worker");
    filled += named->second;
    place += named->first.size();
  }
  if (!has_worker)
    throw app::Refused(
        "--submit: found a template without a worker; accepted: a command line with {worker} or "
        "{worker_word}, and {k}, {n}");
  return filled;
}

std::string submit_by_command(const Submission& submission) {
  for (std::size_t k = 0; k < submission.workers; ++k) {
    const std::string command =
        filled_template(submission.options, submission.worker_command(std::to_string(k)), k, submission.workers);
    const CommandResult result = run_command({"/bin/sh", "-c", command});
    if (!result.succeeded)
      throw app::Refused(fmt::format("worker {} of {} is not taken: {}", k, submission.workers, result.trouble));
  }
  return fmt::format("{} workers submitted for {} cases", submission.workers, submission.cases.size());
}

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
