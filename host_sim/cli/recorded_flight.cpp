#include "host_sim/cli/recorded_flight.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include "host_sim/cli/build_info.h"
#include "host_sim/cli/verdicts.h"
#include "host_sim/files/data_stream.h"
#include "host_sim/files/output_file.h"
#include "host_sim/files/own_program.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/sections/comparison.h"
#include "host_sim/report/sections/html_report.h"
#include "host_sim/report/statistics.h"
#include "host_sim/report/summarise.h"
#include "host_sim/report/summary_json.h"
#include "host_sim/report/verdict.h"
#include "host_sim/simulation/exit_codes.h"
#include "host_sim/simulation/flight_computer.h"
#include "host_sim/simulation/recorded_mission.h"
#include "host_sim/simulation/recorders.h"
#include "host_sim/simulation/run_control.h"
#include "host_sim/truth/earth/time_scales.h"
#include "host_sim/twins/run_log.h"
#include "host_sim/view/view_page.h"

namespace vbar::app {

namespace {

namespace fs = std::filesystem;

/// "<run folder>.replaced": the run that was replaced, where two folders cannot change places at once.
fs::path replaced_folder(const fs::path& run_folder) {
  return run_folder.string() + ".replaced";
}

[[noreturn]] void fail(const fs::path& folder, const char* what, int error) {
  throw std::runtime_error(fmt::format("{}: {}: {}", folder.string(), what, std::generic_category().message(error)));
}

void synchronise(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool done = descriptor >= 0 && ::fsync(descriptor) == 0;
  const int error = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (!done) fail(path, "cannot be brought to the disk", error);
}

void synchronise_all(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) synchronise(entry.path());
  synchronise(folder);
}

std::set<std::string> names_of_run_files() {
  std::set<std::string> names{report::RunLock::kFile};
  for (const std::string& file : {report::summary_file("").string(), std::string(kMissionCopy),
                                  std::string(kOverridesCopy), std::string(kBranchCopy)})
    names.insert({file, files::neighbour_of(file).string()});
  for (const std::string& file : report::flight_files(sensors::extensions())) names.insert(file);
  return names;
}

/// Moves what no run writes.
void keep_other_files(const fs::path& from, const fs::path& to) {
  const std::set<std::string> of_run = names_of_run_files();
  for (const fs::directory_entry& entry : fs::directory_iterator(from)) {
    const fs::path name = entry.path().filename();
    if (!of_run.contains(name.string()) && !fs::exists(to / name)) fs::rename(entry.path(), to / name);
  }
}

/// Whether both hold the same mission.
bool is_same_mission(const fs::path& a, const fs::path& b) {
  return std::ranges::all_of(std::array{kMissionCopy, kOverridesCopy}, [&](const char* file) {
    return fs::exists(a / file) && fs::exists(b / file) &&
           files::read_text_file(a / file) == files::read_text_file(b / file);
  });
}

/// Number of intact events; 0 if there is no log, or a damaged one.
std::uint64_t events_in(const fs::path& folder) {
  try {
    return twins::RunLog(report::packet_log_file(folder)).events();
  } catch (const std::runtime_error&) {
    return 0;
  }
}

/// Exchanges the folders and returns the place of the run that was replaced.
fs::path exchange(const fs::path& run_folder, const fs::path& next) {
  if (::renameat2(AT_FDCWD, next.c_str(), AT_FDCWD, run_folder.c_str(), RENAME_EXCHANGE) == 0) return next;
  if (errno != EINVAL && errno != ENOSYS) fail(run_folder, "cannot be replaced", errno);
  const fs::path replaced = replaced_folder(run_folder);  // a file system that cannot exchange
  fs::rename(run_folder, replaced);
  fs::rename(next, run_folder);
  return replaced;
}

void remove_replaced(const fs::path& replaced, const fs::path& run_folder) {
  keep_other_files(replaced, run_folder);
  fs::remove_all(replaced);
}

}  // namespace

fs::path resuming_folder(const fs::path& run_folder) {
  return run_folder.string() + ".resuming";
}

void replace_run(const fs::path& run_folder) {
  const fs::path next = resuming_folder(run_folder);
  synchronise_all(next);
  const fs::path replaced = exchange(run_folder, next);
  synchronise(run_folder.parent_path());
  remove_replaced(replaced, run_folder);
}

