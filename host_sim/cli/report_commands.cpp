// vbar report: one run, or several side by side. vbar view: one run over time, or several over each other.

#include <algorithm>
#include <deque>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "host_sim/cli/commands.h"
#include "host_sim/cli/verdicts.h"
#include "host_sim/files/output_file.h"
#include "host_sim/files/text_lines.h"
#include "host_sim/installation/sensor_kinds.h"
#include "host_sim/mission/data_file.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/sections/comparison.h"
#include "host_sim/report/sections/html_report.h"
#include "host_sim/report/summarise.h"
#include "host_sim/report/verdict.h"
#include "host_sim/sensors/installed_testbeds.h"
#include "host_sim/simulation/exit_codes.h"
#include "host_sim/simulation/recorded_mission.h"
#include "host_sim/view/view_page.h"

namespace vbar::app {

namespace {

/// A run as its tables have it.
report::RunRecord read_run(const std::filesystem::path& folder) {
  report::RunRecord record = report::read_run(folder, sensors::extensions());
  for (const report::SourceFigures& source : record.summary.sources) testbeds::require_driver(source.kind);
  for (const std::string& note : record.reading_notes) files::print_error("vbar", note);
  return record;
}

/// The same with figures computed from the tables.
report::RunRecord evaluated_run(const std::filesystem::path& folder) {
  report::RunRecord record = read_run(folder);
  report::evaluate(record);
  const std::string health = record.summary.health ? report::health_line(*record.summary.health) : "";
  if (!health.empty()) fmt::print("flight software: {}\n", health);
  return record;
}

/// The mission of a run folder; nothing, and the reason as a note, where this program cannot read it.
std::optional<mission::Mission> mission_of_run(const std::filesystem::path& folder, std::string& note) {
  try {
    return sensors::load_mission(folder / kMissionCopy, overrides_of_run(folder));
  } catch (const std::runtime_error& error) {
    note = error.what();
    return std::nullopt;
  }
}

int report_one(const std::filesystem::path& folder) {
  const report::RunRecord record = evaluated_run(folder);
  std::string note;
  const std::optional<mission::Mission> mission = mission_of_run(folder, note);
  const view::ViewedRun run{report::run_names({folder}).front(), record, mission ? &*mission : nullptr, note};
  const std::filesystem::path file = view::write_pages(folder, run, mission::data_directory());
  fmt::print("{}report  {}\n", report::waypoint_table(record), file.string());
  if (record.summary.complete && !record.summary.verdict_reason.empty())
    fmt::print("verdict {}\n", report::verdict_line(record.summary));
  return 0;
}

}  // namespace

int report_command(const ReportOptions& options) {
  const auto& [run_folders, out, fail_if_different] = options;
  if (run_folders.size() == 1 && out.empty()) return report_one(run_folders.front());
  std::vector<report::ComparedRun> runs;
  const std::vector<std::string> names = report::run_names(run_folders);
  for (std::size_t k = 0; k < names.size(); ++k) runs.push_back({names[k], evaluated_run(run_folders[k])});
  const std::filesystem::path file = out.empty() ? run_folders.front().parent_path() / "comparison.html" : out;
  report::write_html_comparison(file, runs);
  fmt::print("{}report  {}\n", report::comparison_table(runs), file.string());
  const auto same_as_first = [&](const report::ComparedRun& run) {
    return report::same_outputs(runs.front().record.summary, run.record.summary);
  };
  return fail_if_different && !std::ranges::all_of(runs, same_as_first) ? kDifferent : kDone;
}

namespace {

int view_propagation(const std::filesystem::path& folder, const ViewOptions& options) {
  if (options.run_folders.size() > 1)
    throw Refused(fmt::format("{}: holds a propagation; accepted: one propagation alone, or runs", folder.string()));
  const std::filesystem::path file = options.out.empty() ? report::view_file(folder) : options.out;
  files::replace_text_file(file, view::propagation_page(folder, report::run_names({folder}).front()));
  fmt::print("view    {}\n", file.string());
  return kDone;
}

}  // namespace

int view_command(const ViewOptions& options) {
  if (view::page_template().empty()) throw Refused(view::kHowToGetPage);
  const auto propagation = std::ranges::find_if(options.run_folders, view::is_propagation);
  if (propagation != options.run_folders.end()) return view_propagation(*propagation, options);
  const std::vector<std::string> names = report::run_names(options.run_folders);
  std::deque<report::RunRecord> records;
  std::deque<std::optional<mission::Mission>> missions;
  std::vector<view::ViewedRun> runs;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::filesystem::path& folder = options.run_folders[k];
    std::string note;
    const report::RunRecord& record = records.emplace_back(read_run(folder));
    const std::optional<mission::Mission>& mission = missions.emplace_back(mission_of_run(folder, note));
    if (!note.empty()) files::print_error("vbar", note);
    runs.push_back({names[k], record, mission ? &*mission : nullptr, note});
  }
  const std::filesystem::path& first = options.run_folders.front();
  const std::filesystem::path of_runs = report::view_file(names.size() == 1 ? first : first.parent_path());
  const std::filesystem::path file = options.out.empty() ? of_runs : options.out;
  view::write_view(file, runs, mission::data_directory());
  fmt::print("view    {}\n", file.string());
  return kDone;
}

// vbar check: the limits of a mission against runs of it.

namespace {

namespace fs = std::filesystem;

int print_numbers(const std::vector<fs::path>& run_folders) {
  for (const fs::path& folder : run_folders)
    for (const auto& [key, value] : campaign::numbers_of(summary_json_of(folder)))
      fmt::print("{} = {:g}\n", key, value);
  return kDone;
}

}  // namespace

int check_command(const CheckOptions& options) {
  if (options.numbers) return print_numbers(options.run_folders);
  bool passed = true;
  std::vector<check::JunitSuite> suites;
  for (const fs::path& folder : options.run_folders) {
    CheckedRun run = checked_run(folder, options.limits);
    passed = passed && run.passed;
    suites.push_back(std::move(run.suite));
  }
  if (!options.junit.empty()) files::replace_text_file(options.junit, check::junit_xml(suites));
  return passed ? kDone : kLimitMissed;
}

}  // namespace vbar::app
