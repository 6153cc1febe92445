#include "hil_drivers/tron/tron_report.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "hil_drivers/common/testbed_facts.h"
#include "host_sim/report/sections/sections.h"
#include "host_sim/report/statistics.h"

namespace vbar::tron {
namespace {

using report::Mark;
using report::Plot;
using report::RunRecord;
using report::TestbedFigures;
using report::Unit;

constexpr const char* kName = "tron";

struct WallClockPart {
  const char* name;
  double TronRow::*value_s;
};
constexpr std::array<WallClockPart, 4> kWallClock{{{"placement and path", &TronRow::plan_wall_s},
                                                   {"motion and measurement of the pose", &TronRow::move_wall_s},
                                                   {"exposure and transfer", &TronRow::expose_wall_s},
                                                   {"binning, mask and light", &TronRow::mask_wall_s}}};

using Quantity = std::optional<double> TronRow::*;

std::vector<double> sorted_values(const std::vector<TronRow>& rows, Quantity quantity) {
  std::vector<double> values;
  for (const TronRow& row : rows)
    if (row.*quantity) values.push_back(*(row.*quantity));
  std::ranges::sort(values);
  return values;
}

void add_quantiles(const std::vector<TronRow>& rows, const char* name, const char* unit, Quantity quantity,
                   TestbedFigures& figures) {
  const std::vector<double> values = sorted_values(rows, quantity);
  if (values.empty()) return;
  figures[fmt::format("{}_median{}", name, unit)] = report::quantile(values, 0.5);
  figures[fmt::format("{}_95{}", name, unit)] = report::quantile(values, 0.95);
}

bool is_taken(const TronRow& row) {
  return row.failure.empty();
}

bool is_lit(const TronRow& row) {
  return row.lamp_power > 0.0;
}

std::string wall_clock_table(const RunRecord& record) {
  const auto& rows = record.tables.rows<TronRow>();
  std::vector<std::vector<std::string>> cells;
  for (const WallClockPart& part : kWallClock) {
    std::vector<double> values;
    for (const TronRow& row : rows) values.push_back(row.*part.value_s);
    std::ranges::sort(values);
    cells.push_back({part.name, fmt::format("{:.1f}", 1e3 * report::quantile(values, 0.5)),
                     fmt::format("{:.1f}", 1e3 * report::quantile(values, 0.95)),
                     fmt::format("{:.1f}", 1e3 * values.back()),
                     fmt::format("{:.1f}", std::accumulate(values.begin(), values.end(), 0.0))});
  }
  const auto& share = record.summary.wall_share;
  for (const auto& [name, total_s] : {std::pair{"flight software", share.flight_s}, std::pair{"truth", share.truth_s},
                                      std::pair{"whole run", record.summary.wall_s}})
    cells.push_back({name, "", "", "", fmt::format("{:.1f}", total_s)});
  return report::table({{"wall clock"}, {"median (ms)"}, {"95 % (ms)"}, {"longest (ms)"}, {"sum (s)"}}, cells);
}

/// Images that were not taken, by their reason.
std::string failure_table(const std::vector<TronRow>& rows) {
  std::map<std::string, int> reasons;
  for (const TronRow& row : rows)
    if (!is_taken(row)) ++reasons[row.failure];
  if (reasons.empty()) return "";
  std::vector<std::vector<std::string>> cells;
  for (const auto& [reason, count] : reasons) cells.push_back({reason, std::to_string(count)});
  return report::table({{"no image because"}, {"images"}}, cells);
}

Plot plot_of(const RunRecord& record, const report::View& view, const char* title, const char* quantity,
             Quantity value) {
  Plot plot = report::time_plot(view, title, quantity, Unit::kNone);
  std::vector<TronRow> rows;
  for (const TronRow& row : record.tables.rows<TronRow>())
    if (row.*value) rows.push_back(row);
  plot.series = {
      {quantity, 0, Mark::kDots, report::over_time(rows, view, [&](const TronRow& row) { return *(row.*value); })}};
  return plot;
}

}  // namespace

std::vector<report::TableKind> tables() {
  return {report::table_of_extension<TronRow>("tron.csv")};
}

void add_figures(const RunFigures& run, RunRecord& record) {
  TestbedFigures& figures = record.summary.testbeds[kName];
  figures["bench"] = std::string(run.is_emulated ? "emulated" : "hardware");
  figures["clock"] = run.clock;
  figures["camera"] = run.camera;
  for (const auto& [name, value] : run.devices) figures[name] = value;
  for (const auto& [name, value] : run.calibration) figures["calibration_" + name] = value;
  for (const auto& [kind, count] : run.faults) figures["faults_" + kind] = static_cast<double>(count);
  for (const auto& file : run.files)
    if (auto digest = report::digest_of(file)) record.summary.provenance.testbed.push_back(std::move(*digest));
  for (const report::FileDigest& file : run.bench_files) record.summary.provenance.testbed.push_back(file);
}

void summarise(const RunRecord& record, report::Summary& summary) {
  const auto& rows = record.tables.rows<TronRow>();
  if (rows.empty()) return;
  TestbedFigures& figures = summary.testbeds[kName];
  double failed = 0.0, lit = 0.0, hidden = 0.0, shaded = 0.0, corrected = 0.0, arms_alone = 0.0, retried = 0.0,
         resent = 0.0;
  std::vector<double> bench_s;
  for (const TronRow& row : rows) {
    failed += is_taken(row) ? 0.0 : 1.0;
    resent += static_cast<double>(row.packets_resent);
    retried += row.tries > 1 ? 1.0 : 0.0;
    if (!is_lit(row)) continue;
    lit += 1.0;
    hidden += row.hidden > 0 ? 1.0 : 0.0;
    shaded += row.shaded > 0 ? 1.0 : 0.0;
    corrected += row.moves > 1 ? 1.0 : 0.0;
    arms_alone += row.pose_source == "arms" ? 1.0 : 0.0;
    bench_s.push_back(row.bench_s);
  }
  figures["images"] = static_cast<double>(rows.size());
  figures["images_not_taken"] = failed;
  figures["images_lit"] = lit;
  figures["images_with_hidden_points"] = hidden;
  figures["images_with_shadow_of_an_arm"] = shaded;
  figures["poses_corrected"] = corrected;
  figures["poses_by_arms_alone"] = arms_alone;
  figures["images_retried"] = retried;
  figures["packets_resent"] = resent;
  if (!bench_s.empty()) {
    std::ranges::sort(bench_s);
    figures["bench_time_median_s"] = report::quantile(bench_s, 0.5);
    figures["bench_time_95_s"] = report::quantile(bench_s, 0.95);
    figures["bench_time_sum_min"] = std::accumulate(bench_s.begin(), bench_s.end(), 0.0) / 60.0;
  }
  add_quantiles(rows, "first_error", "_mm", &TronRow::first_error_mm, figures);
  add_quantiles(rows, "first_error", "_deg", &TronRow::first_error_deg, figures);
  add_quantiles(rows, "pose_error", "_mm", &TronRow::pose_error_mm, figures);
  add_quantiles(rows, "pose_error", "_deg", &TronRow::pose_error_deg, figures);
  add_quantiles(rows, "sun_error", "_deg", &TronRow::sun_error_deg, figures);
  add_quantiles(rows, "earth_light_misfit", "", &TronRow::earth_light_misfit, figures);
  add_quantiles(rows, "light_level", "", &TronRow::light_level, figures);
}

std::vector<report::Section> sections(const RunRecord& record) {
  const auto found = record.summary.testbeds.find(kName);
  if (found == record.summary.testbeds.end()) return {};
  const TestbedFigures& figures = found->second;
  std::string content = fmt::format(
      "<p class=\"note\">{} Lengths are those of the laboratory, half of those in orbit. Pose errors are measured "
      "poses less commanded ones.</p>\n",
      testbeds::text_of(figures, "bench") == "emulated"
          ? "Robots, lamp, light boxes, motion capture and camera of this run were an emulated bench: another process "
            "that uses the wire protocols of the hardware. No hardware was used."
          : "The camera of this run does not name itself an emulator: robots, lights, motion capture and camera are "
            "those at the addresses of the mission.");
  content += report::fact_list(testbeds::facts_of(figures));
  const auto& rows = record.tables.rows<TronRow>();
  if (!rows.empty()) {
    content += failure_table(rows);
    content += wall_clock_table(record);
    const report::View view = report::whole_run(record);
    content += report::plot_rows(
        2,
        {plot_of(record, view, "Pose after correction", "measured less commanded (mm)", &TronRow::pose_error_mm),
         plot_of(record, view, "Attitude after correction", "measured less commanded (deg)", &TronRow::pose_error_deg),
         plot_of(record, view, "Arms against motion capture", "chi-square of 6", &TronRow::disagreement),
         plot_of(record, view, "Light of the target", "relative to the prediction", &TronRow::light_level)});
  }
  return {{"TRON", content, {"tron.csv"}}};
}

}  // namespace vbar::tron