void settle_earlier_resume(const fs::path& run_folder) {
  const fs::path replaced = replaced_folder(run_folder);
  files::remove_link(replaced);
  files::remove_link(resuming_folder(run_folder));
  if (report::is_summary(report::summary_file(replaced))) {
    if (fs::exists(run_folder)) {
      remove_replaced(replaced, run_folder);
    } else {
      fs::rename(replaced, run_folder);
    }
  }
  const fs::path next = resuming_folder(run_folder);
  if (!report::is_summary(report::summary_file(next))) {
    std::error_code ignored;
    fs::remove(next, ignored);  // an empty one
    return;
  }
  if (is_same_mission(run_folder, next) && events_in(next) > events_in(run_folder)) {
    replace_run(run_folder);
  } else {
    remove_replaced(next, run_folder);
  }
}

void remove_resumed(const fs::path& run_folder) {
  fs::remove_all(resuming_folder(run_folder));
}

namespace {

/// Returns an empty value if the program cannot be read. A resume needs it twice, and it takes a tenth of a second.
const std::optional<std::string>& program_sha256() {
  static const std::optional<std::string> sha256 = files::sha256_of_file(files::own_program_bytes());
  return sha256;
}

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

std::string utc_now() {
  const std::time_t seconds = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}Z", utc);
}

fs::path data_root() {
  return fs::absolute(mission::data_directory()).lexically_normal();
}

std::string short_hash(const std::string& sha256) {
  return sha256.substr(0, 16);
}

void compare(const std::string& what, const std::string& then, const std::optional<std::string>& now,
             std::vector<std::string>& changes) {
  if (then.empty() || now == then) return;
  changes.push_back(now ? fmt::format("{} differs from that of the run (SHA-256 {}..., then {}...)", what,
                                      short_hash(*now), short_hash(then))
                        : fmt::format("{} cannot be read, but the run had it", what));
}

}  // namespace

report::Provenance provenance_of(const mission::Mission& mission, const std::vector<std::string>& overrides,
                                 const std::string& mission_text) {
  report::Provenance provenance;
  provenance.vbar_version = build_version();
  provenance.commit = kBuildCommit;
  provenance.compiler = build_compiler();
  provenance.build_type = build_type();
  provenance.host = host_name();
  provenance.started_utc = utc_now();
  provenance.epoch_utc = truth::format_utc(mission.epoch);
  provenance.overrides = overrides;
  provenance.mission_sha256 = files::sha256_of(mission_text);
  provenance.program_sha256 = program_sha256().value_or("");
  const std::string file = flight_software_file(flying_spacecraft(mission));
  if (!file.empty()) provenance.flight_software = report::digest_of(file);
  return provenance;
}

std::vector<report::FileDigest> data_read() {
  const fs::path root = data_root();
  std::vector<report::FileDigest> data;
  for (const files::FileRead& read : files::files_read()) {
    const fs::path relative = read.file.lexically_relative(root);
    const bool inside = !relative.empty() && *relative.begin() != "..";
    data.push_back({inside ? relative.string() : read.file.string(), read.bytes, read.sha256});
  }
  return data;
}

std::vector<std::string> changes_since(const report::Provenance& then, const fs::path& mission_copy,
                                       const std::string& flight_software_now) {
  std::vector<std::string> changes;
  if (!then.program_sha256.empty() && program_sha256() != then.program_sha256)
    changes.push_back(
        fmt::format("this program (commit {}) is not the one that flew (commit {})", kBuildCommit, then.commit));
  compare(mission_copy.string(), then.mission_sha256, files::sha256_of_file(mission_copy), changes);
  if (then.flight_software && flight_software_now == then.flight_software->file)
    compare(flight_software_now, then.flight_software->sha256, files::sha256_of_file(flight_software_now), changes);
  for (const report::FileDigest& file : then.data)
    compare("data file " + file.file, file.sha256, files::sha256_of_file(data_root() / file.file), changes);
  return changes;
}

