#include "host_sim/campaign/worker.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <limits>
#include <set>
#include <system_error>
#include <thread>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include "host_sim/campaign/copies.h"
#include "host_sim/files/output_file.h"
#include "host_sim/files/own_program.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/simulation/exit_codes.h"

namespace vbar::campaign {

namespace {

namespace fs = std::filesystem;

/// Larger is worse; a case without the number is the worst.
double badness(const PassCriterion& criterion, const Result& result) {
  const auto value = find_number(result.numbers, criterion.key);
  if (!value) return std::numeric_limits<double>::infinity();
  double worst = -std::numeric_limits<double>::infinity();
  if (criterion.most) worst = std::max(worst, *value - *criterion.most);
  if (criterion.least) worst = std::max(worst, *criterion.least - *value);
  return worst;
}

std::size_t count_folders(const fs::path& folder) {
  std::size_t count = 0;
  std::error_code error;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder, error)) ++count;
  return count;
}

}  // namespace

std::vector<std::size_t> worst_cases(const Plan& plan, const std::vector<Result>& results) {
  std::set<std::size_t> worst;
  for (const PassCriterion& criterion : plan.passes) {
    std::vector<std::pair<double, std::size_t>> ranked;
    for (const Result& result : results) ranked.emplace_back(-badness(criterion, result), result.number);
    std::ranges::sort(ranked);
    for (std::size_t k = 0; k < std::min(plan.keep.worst, ranked.size()); ++k) worst.insert(ranked[k].second);
  }
  return {worst.begin(), worst.end()};
}

bool is_kept(const Plan& plan, const Result& result, const std::vector<Result>& before, const Folder& folder) {
  switch (plan.keep.kind) {
    case Keep::Kind::kSummary:
      return false;
    case Keep::Kind::kAll:
      return true;
    case Keep::Kind::kFailed:
      return !has_passed(plan, result) && count_folders(folder.runs()) < kMaxFailedRuns;
    case Keep::Kind::kWorst:
      break;
  }
  return std::ranges::any_of(plan.passes, [&](const PassCriterion& criterion) {
    const double own = badness(criterion, result);
    const auto worse = std::ranges::count_if(before, [&](const Result& r) { return badness(criterion, r) >= own; });
    return static_cast<std::size_t>(worse) < plan.keep.worst;
  });
}

std::string keep_run(const Folder& folder, const fs::path& run_folder, std::size_t number) {
  const fs::path kept = folder.runs() / name_of_case(number);
  std::error_code error;
  fs::create_directories(folder.runs(), error);
  fs::remove_all(kept, error);
  fs::rename(run_folder, kept, error);
  if (error) throw std::runtime_error(kept.string() + ": cannot be written: " + error.message());
  return kept.lexically_relative(folder.root()).string();
}

void remove_outdone_runs(const Plan& plan, const std::vector<Result>& results, const Folder& folder) {
  if (plan.keep.kind != Keep::Kind::kWorst) return;
  const std::vector<std::size_t> worst = worst_cases(plan, results);
  std::error_code ignored;
  for (const Result& result : results)
    if (!result.folder.empty() && !std::ranges::binary_search(worst, result.number))
      fs::remove_all(folder.runs() / name_of_case(result.number), ignored);
}

namespace {

using End = CaseFlight::End;

std::vector<std::string> arguments_of(const CaseFlight::Request& request, const fs::path& run_folder) {
  std::vector<std::string> command{"run", (request.folder.root() / request.plan.mission_file).string(), "--quiet",
                                   "--out", run_folder.string()};
  for (const std::string& override : overrides_of(request.plan, request.one, request.full_record))
    command.insert(command.end(), {"--set", override});
  return command;
}

std::unique_ptr<io::ChildProcess> start(const CaseFlight::Request& request, const fs::path& run_folder) {
  const std::string program = fs::absolute(request.folder.program()).string();
  std::vector<std::string> arguments = arguments_of(request, run_folder);
  if (request.command_line != nullptr)
    return std::make_unique<io::ChildProcess>([&] { return (*request.command_line)(arguments); }, program);
  std::vector<std::string> words = files::words_that_start(program);
  words.insert(words.end(), arguments.begin(), arguments.end());
  return std::make_unique<io::ChildProcess>(words, std::vector<io::FileDescriptor>());
}

fs::path make_run_folder(const CaseFlight::Request& request) {
  const fs::path run_folder = request.folder.flying() / request.attempt;
  std::error_code error;
  fs::create_directories(request.folder.flying(), error);
  if (!fs::create_directory(run_folder, error))
    throw std::runtime_error(run_folder.string() + ": cannot be made: " + (error ? error.message() : "it exists"));
  return run_folder;
}

/// The last line that the process printed, without the program's name.
std::string last_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  text.erase(0, text.rfind('\n') + 1);  // npos + 1 is 0
  return text.starts_with("vbar: ") ? text.substr(6) : text;
}

