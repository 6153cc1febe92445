#include "host_sim/verification/verify.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include <fmt/format.h>
#include <unistd.h>

#include "host_sim/campaign/run_campaign.h"
#include "host_sim/files/output_file.h"
#include "host_sim/simulation/exit_codes.h"

namespace vbar::verification {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double kMinute_s = 60.0;
constexpr const char* kFile = "verification.json";

/// Flies the first `seeds` seeds of a row. Returns an exit code of vbar campaign run.
int fly(const Request& request, const Row& row, std::size_t seeds) {
  campaign::RunRequest run;
  run.campaign = row.campaign.file;
  run.out = request.to / row.name;
  run.build = request.build;
  run.jobs = request.jobs;
  if (seeds < row.seeds()) run.cases = fmt::format("0-{}", seeds * row.cases_per_seed - 1);
  run.trust = request.trust;
  run.quiet = request.quiet || isatty(STDOUT_FILENO) != 1;
  run.stop_requested = request.stop_requested;
  run.command_line = request.command_line;
  return campaign::run_campaign(run);
}

std::string sentence_of(const Json& row) {
  if (!is_flown(row)) return "not flown";
  std::string misses;
  for (const Json& one : row["requirements"])
    if (!one["met"].get<bool>())
      misses += fmt::format("\n    not met: {}: {}, required {}", one["subject"].get<std::string>(),
                            one.value("text", "none"), one["limit"].get<std::string>());
  return fmt::format("{} of {} seeds, {} of {} requirements met, {:.2f} core-hours{}", row["seeds_flown"].dump(),
                     row["seeds_asked"].dump(),
                     std::ranges::count_if(row["requirements"], [](const Json& one) { return one["met"] == true; }),
                     row["requirements"].size(), row["core_hours"].get<double>(), misses);
}

class Verification {
 public:
  explicit Verification(const Request& request) : request_(request), all_(read_rows(request.missions)) {
    chosen_ = selected_rows(all_, request.names);
    for (Row& row : chosen_) row.flown_seeds = seeds_flown(row, request.to / row.name);
    order_by_value(chosen_);
  }

  int run() {
    const auto begun = Clock::now();
    const double budget_s = request_.budget_min.value_or(0.0) * kMinute_s;
    const std::vector<std::size_t> more = further_seeds();
    for (std::size_t k = 0; k < chosen_.size(); ++k) {
      const double spent_s = std::chrono::duration<double>(Clock::now() - begun).count();
      if (request_.budget_min && spent_s > budget_s) break;
      if (more[k] > 0 && !fly_row(chosen_[k], chosen_[k].flown_seeds + more[k])) break;
    }
    return conclude();
  }

 private:
  [[nodiscard]] std::vector<std::size_t> further_seeds() const {
    std::vector<std::size_t> more;
    if (!request_.budget_min) {
      for (const Row& row : chosen_) more.push_back(row.seeds_left());
      return more;
    }
    const int jobs =
        request_.jobs > 0 ? request_.jobs : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    return seeds_within(chosen_, *request_.budget_min * kMinute_s * jobs);
  }

  /// Returns false after a signal.
  bool fly_row(const Row& row, std::size_t seeds) {
    say(fmt::format("{}: {} of {} seeds", row.name, seeds, row.seeds()));
    try {
      static_cast<void>(fly(request_, row, seeds));
      if (request_.stop_requested()) is_interrupted_ = true;
    } catch (const std::runtime_error& error) {  // of this row alone: a bench without calibration, a program not built
      say(fmt::format("{}: cannot be flown: {}", row.name, error.what()));
      has_failed_ = true;
    }
    write();
    return !is_interrupted_;
  }

  void write() const {
    files::replace_text_file(request_.to / kFile, verification_json(all_, request_.to, request_.build));
  }

  int conclude() {
    write();
    bool all_met = true;
    for (const Row& row : chosen_) {
      const Json record = record_of(row, request_.to / row.name);
      say(fmt::format("{}: {}", row.name, sentence_of(record)));
      all_met = all_met && (!is_flown(record) || is_met(record));
    }
    say(fmt::format("verification  {}", (request_.to / kFile).string()));
    if (is_interrupted_) return app::kInterrupted;
    return all_met && !has_failed_ ? app::kDone : app::kFailed;
  }

  void say(const std::string& sentence) const {
    if (request_.quiet) return;
    fmt::print("{}\n", sentence);
    std::fflush(stdout);
  }

  const Request& request_;
  std::vector<Row> all_, chosen_;
  bool is_interrupted_ = false, has_failed_ = false;
};

}  // namespace

int verify(const Request& request) {
  Verification verification(request);
  fs::create_directories(request.to);
  return verification.run();
}

std::string list_of(std::vector<Row> rows) {
  order_by_value(rows);
  std::string text = fmt::format("{:>9} {:>5} {:>5} {:>6}  {}\n", "minutes", "seeds", "cases", "limits", "row");
  for (const Row& row : rows)
    text += fmt::format("{:>9.1f} {:>5} {:>5} {:>6}  {:<36} {}\n", row.left_s() / kMinute_s, row.seeds(),
                        row.seeds() * row.cases_per_seed, row.decisions(), row.name, row.campaign.description);
  return text;
}

}  // namespace vbar::verification
