// vbar resume: a run that was killed or interrupted is flown again from its start, compared with its log, and
// continued.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "host_sim/cli/commands.h"
#include "host_sim/cli/recorded_flight.h"
#include "host_sim/cli/replay_input.h"
#include "host_sim/files/output_file.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/sensors/installed_testbeds.h"
#include "host_sim/simulation/exit_codes.h"
#include "host_sim/simulation/flight_computer.h"
#include "host_sim/simulation/recorded_mission.h"
#include "host_sim/simulation/run_control.h"
#include "host_sim/twins/run_log.h"

namespace vbar::app {
namespace {

namespace fs = std::filesystem;

/// The run that is to be continued, or to be branched from.
struct FlownRun {
  fs::path folder;
  report::Summary summary;
  std::vector<std::string> overrides;
  mission::Mission mission;

  [[nodiscard]] double hours(fsw::GpsTime time) const { return fsw::seconds(time - mission.epoch) / 3600.0; }
};

fs::path existing(const fs::path& folder) {
  const fs::path absolute = fs::absolute(folder).lexically_normal();
  const fs::path own = absolute.has_filename() ? absolute : absolute.parent_path();
  return fs::exists(own) ? fs::canonical(own) : own;
}

void refuse_changes(const FlownRun& run) {
  if (run.overrides != run.summary.provenance.overrides)
    throw Refused(fmt::format("{}: {} differs from that of the run", run.folder.string(), kOverridesCopy));
  const auto changes = changes_since(run.summary.provenance, run.folder / kMissionCopy,
                                     flight_software_file(flying_spacecraft(run.mission)));
  if (!changes.empty()) throw Refused(fmt::format("{}: {}", run.folder.string(), changes.front()));
}

FlownRun read_run(const fs::path& folder, bool trust) {
  FlownRun run{folder, summary_of_run(folder), overrides_of_run(folder), {}};
  run.mission = sensors::load_mission(folder / kMissionCopy, run.overrides);
  check_trust(run.mission, folder, {}, trust);
  if (!run.mission.record.packets)
    throw Refused(folder.string() + ": a run with record.packets = false has no log to be compared with");
  refuse_changes(run);
  return run;
}

/// The time and the version of the mission from which a run that is a branch left another one.
struct BranchPoint {
  double at_h = 0.0;
  std::size_t changes = 0;  ///< how many of the overrides, the last ones, are those of the branch
  mission::Mission before;

  [[nodiscard]] fsw::GpsTime time() const { return before.epoch + fsw::nearest_duration(3600.0 * at_h); }
};

/// Content of kBranchCopy.
std::string text_of(const BranchPoint& point) {
  return fmt::format("at_h = {}\noverrides = {}\n", point.at_h, point.changes);
}

/// Returns an empty value if the run is not a branch.
std::optional<BranchPoint> branch_point(const FlownRun& run) {
  const fs::path file = run.folder / kBranchCopy;
  if (!fs::exists(file)) return std::nullopt;
  const std::string text = files::read_text_file(file);
  double at_h = 0.0;
  std::size_t changes = 0;
  int end = 0;
  const int read = std::sscanf(text.c_str(), "at_h = %lf overrides = %zu %n", &at_h, &changes, &end);
  if (read != 2 || std::cmp_not_equal(end, text.size()) || changes > run.overrides.size() || !(at_h > 0.0))
    throw Refused(file.string() + ": is not that of a branch");
  const std::vector<std::string> before(run.overrides.begin(),
                                        run.overrides.end() - static_cast<std::ptrdiff_t>(changes));
  return BranchPoint{at_h, changes, sensors::load_mission(run.folder / kMissionCopy, before)};
}

/// Only what is digital or recorded can be flown again.
void refuse_testbeds(const mission::Mission& mission, const AssembledMission& assembled) {
  if (mission.truth_source != mission::kTruthModel)
    throw Refused(
        fmt::format("truth.source: a run with the truth of testbed {} cannot be flown again", mission.truth_source));
  for (const Source& source : assembled.sources()) {
    if (testbeds::find_testbed(source.kind) != nullptr)
      throw Refused(
          fmt::format("source {}: a run with the testbed {} cannot be flown again", source.name, source.kind));
  }
}

std::unique_ptr<AssembledMission> assemble_again(const mission::Mission& mission,
                                                 const std::optional<BranchPoint>& branch) {
  auto assembled = assemble(mission, false);
  refuse_testbeds(mission, *assembled);
  try {
    if (branch) assembled->branch_from(branch->before, branch->time());
    assembled->start();
  } catch (const std::runtime_error& error) {
    throw Refused(error.what());
  }
  return assembled;
}

/// The line of progress on a terminal.
constexpr const char* kClearLine = "\r\x1b[K";

/// Follows a flight along the log of an earlier one.
class Comparison {
 public:
  Comparison(const FlownRun& run, twins::RunLog& log, bool quiet) : run_(run), log_(log), quiet_(quiet) {}