/// A reason of the computer's, that says nothing of the case: a file that could not be written.
bool is_of_the_computer(const std::string& reason) {
  const std::array<std::string, 5> signs{"cannot be written", "cannot be made", "cannot be locked",
                                         std::generic_category().message(ENOSPC),
                                         std::generic_category().message(EDQUOT)};
  return std::ranges::any_of(signs, [&](const std::string& sign) { return reason.find(sign) != std::string::npos; });
}

Json read_summary_of(const fs::path& run_folder) {
  try {
    return Json::parse(files::read_text_file(report::summary_file(run_folder)), nullptr, false);
  } catch (const std::runtime_error&) {
    return nullptr;
  }
}

std::string text_in(const Json& json, const char* key) {
  return json.is_object() && json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : "";
}

bool is_true(const Json& json, const char* key) {
  return json.is_object() && json.contains(key) && json[key] == true;
}

bool has_fault_without_effect(const Numbers& numbers) {
  return find_number(numbers, "sensor_figures.faults.without_effect").value_or(0.0) > 0.0;
}

}  // namespace

Computer this_computer() {
  std::array<char, 256> name{};
  Computer computer{::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown", "unknown"};
  std::ifstream lines("/proc/cpuinfo");
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("model name")) continue;
    computer.processor = line.substr(std::min(line.find(": ") + 2, line.size()));
    break;
  }
  return computer;
}

CaseFlight::CaseFlight(const Request& request)
    : one_(request.one),
      attempt_(request.attempt),
      identity_(identity_of(request.plan, request.one)),
      time_limit_s_(request.plan.case_time_limit_s),
      run_folder_(make_run_folder(request)),
      child_(start(request, run_folder_)),
      started_(std::chrono::steady_clock::now()) {}

/// Ends the process, and removes a run folder that was not collected.
CaseFlight::~CaseFlight() {
  child_->terminate(std::chrono::milliseconds(0));
  std::error_code ignored;
  fs::remove_all(run_folder_, ignored);
}

std::optional<End> CaseFlight::poll() {
  if (child_->has_ended()) return judge();
  const double flown_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
  if (time_limit_s_ <= 0.0 || flown_s < time_limit_s_) return std::nullopt;
  over_time_ = true;
  child_->terminate(std::chrono::milliseconds(0));
  return judge();
}

End CaseFlight::judge() {
  Result result;
  result.number = one_.number;
  result.attempt = attempt_;
  result.case_sha256 = identity_;
  const Computer computer = this_computer();
  result.host = computer.host;
  result.processor = computer.processor;
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
  result.cpu_s = child_->processor_time_s();
  if (over_time_) {
    result.state = State::kOverTime;
    result.reason = fmt::format("not complete after {:g} s", time_limit_s_);
    return {End::Kind::kResult, std::move(result)};
  }
  if (child_->killed_by() || child_->exit_status() == app::kInterrupted)
    return {End::Kind::kKilled, std::move(result), child_->killed_by() ? child_->status_text() : "interrupted"};
  const Json summary = read_summary_of(run_folder_);
  const int status = child_->exit_status().value_or(app::kFailed);
  const bool has_verdict = status == app::kDone || status == app::kNeverNavigated || status == app::kNotAchieved;
  if (!has_verdict || !is_true(summary, "complete")) return judge_failure(std::move(result), summary);
  result.numbers = numbers_of(summary);
  result.verdict = text_in(summary, "verdict");
  result.commands_sha256 = text_in(summary, "commands_sha256");
  result.telemetry_sha256 = text_in(summary, "telemetry_sha256");
  result.waypoints_sha256 = waypoints_sha256(summary);
  if (status == app::kNeverNavigated) result.reason = "never navigated: no estimate was valid";
  if (has_fault_without_effect(result.numbers)) {
    result.state = State::kVoid;
    result.reason = "a fault of the scenario never took effect";
  }
  return {End::Kind::kResult, std::move(result)};
}

End CaseFlight::judge_failure(Result result, const Json& summary) const {
  const int status = child_->exit_status().value_or(app::kFailed);
  std::string reason = text_in(summary, "incomplete_reason");
  const std::string said = last_line(child_->output_tail());
  const bool has_reason = !reason.empty() && !reason.starts_with("running in process");
  if (!has_reason) reason = said.empty() ? child_->status_text() : said;
  if (status == app::kFailed && !is_of_the_computer(reason) && !is_of_the_computer(said)) {
    result.state = State::kFailed;
    result.reason = reason;
    return {End::Kind::kResult, std::move(result)};
  }
  // Refused although it was loaded, or a program that does not even start.
  return {End::Kind::kTrouble, std::move(result), reason};
}

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPollPeriod{4};
constexpr std::chrono::seconds kBetweenReports{1};

fs::path file_of(const fs::path& folder, const std::string& worker) {
  std::error_code ignored;
  fs::create_directories(folder, ignored);
  return folder / (worker + ".jsonl");
}

}  // namespace

