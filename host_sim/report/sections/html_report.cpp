#include "host_sim/report/sections/html_report.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "host_sim/files/output_file.h"
#include "host_sim/report/extension.h"
#include "host_sim/report/plots/html_page.h"
#include "host_sim/report/plots/number_text.h"
#include "host_sim/report/run_folder.h"
#include "host_sim/report/run_series.h"
#include "host_sim/report/sections/sections.h"
#include "host_sim/report/words.h"

namespace vbar::report {

namespace {

std::optional<double> millimetres(const std::optional<double>& metres) {
  return metres ? std::optional(1e3 * *metres) : std::nullopt;
}

}  // namespace

std::string waypoint_table(const RunRecord& record) {
  constexpr auto kHead = "{:>8} {:>9} {:>14} {:>17} {:>17} {:>12} {:>12} {:>10}\n";
  std::string text;
  for (const std::string& testbed : emulated_testbeds(record.summary))
    text += fmt::format("figures of an emulated bench: the testbed {} was emulated\n", testbed);
  text +=
      fmt::format(kHead, "", "time", "control error", "navigation error", "velocity error", "leg dv", "total dv", "");
  text += fmt::format(kHead, "waypoint", "h", "m", "m", "mm/s", "m/s", "m/s", "maneuvers");
  for (const WaypointRow& row : record.waypoints) {
    const bool is_first = is_start(record, row);
    const std::optional<double> control_error_m = is_first ? std::nullopt : std::optional(row.control_error_m);
    text += fmt::format("{:>8} {:>9.3f} {:>14} {:>17} {:>17} {:>12.6f} {:>12.6f} {:>10}\n",
                        is_first ? fmt::format("start {}", row.index) : std::to_string(row.index), row.time_s / 3600.0,
                        fixed(control_error_m, 4), fixed(row.navigation_error_m, 4),
                        fixed(millimetres(row.navigation_velocity_error_mps), 4), row.leg_dv_mps, row.cumulative_dv_mps,
                        row.leg_maneuvers);
  }
  const Summary& s = record.summary;
  text += fmt::format("{:>8} {:>9.3f} {:>14} {:>17} {:>17} {:>12} {:>12.6f} {:>10}\n", s.complete ? "all" : "stopped",
                      s.simulated_s / 3600.0, "", "", "", "", s.dv_mps, s.maneuvers);
  return text;
}

std::string html_report(const RunRecord& record, std::string_view note) {
  std::vector<Section> sections{glance_section(record),     faults_section(record),   waypoint_section(record),
                                trajectory_section(record), elements_section(record), maneuver_section(record),
                                navigation_section(record)};
  for (const Extension* extension : record.extensions) {
    if (extension->sections == nullptr) continue;
    for (Section& section : extension->sections(record)) sections.push_back(std::move(section));
  }
  for (auto* const section : {attitude_section, guidance_section, health_section, computer_section, flown_section})
    sections.push_back(section(record));
  std::string body = overview(record);
  if (!note.empty()) body += fmt::format("<p>{}</p>\n", note);
  body += contents(sections);
  for (const Section& section : sections) body += section_html(section);
  return html_page(fmt::format("{} (seed {})", record.summary.mission, record.summary.seed), body);
}

std::filesystem::path write_html_report(const std::filesystem::path& run_folder, const RunRecord& record,
                                        std::string_view note) {
  std::filesystem::path file = report_file(run_folder);
  files::replace_text_file(file, html_report(record, note));
  return file;
}

namespace {

using Runs = std::span<const ComparedRun>;

// Later runs are drawn on top of earlier ones, thin on broad, so that equal runs can be seen to be equal.
Mark mark_of(std::size_t run) {
  return run == 0 ? Mark::kBroadLine : Mark::kLine;
}
int colour_of(std::size_t run) {
  return static_cast<int>(run % 5);
}

/// The run that came farthest sets what is drawn.
const RunRecord& longest(Runs runs) {
  return std::ranges::max_element(runs, {}, [](const ComparedRun& run) { return run.record.summary.simulated_s; })
      ->record;
}

std::string verdict(Runs runs) {
  if (runs.size() < 2) return {};
  const Summary& first = runs.front().record.summary;
  const auto holds_for_all = [&](const auto& relation) {
    return std::ranges::all_of(runs, [&](const ComparedRun& run) { return relation(first, run.record.summary); });
  };
  if (holds_for_all(same_outputs)) {
    return "<p><span class=\"status good\">same bits</span> All runs gave the same maneuver commands and "
           "telemetry.</p>\n";
  }
  if (!holds_for_all(expect_same_outputs))
    return "<p>The runs are of different missions or seeds; their outputs are not expected to be the same.</p>\n";
  return "<p><span class=\"status bad\">different</span> Not all runs gave the same maneuver commands and telemetry, "
         "although mission and seed are the same. Runs with different settings are expected to differ.</p>\n";
}

/// A run that was stopped must not be read as one that came to its end.
std::string incomplete_runs(Runs runs) {
  std::string text;
  for (const ComparedRun& run : runs) {
    const Summary& s = run.record.summary;
    if (s.complete) continue;
    text += fmt::format(
        "<p><span class=\"status bad\">incomplete</span> {}: {}. Its figures are those of the {} flown.</p>\n",
        escaped(run.name), escaped(s.incomplete_reason), duration_text(s.simulated_s));
  }
  return text;
}

std::string emulated_benches(Runs runs) {
  std::string text;
  for (const ComparedRun& run : runs)
    for (const std::string& testbed : emulated_testbeds(run.record.summary))
      text += fmt::format(
          "<p><span class=\"status\">emulated bench</span> {}: the testbed {} is emulated. Programs on this computer "
          "use the wire protocols of its hardware; docs/{}.md states what this does not prove.</p>\n",
          escaped(run.name), escaped(testbed), escaped(testbed));
  return text;
}

Section metrics(Runs runs) {
  std::vector<Column> columns{{"", false}};
  for (const std::string& name : column_names(runs)) columns.push_back({name});
  std::vector<std::vector<std::string>> rows;
  for (const ComparisonRow& row : comparison_rows(runs)) {
    std::vector<std::string>& cells = rows.emplace_back();
    cells.push_back(row.name);
    cells.insert(cells.end(), row.cells.begin(), row.cells.end());
  }
  return {"Performance", table(columns, rows)};
}

Plot delta_v_plot(Runs runs, const View& view, const std::string& name) {
  Plot plot = time_plot(view, "Cumulative delta-v, " + name, "delta-v", Unit::kMetresPerSecond, 260.0);
  double most = 0.0;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    std::vector<Point> points = stairs(cumulative_dv(executed_in_order(runs[k].record), view));
    most = std::max(most, points.back().y);
    plot.series.push_back({runs[k].name, colour_of(k), mark_of(k), std::move(points)});
  }
  plot.y.range = from_zero_to(most);
  return plot;
}

Section delta_v(Runs runs) {
  const RunRecord& shown = longest(runs);
  std::vector<Plot> plots{delta_v_plot(runs, whole_run(shown), "whole run")};
  const std::vector<View> views = mission_views(shown);
  if (views.size() > 1) plots.push_back(delta_v_plot(runs, views.back(), views.back().name));
  return {"Delta-v", plot_rows(2, std::move(plots))};
}

Plot element_plot(Runs runs, const View& view, std::size_t element) {
  const char* const name = kElementNames[element];
  Plot plot = time_plot(view, fmt::format("{}, {}", name, view.name), name, Unit::kMetres, 220.0);
  plot.y.min_span = kMinElementSpan_m;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    plot.series.push_back(
        {runs[k].name, colour_of(k), mark_of(k),
         over_time(runs[k].record.truth, view, [element](const TruthRow& row) { return row.a_roe_mean_m[element]; })});
  }
  return plot;
}

Section elements(Runs runs) {
  const std::vector<View> views = mission_views(longest(runs));
  std::vector<Plot> plots;
  for (std::size_t element = 0; element < kElementNames.size(); ++element) {
    for (const View& view : views) plots.push_back(element_plot(runs, view, element));
  }
  return {"True relative orbital elements", plot_rows(columns_for(views.size()), std::move(plots))};
}

}  // namespace

std::string html_comparison(Runs runs) {
  std::string names;
  for (const ComparedRun& run : runs) names += (names.empty() ? "" : " | ") + run.name;
  std::string body = fmt::format("<h1>Runs side by side</h1>\n<p class=\"lead\">{}</p>\n", escaped(names)) +
                     verdict(runs) + incomplete_runs(runs) + emulated_benches(runs);
  for (const Section& section : {metrics(runs), delta_v(runs), elements(runs)}) body += section_html(section);
  return html_page(names, body);
}

void write_html_comparison(const std::filesystem::path& file, Runs runs) {
  files::replace_text_file(file, html_comparison(runs));
}

}  // namespace vbar::report