  /// Is the twins::EventCheck of the log.
  void operator()(fsw::GpsTime time, const twins::LcmEvent& event) {
    if (log_.is_over()) return;
    try {
      log_.compare(time, event);
    } catch (const twins::RunDiffers& error) {
      verdict_ = {kDifferent,
                  fmt::format("is not what is flown now: at {:.4f} h: {}", run_.hours(error.time()), error.what())};
      throw;
    } catch (const twins::DamagedLog& error) {
      verdict_ = {kDamagedLog, error.what()};
      throw;
    }
    if (log_.is_over() && !quiet_) announce_end(time);
  }

  /// Returns why the flight cannot replace the log, after it ended for the reason `trouble`; empty if it can.
  [[nodiscard]] std::optional<Verdict> verdict(const std::optional<std::string>& trouble) const {
    if (verdict_) return verdict_;
    if (log_.is_over()) return std::nullopt;
    if (!trouble) return Verdict{kDifferent, "goes on after the end of the mission"};
    return Verdict{*trouble == kInterruption ? kInterrupted : kFailed,
                   fmt::format("was not reached to its end again: {}", *trouble)};
  }

 private:
  void announce_end(fsw::GpsTime time) const {
    fmt::print("{}identical to the log until {:.4f} h, and goes on from there\n",
               isatty(STDERR_FILENO) == 1 ? kClearLine : "", run_.hours(time));
    std::fflush(stdout);
  }