Worker::Worker(const Folder& folder, const Plan& plan, WorkerOptions options)
    : folder_(folder),
      plan_(plan),
      options_(std::move(options)),
      attempts_(file_of(folder.attempt_files(), options_.name)),
      results_(file_of(folder.result_files(), options_.name)) {
  check_copies(folder);
  flies_in_copies_ = options_.command_line && flies_as_the_copy(folder);
  ::setenv("VBAR_DATA", fs::absolute(folder.data()).c_str(), 1);  // data of the flights
  for (const auto& [number, attempts] : read_attempts(folder.attempt_files()).of_case) kills_[number] = attempts.killed;
}

Worker::End Worker::fly(const std::vector<Case>& cases) {
  waiting_.assign(cases.begin(), cases.end());
  Clock::time_point reported = Clock::now();
  while (!waiting_.empty() || !flights_.empty()) {
    if (options_.stop_requested && options_.stop_requested()) {
      end_flights("interrupted");
      return End::kInterrupted;
    }
    if (stops_after_failures()) {
      end_flights("the campaign stopped after its failures");
      return End::kStoppedAfterFailures;
    }
    while (!waiting_.empty() && flights_.size() < static_cast<std::size_t>(options_.jobs)) {
      const Case next = waiting_.front();
      waiting_.pop_front();
      begin(next);
    }
    bool has_changed = false;
    for (std::unique_ptr<CaseFlight>& flight : flights_) {
      std::optional<CaseFlight::End> end = flight->poll();
      if (!end) continue;
      finish(*flight, std::move(*end));
      flight.reset();
      has_changed = true;
    }
    std::erase(flights_, nullptr);
    if (options_.progress && (has_changed || Clock::now() - reported > kBetweenReports)) {
      options_.progress(flown_, flights_.size());
      reported = Clock::now();
    }
    if (!has_changed) std::this_thread::sleep_for(kPollPeriod);
  }
  return End::kDone;
}

void Worker::begin(const Case& one) {
  const std::string attempt = fmt::format("{}.{}.{}", name_of_case(one.number), options_.name, begun_++);
  const bool full_record = plan_.keep.kind != Keep::Kind::kSummary;
  flights_.push_back(std::make_unique<CaseFlight>(CaseFlight::Request{
      folder_, plan_, one, attempt, full_record, flies_in_copies_ ? &options_.command_line : nullptr}));
  attempts_.append(begin_line(one.number, attempt, this_computer().host, flights_.back()->process()),
                   RecordFile::Sync::kNo);
}

void Worker::finish(CaseFlight& flight, CaseFlight::End end) {
  const std::size_t number = flight.one().number;
  switch (end.kind) {
    case CaseFlight::End::Kind::kResult:
      record(flight, std::move(end.result));
      return;
    case CaseFlight::End::Kind::kTrouble:
      throw std::runtime_error(fmt::format("case {}: {}", number, end.reason));
    case CaseFlight::End::Kind::kKilled:
      break;
  }
  attempts_.append(end_line(number, flight.attempt(), end.reason, true), RecordFile::Sync::kNo);
  if (++kills_[number] <= static_cast<std::size_t>(plan_.retries)) {
    waiting_.push_back(flight.one());
    return;
  }
  end.result.state = State::kLost;
  end.result.reason = fmt::format("killed {} times, the last time: {}", kills_[number], end.reason);
  record(flight, std::move(end.result));
}

/// The folder moves before the line is written: a result names only what is there.
void Worker::record(CaseFlight& flight, Result result) {
  result.folder = keep(flight, result);
  results_.append(result);
  if (result.state == State::kFailed || result.state == State::kOverTime) ++failures_;
  flown_.push_back(std::move(result));
}

std::string Worker::keep(const CaseFlight& flight, const Result& result) {
  if (result.state == State::kLost || !is_kept(plan_, result, flown_, folder_)) return {};
  return keep_run(folder_, flight.run_folder(), result.number);
}

void Worker::end_flights(const std::string& reason) {
  for (const std::unique_ptr<CaseFlight>& flight : flights_)
    attempts_.append(end_line(flight->one().number, flight->attempt(), reason, false), RecordFile::Sync::kNo);
  flights_.clear();
}

bool Worker::stops_after_failures() const {
  return plan_.stop_after_failures > 0 && failures_ >= static_cast<std::size_t>(plan_.stop_after_failures);
}

std::string new_worker_name(const std::string& engine) {
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  std::tm utc{};
  gmtime_r(&now.tv_sec, &utc);
  std::string host = this_computer().host;
  std::ranges::replace_if(
      host, [](char c) { return c == '/' || c == '.'; }, '-');
  return fmt::format("{:%Y%m%dT%H%M%S}{:03}-{}-{}-{}", utc, now.tv_nsec / 1'000'000, engine, host, ::getpid());
}

void remove_abandoned_flights(const Folder& folder) {
  const std::vector<std::string> living = read_attempts(folder.attempt_files()).living_workers;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder.flying(), error)) {
    const std::string name = entry.path().filename().string();
    const bool is_living = std::ranges::any_of(
        living, [&](const std::string& worker) { return name.find("." + worker + ".") != std::string::npos; });
    std::error_code ignored;
    if (!is_living) fs::remove_all(entry.path(), ignored);
  }
}

}  // namespace vbar::campaign
