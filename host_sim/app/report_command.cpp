// vbar report: one run, or several side by side.

#include <algorithm>

#include <fmt/core.h>

#include "host_sim/app/commands.h"
#include "host_sim/app/exit_codes.h"
#include "host_sim/report/compare_report.h"
#include "host_sim/report/comparison.h"
#include "host_sim/report/html_report.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/waypoint_table.h"

namespace vbar::app {
namespace {

/// "runs/a" and "runs/a/" are both called "a".
std::string name_of(const std::filesystem::path& folder) {
  const std::filesystem::path absolute = std::filesystem::weakly_canonical(folder);
  return absolute.filename().string();
}

int report_one(const std::filesystem::path& folder) {
  const report::RunRecord record = report::read_run(folder);
  fmt::print("{}report  {}\n", report::waypoint_table(record), report::write_html_report(folder, record).string());
  return 0;
}

}  // namespace

int report_command(const ReportOptions& options) {
  const auto& [run_folders, out, fail_if_different] = options;
  if (run_folders.size() == 1 && out.empty()) return report_one(run_folders.front());
  std::vector<report::ComparedRun> runs;
  for (const std::filesystem::path& folder : run_folders) runs.push_back({name_of(folder), report::read_run(folder)});
  const std::filesystem::path file = out.empty() ? run_folders.front().parent_path() / "comparison.html" : out;
  report::write_html_comparison(file, runs);
  fmt::print("{}report  {}\n", report::comparison_table(runs), file.string());
  const auto same_as_first = [&](const report::ComparedRun& run) {
    return report::same_outputs(runs.front().record.summary, run.record.summary);
  };
  return fail_if_different && !std::ranges::all_of(runs, same_as_first) ? kDifferent : kDone;
}

}  // namespace vbar::app
