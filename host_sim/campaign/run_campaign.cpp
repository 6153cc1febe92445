#include "host_sim/campaign/run_campaign.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <set>
#include <system_error>
#include <thread>

#include <fmt/format.h>

#include "host_sim/campaign/case.h"
#include "host_sim/campaign/copies.h"
#include "host_sim/campaign/engine.h"
#include "host_sim/campaign/plan.h"
#include "host_sim/campaign/status.h"
#include "host_sim/campaign/worker.h"
#include "host_sim/campaign_report/page.h"
#include "host_sim/files/output_file.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/simulation/exit_codes.h"
#include "host_sim/simulation/run_control.h"

namespace vbar::campaign {

namespace {

namespace fs = std::filesystem;
using app::Refused;

struct OpenedFolder {
  Folder folder;
  bool is_new = false;  ///< made by this process
};

/// Seeds of a campaign that was begun stay as they were drawn.
void refuse_other_seeds(const RunRequest& request, const Folder& folder) {
  if (request.seeds_from.empty()) return;
  const std::string drawn = read_plan(folder.plan()).seeds_from;
  if (drawn.empty() || seed_origin(request.seeds_from) != drawn)
    throw Refused(fmt::format("--seeds-from: found {}; accepted: {}", request.seeds_from,
                              drawn.empty() ? "nothing, as " + folder.root().string() + " has stated seeds"
                                            : drawn + ", of which the seeds of " + folder.root().string() +
                                                  " were drawn, or another folder (--out)"));
}

/// The folder of the request; made if it is given a campaign file and there is none yet.
OpenedFolder open_folder(const RunRequest& request) {
  std::error_code error;
  if (fs::is_directory(request.campaign, error)) {
    const Folder folder(request.campaign);
    folder.require_campaign();
    if (!request.out.empty()) throw Refused("--out: has no effect on a campaign that was begun");
    refuse_other_seeds(request, folder);
    return {folder};
  }
  CampaignFile campaign = read_campaign_file(request.campaign);
  const Folder folder(request.out.empty() ? fs::path("runs") / ("campaign-" + campaign.name) : request.out);
  if (holds_same_campaign(folder, request.campaign)) {
    refuse_other_seeds(request, folder);
    return {folder};
  }
  draw_seeds(campaign, request.build.commit, request.seeds_from);
  prepare(campaign, folder, request.build, request.quiet);
  return {folder, true};
}

/// No case is flown twice at once.
void refuse_if_being_flown(const Folder& folder, const Standing& standing) {
  const std::string hint = "; vbar campaign status shows how it stands";
  if (!standing.attempts.living_workers.empty())
    throw Refused(fmt::format("{}: is being flown by worker {}{}", folder.root().string(),
                              standing.attempts.living_workers.front(), hint));
  const std::vector<std::string> jobs = jobs_of_campaign(folder);
  if (!jobs.empty())
    throw Refused(
        fmt::format("{}: jobs wait or run for it: {}{}", folder.root().string(), fmt::join(jobs, ", "), hint));
}

void refuse_conflicts(const Standing& standing) {
  if (!standing.results.conflicts.empty())
    throw std::runtime_error(fmt::format("{}", fmt::join(standing.results.conflicts, "; ")));
}

std::vector<Case> cases_to_fly(const RunRequest& request, const Standing& standing) {
  std::vector<Case> left = standing.left_to_fly(request.retry_failed);
  if (request.cases.empty()) return left;
  const std::vector<std::size_t> selected = selected_cases(request.cases, standing.cases.size());
  std::erase_if(left, [&](const Case& one) { return !std::ranges::binary_search(selected, one.number); });
  return left;
}

/// Estimates the time that is left of work of which `done` of `all` took the time since the start; negative if unknown.
class TimeLeft {
 public:
  [[nodiscard]] double seconds(std::size_t done, std::size_t all) const {
    if (done == 0) return -1.0;
    const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
    return elapsed_s / static_cast<double>(done) * static_cast<double>(all - done);
  }