namespace {

using report::RunFolder;

/// Returns the part of the summary that is known before the first step.
report::Summary start_of(const mission::Mission& mission) {
  report::Summary summary;
  summary.mission = mission.name;
  summary.seed = mission.seed;
  summary.target = flying_spacecraft(mission).observes();
  for (const double hour : mission.record.samples_h) summary.samples.push_back({.time_h = hour});
  return summary;
}

/// The mission as it was flown, for a replay and a resume. Its file is the last one: where it is, the others are too.
void keep_mission(const FlightOrder& order, const std::filesystem::path& folder) {
  std::filesystem::remove(folder / kMissionCopy);
  files::replace_text_file(folder / kOverridesCopy, fmt::format("{}\n", fmt::join(order.overrides, "\n")));
  if (order.branch.empty()) {
    std::filesystem::remove(folder / kBranchCopy);
  } else {
    files::replace_text_file(folder / kBranchCopy, order.branch);
  }
  files::replace_text_file(folder / kMissionCopy, order.mission_text);
}

/// Flies and fills the record. The reason why the run is not complete, or nothing.
std::optional<std::string> fly(const FlightOrder& order, AssembledMission& assembled, RunFolder& folder,
                               report::RunRecord& record) {
  constexpr std::chrono::seconds kBetweenUpdates{1};
  const mission::Mission& mission = order.mission;
  PacketRecorders keepers(mission, folder.path(), order.check);
  const std::unique_ptr<pil::FlightComputer> flight_computer =
      connect_flight_computer(flying_spacecraft(mission), assembled.wired_receiver());
  const auto own_wall = mission::make_wall_clock(mission, sensors::installation());
  ProgressLine progress(mission.duration, order.quiet);
  auto updated = std::chrono::steady_clock::now();
  bool has_news = false;
  const auto update = [&] {
    if (!has_news || std::chrono::steady_clock::now() - updated < kBetweenUpdates) return;
    folder.update(record);
    updated = std::chrono::steady_clock::now();
    has_news = false;
  };
  std::optional<engine::ControlledWallClock> controlled;
  if (order.pace_requests) {
    const auto requests = [&] {
      update();  // the steps before a pause are seen in it
      return order.pace_requests();
    };
    controlled.emplace(*own_wall, mission.clock.speed_factor, requests, stop_requested);
  }
  engine::WallClock& wall = controlled ? *controlled : *own_wall;
  const auto after_step = [&](fsw::Duration simulated) {
    progress.update(simulated);
    if (controlled) controlled->step_has_passed(simulated);
    has_news = true;
    update();
  };
  std::optional<std::string> trouble;
  try {
    const bool complete =
        assembled.fly({*flight_computer, wall, keepers.observers(), after_step, stop_requested, folder.path()}, record);
    if (!complete) trouble = kInterruption;
    keepers.finish();
  } catch (const std::exception& error) {
    trouble = error.what();
  }
  record.summary.commands_sha256 = keepers.commands_sha256();
  record.summary.telemetry_sha256 = keepers.telemetry_sha256();
  if (!trouble) flight_computer->close();
  return trouble ? trouble : missing_output(record.summary.flight_output);
}

/// Dropped packets and refused plans are always reported.
void report_health(const report::Summary& summary, bool quiet) {
  const std::string line = summary.health ? report::health_line(*summary.health) : "";
  if (!line.empty()) fmt::print("flight software: {}{}\n", line, quiet ? "" : " (vbar explain WORD)");
  const std::string thrust = report::thrust_line(summary);
  if (!thrust.empty() && (!quiet || summary.thrust->burns_too_long > 0)) fmt::print("{}\n", thrust);
  const std::string output = report::output_line(summary);
  if (!output.empty()) fmt::print("flight software: {}\n", output);
}

/// So are packets of a sensor that were not accepted.
void report_rejections(const report::Summary& summary) {
  for (const report::SourceFigures& source : summary.sources)
    if (source.packets_rejected > 0)
      fmt::print("source {}: {} packets of impossible times or values were rejected (notes.csv)\n", source.name,
                 source.packets_rejected);
}

/// Prints what the line to the flight computer could not carry in time.
void report_line(const report::Summary::Link& link) {
  if (link.step_share_max > 1.0)
    fmt::print("link: the bytes of a step took up to {:.0f} % of its period at {} baud\n", 100.0 * link.step_share_max,
               link.baud);
}

}  // namespace

