#include "host_sim/campaign/worker.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <system_error>
#include <thread>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include "host_sim/campaign/copies.h"
#include "host_sim/campaign/kept_runs.h"

namespace vbar::campaign {
namespace {

namespace fs = std::filesystem;
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