 private:
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
};

/// Progress of the campaign with the results of this worker.
class LocalProgress {
 public:
  LocalProgress(const Standing& standing, std::size_t to_fly, bool quiet)
      : standing_(standing), to_fly_(to_fly), line_(quiet) {
    for (const auto& [number, result] : standing_.results.of_case) count(result, 1);
  }
  void operator()(const std::vector<Result>& results, std::size_t flying) {
    for (; counted_ < results.size(); ++counted_) {
      const Result& result = results[counted_];
      if (const auto before = standing_.results.of_case.find(result.number); before != standing_.results.of_case.end())
        count(before->second, -1);  // flown again
      standing_.results.of_case[result.number] = result;
      count(result, 1);
    }
    line_.draw(progress_text({standing_.results.of_case.size(), standing_.cases.size(), passed_, failed_, flying},
                             left_.seconds(results.size(), to_fly_)));
  }

 private:
  void count(const Result& result, int times) {
    if (has_passed(standing_.plan, result)) passed_ += static_cast<std::size_t>(times);
    if (result.state != State::kComplete && result.state != State::kVoid) failed_ += static_cast<std::size_t>(times);
  }

  Standing standing_;
  std::size_t to_fly_, counted_ = 0, passed_ = 0, failed_ = 0;
  app::StatusLine line_;
  TimeLeft left_;
};

int processors() {
  return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

void fly_here(const RunRequest& request, const Folder& folder, const Standing& standing,
              const std::vector<Case>& cases) {
  LocalProgress progress(standing, cases.size(), request.quiet);
  WorkerOptions options{new_worker_name("local"), request.jobs > 0 ? request.jobs : processors(),
                        request.stop_requested, request.command_line, std::ref(progress)};
  Worker worker(folder, standing.plan, std::move(options));
  if (worker.fly(cases) == Worker::End::kStoppedAfterFailures && !request.quiet)
    fmt::print("stopped after {} failures\n", standing.plan.stop_after_failures);
}

double work_of(const Standing& standing, std::size_t cases) {
  double sum_s = 0.0;
  for (const auto& [number, result] : standing.results.of_case) sum_s += result.wall_s;
  const std::size_t flown = standing.results.of_case.size();
  return static_cast<double>(cases) * (flown > 0 ? sum_s / static_cast<double>(flown) : standing.plan.expected_case_s);
}

fs::path write_todo(const Folder& folder, const std::vector<Case>& cases) {
  fs::create_directories(folder.submissions());
  const fs::path file = folder.submissions() / (new_worker_name("todo") + ".txt");
  std::string text;
  for (const Case& one : cases) text += fmt::format("{}\n", one.number);
  files::replace_text_file(file, text);
  return file;
}

void submit(const RunRequest& request, const Engine& engine, const Folder& folder, const Standing& standing,
            const std::vector<Case>& cases) {
  const std::size_t workers = request.workers > 0
                                  ? std::min(request.workers, std::min(cases.size(), engine.max_workers()))
                                  : workers_for(work_of(standing, cases.size()), cases.size(), engine.max_workers());
  const std::string submitted = engine.submit(
      {folder, cases, workers, write_todo(folder, cases), request.engine_options, std::max(request.jobs, 1)});
  if (!request.quiet) fmt::print("{}\n", submitted);
  std::fflush(stdout);
}

/// Waits until no worker waits or runs. A worker that was submitted by a command may be late: it has started when it
/// holds a lock, and counts as missing only after all cases have been waited for.
void wait_for_workers(const RunRequest& request, const Engine& engine, const Folder& folder, std::size_t to_fly) {
  constexpr std::chrono::seconds kPeriod{1};
  constexpr int kPatience = 30;  // periods without a job and without a worker
  const bool lists_jobs = engine.name != "command";
  app::StatusLine line(request.quiet);
  const TimeLeft left;
  for (int idle = 0; idle < (lists_jobs ? 1 : kPatience);) {
    if (request.stop_requested()) {
      if (!request.quiet) fmt::print("no longer waiting; the workers go on\n");
      return;
    }
    const auto begun = std::chrono::steady_clock::now();
    const bool has_jobs = !engine.jobs_of(folder).empty();  // before the files: a worker's last lines are then seen
    const Standing standing = read_standing(folder);
    const std::size_t missing = cases_to_fly(request, standing).size();
    if (missing == 0) return;
    idle = has_jobs || !standing.attempts.living_workers.empty() ? 0 : idle + 1;
    line.draw(progress_text(standing.progress(), left.seconds(to_fly - std::min(missing, to_fly), to_fly)));
    // Reading ten thousand results must not become a load of its own.
    const auto taken = std::chrono::steady_clock::now() - begun;
    std::this_thread::sleep_for(std::max<std::chrono::steady_clock::duration>(kPeriod, 10 * taken));
  }
}

int conclude(const RunRequest& request, const Folder& folder) {
  const Standing standing = read_standing(folder);
  std::vector<Result> results;
  for (const auto& [number, result] : standing.results.of_case) results.push_back(result);
  remove_outdone_runs(standing.plan, results, folder);
  write_results(folder, standing);
  const WrittenPage written = write_page(folder.root());
  if (!request.quiet) {
    fmt::print("{}", status_text(standing, written.requirements, {}));
    fmt::print("results  {}\npage     {}\n", folder.results().string(), written.page.string());
  }
  refuse_conflicts(standing);
  if (!standing.left_to_fly(false).empty()) return app::kInterrupted;
  const bool has_lost = standing.counts().contains(State::kLost);
  return campaign_report::all_met(written.requirements) && !has_lost ? app::kDone : app::kFailed;
}

std::vector<Case> share_of(const WorkerRequest& request, const Standing& standing) {
  std::vector<std::size_t> numbers;
  if (request.todo.empty()) {
    for (const Case& one : standing.cases) numbers.push_back(one.number);
  } else {
    std::ifstream lines(request.todo);
    if (!lines) throw Refused(request.todo.string() + ": cannot be read");
    for (std::size_t number = 0; lines >> number;) numbers.push_back(number);
  }
  // A case of the list that has flown since, or a failed one that is to be flown again, was chosen at submission.
  std::vector<Case> share;
  for (std::size_t place = request.k; place < numbers.size(); place += request.n) {
    const std::size_t number = numbers[place];
    if (number >= standing.cases.size())
      throw Refused(fmt::format("{}: case {} is unknown", request.todo.string(), number));
    const auto found = standing.results.of_case.find(number);
    const bool is_wanted =
        found == standing.results.of_case.end() || (!request.todo.empty() && found->second.state != State::kComplete);
    if (is_wanted) share.push_back(standing.cases[number]);
  }
  return share;
}

}  // namespace

int run_campaign(const RunRequest& request) {
  const Engine* const engine = find_engine(request.engine);
  if (engine == nullptr && request.engine != "local")
    throw Refused("--engine: found \"" + request.engine + "\"; accepted: " + mission::listing_of(engine_names()));
  const auto [folder, is_new] = open_folder(request);
  {
    const report::RunLock lock(folder.root());
    const Standing standing = read_standing(folder);
    refuse_conflicts(standing);
    const std::vector<Case> cases = cases_to_fly(request, standing);
    if (!cases.empty()) {
      check_trust(folder, standing.plan, standing.cases, request.trust || is_new);
      refuse_if_being_flown(folder, standing);
      remove_abandoned_flights(folder);
      if (engine == nullptr) {
        fly_here(request, folder, standing, cases);
      } else {
        submit(request, *engine, folder, standing, cases);
        if (!request.wait) return app::kDone;
        wait_for_workers(request, *engine, folder, cases.size());
      }
    }
  }
  return conclude(request, folder);
}

int run_worker(const WorkerRequest& request) {
  const Folder folder(request.folder);
  if (request.n == 0 || request.k >= request.n) throw Refused("worker K of N: K counts from 0 and is below N");
  const Standing standing = read_standing(folder);
  const std::vector<Case> cases = share_of(request, standing);
  if (cases.empty()) return app::kDone;
  check_trust(folder, standing.plan, standing.cases, request.trust);
  const char* const job = std::getenv("SLURM_JOB_ID");
  Worker worker(
      folder, standing.plan,
      {new_worker_name(job == nullptr ? fmt::format("worker{}", request.k) : fmt::format("slurm{}_{}", job, request.k)),
       request.jobs, request.stop_requested, request.command_line});
  return worker.fly(cases) == Worker::End::kDone ? app::kDone : app::kInterrupted;
}

namespace {

/// "commands and waypoints differ from the record (...)"; empty if nothing does.
std::string differences(const Result& before, const Result& now) {
  std::vector<std::string> parts;
  const auto compare = [&parts](const char* name, const std::string& then, const std::string& again) {
    if (then != again)
      parts.push_back(fmt::format("{} {}..., on record {}...", name, again.substr(0, 16), then.substr(0, 16)));
  };
  compare("commands", before.commands_sha256, now.commands_sha256);
  compare("telemetry", before.telemetry_sha256, now.telemetry_sha256);
  compare("waypoints", before.waypoints_sha256, now.waypoints_sha256);
  return fmt::format("{}", fmt::join(parts, "; "));
}

Rerun compare(const Result* before, const Result& now) {
  const auto number = now.number;
  if (before == nullptr)
    return {Rerun::Verdict::kNothingToCompare, fmt::format("case {}: no result on record", number)};
  if (before->state != now.state)
    return {Rerun::Verdict::kDifferent, fmt::format("case {}: {} ({}), on record {}", number, name_of(now.state),
                                                    now.reason, name_of(before->state))};
  if (now.state != State::kComplete && now.state != State::kVoid)
    return {Rerun::Verdict::kIdentical, fmt::format("case {}: {} again: {}", number, name_of(now.state), now.reason)};
  const std::string what = differences(*before, now);
  if (what.empty())
    return {Rerun::Verdict::kIdentical,
            fmt::format("case {}: commands, telemetry and waypoints have the same bits as on record", number)};
  const std::string other = before->processor == now.processor ? ""
                                                               : fmt::format("; on another processor: {}, on record {}",
                                                                             now.processor, before->processor);
  return {Rerun::Verdict::kDifferent, fmt::format("case {}: differs: SHA-256 of {}{}", number, what, other)};
}

fs::path take_folder(const Folder& folder, const CaseFlight& flight, const fs::path& out) {
  if (out.empty()) return folder.root() / keep_run(folder, flight.run_folder(), flight.one().number);
  fs::copy(flight.run_folder(), out, fs::copy_options::recursive);  // may be on another disk
  return out;
}

}  // namespace

Rerun rerun(const Folder& folder, std::size_t number, const fs::path& out, bool is_trusted,
            const std::function<bool()>& stop_requested) {
  const Standing standing = read_standing(folder);
  if (number >= standing.cases.size())
    throw app::Refused(fmt::format("case {}: unknown; accepted: 0 to {}", number, standing.cases.size() - 1));
  std::error_code error;
  if (!out.empty() && fs::exists(out, error)) throw app::Refused(out.string() + ": exists; name another folder");
  check_trust(folder, standing.plan, standing.cases, is_trusted);
  check_copies(folder);
  ::setenv("VBAR_DATA", fs::absolute(folder.data()).c_str(), 1);
  const std::string attempt = fmt::format("{}.{}.0", name_of_case(number), new_worker_name("rerun"));
  CaseFlight flight({folder, standing.plan, standing.cases[number], attempt, true});
  for (;;) {
    if (stop_requested()) return {Rerun::Verdict::kInterrupted, fmt::format("case {}: interrupted", number)};
    const std::optional<CaseFlight::End> end = flight.poll();
    if (!end) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      continue;
    }
    if (end->kind != CaseFlight::End::Kind::kResult)
      return {Rerun::Verdict::kFailed, fmt::format("case {}: {}", number, end->reason)};
    Rerun done = compare(standing.status_of(number).result, end->result);
    done.folder = take_folder(folder, flight, out);
    return done;
  }
}

}  // namespace vbar::campaign
