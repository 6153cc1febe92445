#include "host_sim/app/recorded_flight.h"

#include <chrono>
#include <cstdio>

#include <fmt/format.h>

#include "host_sim/app/connect_flight_computer.h"
#include "host_sim/app/exit_codes.h"
#include "host_sim/app/flown_from.h"
#include "host_sim/app/flown_mission.h"
#include "host_sim/app/mission_verdict.h"
#include "host_sim/app/packet_keepers.h"
#include "host_sim/app/progress.h"
#include "host_sim/app/stop_request.h"
#include "host_sim/mission/data_directory.h"
#include "host_sim/report/html_report.h"
#include "host_sim/report/summarise.h"
#include "host_sim/report/text_file.h"
#include "host_sim/report/thrust.h"
#include "host_sim/report/verdict.h"
#include "host_sim/report/waypoint_table.h"
#include "host_sim/sensors/sensor_kinds.h"

namespace vbar::app {
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
  PacketKeepers keepers(mission, folder.path(), order.check);
  const std::unique_ptr<pil::FlightComputer> flight_computer =
      connect_flight_computer(flying_spacecraft(mission), assembled.wired_receiver());
  const auto wall = mission::make_wall_clock(mission, sensors::installation());
  ProgressLine progress(mission.duration, order.quiet);
  auto updated = std::chrono::steady_clock::now();
  const auto after_step = [&](fsw::Duration simulated) {
    progress.update(simulated);
    if (std::chrono::steady_clock::now() - updated < kBetweenUpdates) return;
    folder.update(record);
    updated = std::chrono::steady_clock::now();
  };
  std::optional<std::string> trouble;
  try {
    const bool complete = assembled.fly(
        {*flight_computer, *wall, keepers.observers(), after_step, stop_requested, folder.path()}, record);
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

/// Prints what the line to the flight computer cannot carry in time, as known before the flight and as measured.
void report_line(const std::string& slow_line) {
  if (!slow_line.empty()) fmt::print("link: {}\n", slow_line);
}
void report_line(const report::Summary::Link& link) {
  if (link.step_share_max > 1.0)
    fmt::print("link: the bytes of a step took up to {:.0f} % of its period at {} baud\n", 100.0 * link.step_share_max,
               link.baud);
}

}  // namespace

void report_data(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) fmt::print("data: {}\n", note);
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
    report_data(record.summary.data_notes);
    report_line(assembled.slow_line());
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
    const std::filesystem::path report = has_report ? report::write_html_report(folder, record) : folder;
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
    fmt::print(stderr, "vbar: {}: run incomplete: {}\n", name.string(), *trouble);
    return *trouble == kInterruption ? kInterrupted : kFailed;
  }
  const std::string line = report::verdict_line(record.summary);
  const report::Outcome outcome = report::outcome_of(record.summary.verdict);
  if (report::is_favourable(outcome)) {
    if (!quiet) fmt::print("verdict {}\n", line);
    return kDone;
  }
  std::fflush(stdout);  // the verdict is the last line
  fmt::print(stderr, "vbar: {}: {}\n", name.string(), line);
  return outcome == report::Outcome::kNeverNavigated ? kNeverNavigated : kNotAchieved;
}

}  // namespace vbar::app