  const FlownRun& run_;
  twins::RunLog& log_;
  bool quiet_;
  std::optional<Verdict> verdict_;
};

/// The log of a run; one without any event if the run was killed before its first step.
twins::RunLog log_of(const FlownRun& run) {
  const fs::path file = report::packet_log_file(run.folder);
  if (!fs::exists(file)) files::replace_text_file(file, "");
  twins::RunLog log(file);
  const auto& written = run.summary.provenance.packet_log;
  if (written && log.has_end() && report::digest_of(file)->sha256 != written->sha256)
    throw twins::DamagedLog(file.string() + ": was altered after the run (SHA-256)");
  return log;
}

void announce(const FlownRun& run, const twins::RunLog& log) {
  const auto damage = log.damaged_from();
  fmt::print("flying again: {} steps, until {:.4f} h{}\n", log.steps(), log.steps() > 0 ? run.hours(log.time()) : 0.0,
             damage ? fmt::format("; the log ends within the event at byte {}", *damage) : "");
}

int refuse(const fs::path& log, const Verdict& verdict) {
  const std::string& sentence = verdict.sentence;
  const std::string text = sentence.starts_with(log.string()) ? sentence : log.string() + " " + sentence;
  files::print_error("vbar", text);
  return verdict.code;
}

int continue_run(const ResumeOptions& options, const FlownRun& run, twins::RunLog& log) {
  const std::optional<BranchPoint> branch = branch_point(run);
  Comparison comparison(run, log, options.quiet);
  const FlightOrder order{run.mission,
                          files::read_text_file(run.folder / kMissionCopy),
                          run.overrides,
                          options.quiet,
                          branch ? text_of(*branch) : "",
                          std::ref(comparison)};
  const auto assembled = assemble_again(run.mission, branch);
  if (!options.quiet) announce(run, log);
  report::RunRecord record = record_at_start(order);
  std::optional<std::string> trouble;
  {
    report::RunFolder folder(resuming_folder(run.folder), record.summary, report::RunFolder::Existing::kReplace,
                             sensors::extensions());
    trouble = fly_into(folder, order, *assembled, record);
    if (const auto verdict = comparison.verdict(trouble)) {
      remove_resumed(run.folder);
      return refuse(report::packet_log_file(run.folder), *verdict);
    }
    report_flight(folder.path(), options.run_folder, order, record, trouble);
  }
  replace_run(run.folder);
  return exit_code_of(record, trouble, options.run_folder, options.quiet);
}

int fly_branch(const ResumeOptions& options, const FlownRun& run, twins::RunLog& log) {
  if (branch_point(run))
    throw Refused(run.folder.string() + ": is a branch; branches are flown from the run that it left");
  std::vector<std::string> overrides = run.overrides;
  overrides.insert(overrides.end(), options.overrides.begin(), options.overrides.end());
  const mission::Mission mission = sensors::load_mission(run.folder / kMissionCopy, overrides);
  check_trust(mission, run.folder, options.overrides, options.trust);
  overrides = mission::with_absolute_files(std::move(overrides), mission);
  const BranchPoint point{*options.branch_at_h, options.overrides.size(), run.mission};
  if (log.steps() == 0 || point.time() <= run.mission.start_time() || point.time() > log.time()) {
    throw Refused(fmt::format("--at {}: the log of the run holds {:.4f} to {:.4f} h", *options.branch_at_h,
                              run.hours(run.mission.start_time()), log.steps() > 0 ? run.hours(log.time()) : 0.0));
  }
  log.compare_before(point.time());
  Comparison comparison(run, log, options.quiet);
  const FlightOrder order{mission,        files::read_text_file(run.folder / kMissionCopy),
                          overrides,      options.quiet,
                          text_of(point), std::ref(comparison)};
  std::unique_ptr<AssembledMission> assembled;
  const std::string sets = fmt::format("--set {}", fmt::join(options.overrides, " --set "));
  try {
    assembled = assemble_again(mission, point);
  } catch (const Refused& error) {
    throw Refused(fmt::format("{}: not in flight: {}", sets, error.what()));
  }
  report::RunRecord record = record_at_start(order);
  report::RunFolder folder(options.out.empty() ? report::default_run_folder(mission.name, mission.seed) : options.out,
                           record.summary, report::RunFolder::Existing::kRefuse, sensors::extensions());
  const auto trouble = fly_into(folder, order, *assembled, record);
  if (auto verdict = comparison.verdict(trouble)) {
    fs::remove_all(folder.path());
    if (verdict->code == kDifferent)
      verdict->sentence += fmt::format("; {} has an effect before {} h", sets, *options.branch_at_h);
    return refuse(report::packet_log_file(run.folder), *verdict);
  }
  report_flight(folder.path(), folder.path(), order, record, trouble);
  return exit_code_of(record, trouble, folder.path(), options.quiet);
}

[[noreturn]] void refuse_complete(const fs::path& folder) {
  const auto is_there = [&](const std::string& table) { return fs::exists(folder / table); };
  const bool has_tables = std::ranges::any_of(report::table_files(sensors::extensions()), is_there);
  const bool is_page_missing = has_tables && !fs::exists(report::report_file(folder));
  throw Refused(fmt::format("{}: the run is complete, nothing is left to fly{}", folder.string(),
                            is_page_missing ? "; vbar report writes the page that is missing" : ""));
}

}  // namespace

int resume_command(const ResumeOptions& options) {
  const fs::path folder = existing(options.run_folder);
  if (!fs::exists(folder)) settle_earlier_resume(folder);
  if (!fs::is_directory(folder)) throw Refused(folder.string() + ": no such run folder");
  static_cast<void>(summary_of_run(folder));
  std::optional<report::RunLock> lock(std::in_place, folder);
  settle_earlier_resume(folder);
  lock.reset();
  lock.emplace(folder);  // that may be another folder now
  const report::Summary summary = summary_of_run(folder);
  if (summary.complete && !options.branch_at_h) refuse_complete(folder);
  const FlownRun run = read_run(folder, options.trust);
  catch_stop_signals();
  try {
    twins::RunLog log = log_of(run);
    return options.branch_at_h ? fly_branch(options, run, log) : continue_run(options, run, log);
  } catch (const twins::IncompleteLog& error) {
    return refuse(report::packet_log_file(run.folder), {kThinnedLog, error.what()});
  } catch (const twins::DamagedLog& error) {
    return refuse(report::packet_log_file(run.folder), {kDamagedLog, error.what()});
  }
}

}  // namespace vbar::app