void report_before_flight(const AssembledMission& assembled) {
  for (const std::string& note : assembled.data_notes()) fmt::print("data: {}\n", note);
  if (const std::string slow = assembled.slow_line(); !slow.empty()) fmt::print("link: {}\n", slow);
}

std::unique_ptr<AssembledMission> assemble(const mission::Mission& mission, bool start) {
  try {
    auto assembled = std::make_unique<AssembledMission>(mission, mission::data_directory());
    if (start) assembled->start();
    return assembled;
  } catch (const std::runtime_error& error) {
    throw Refused(error.what());
  }
}

report::RunRecord record_at_start(const FlightOrder& order) {
  report::RunRecord record;
  record.extensions = sensors::extensions();
  record.summary = start_of(order.mission);
  record.summary.provenance = provenance_of(order.mission, order.overrides, order.mission_text);
  record.summary.provenance.data = data_read();
  return record;
}

std::optional<std::string> fly_into(RunFolder& folder, const FlightOrder& order, AssembledMission& assembled,
                                    report::RunRecord& record) {
  record.summary.data_notes = assembled.data_notes();
  if (!order.quiet) {
    report_before_flight(assembled);
    std::fflush(stdout);  // before the flight
  }
  if (!order.mission.record.tables) folder.leave_out_tables();
  keep_mission(order, folder.path());
  std::optional<std::string> trouble;
  try {
    trouble = fly(order, assembled, folder, record);
  } catch (const std::exception& error) {
    trouble = error.what();  // before the first step
  }
  record.summary.complete = !trouble;
  record.summary.incomplete_reason = trouble.value_or("");
  put_verdict(order.mission, record);
  record.summary.provenance.data = data_read();
  record.summary.provenance.packet_log = report::digest_of(folder.packet_log());
  if (auto& log = record.summary.provenance.packet_log) log->file = folder.packet_log().filename().string();
  try {
    folder.finish(record);
    return trouble;
  } catch (const std::exception& error) {
    const std::string reason = trouble ? *trouble + "; " + error.what() : error.what();
    folder.give_up(record.summary, reason);
    return reason;
  }
}

void report_flight(const std::filesystem::path& folder, const std::filesystem::path& name, const FlightOrder& order,
                   const report::RunRecord& record, const std::optional<std::string>& trouble) {
  try {
    const bool has_report = order.mission.record.tables;
    const auto write_pages = [&] {
      const view::ViewedRun run{report::run_names({name}).front(), record, &order.mission};
      return view::write_pages(folder, run, mission::data_directory());
    };
    const std::filesystem::path report = has_report ? write_pages() : folder;
    if (!order.quiet && !record.waypoints.empty()) fmt::print("{}", report::waypoint_table(record));
    report_health(record.summary, order.quiet);
    report_rejections(record.summary);
    report_line(record.summary.link);
    if (has_report && !order.quiet) fmt::print("report  {}\n", (name / report.filename()).string());
  } catch (const std::exception&) {
    if (!trouble) throw;  // the record is complete, its report is not
  }
  for (const report::FaultRow& fault : record.faults) {
    if (!fault.begin_s) {
      fmt::print("fault \"{}\" never began: {} did not happen\n", fault.name, fault.event);
    } else if (!fault.effect_s) {
      fmt::print("fault \"{}\" never took effect\n", fault.name);
    }
  }
}

int exit_code_of(const report::RunRecord& record, const std::optional<std::string>& trouble,
                 const std::filesystem::path& name, bool quiet) {
  if (trouble) {
    files::print_error("vbar", fmt::format("{}: run incomplete: {}", name.string(), *trouble));
    return *trouble == kInterruption ? kInterrupted : kFailed;
  }
  const std::string line = report::verdict_line(record.summary);
  const report::Outcome outcome = report::outcome_of(record.summary.verdict);
  if (report::is_favourable(outcome)) {
    if (!quiet) fmt::print("verdict {}\n", line);
    return kDone;
  }
  std::fflush(stdout);  // the verdict is the last line
  files::print_error("vbar", fmt::format("{}: {}", name.string(), line));
  return outcome == report::Outcome::kNeverNavigated ? kNeverNavigated : kNotAchieved;
}

}  // namespace vbar::app
