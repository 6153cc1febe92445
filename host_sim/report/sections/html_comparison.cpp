// Several runs on one page: their figures side by side, and their flights over each other.

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "host_sim/files/output_file.h"
#include "host_sim/report/plots/html_page.h"
#include "host_sim/report/plots/number_text.h"
#include "host_sim/report/run_series.h"
#include "host_sim/report/sections/html_report.h"
#include "host_sim/report/sections/sections.h"
#include "host_sim/report/statistics.h"
#include "host_sim/report/words.h"

namespace vbar::report {

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

/// A curve of each run over the time of a view, on a logarithmic axis of metres.
template <class Curve>
Plot overlay(Runs runs, const View& view, const char* title, const char* quantity, const Curve& curve) {
  Plot plot = time_plot(view, fmt::format("{}, {}", title, view.name), quantity, Unit::kMetres, 260.0);
  plot.y.logarithmic = true;
  for (std::size_t k = 0; k < runs.size(); ++k)
    plot.series.push_back({runs[k].name, colour_of(k), mark_of(k), curve(runs[k].record)});
  return plot;
}

bool is_empty(const Plot& plot) {
  return std::ranges::all_of(plot.series, [](const Series& series) { return series.points.empty(); });
}

/// How far, and how well known, over the whole run and its last part.
Section flights(Runs runs) {
  const RunRecord& shown = longest(runs);
  std::vector<View> views{whole_run(shown)};
  views.front().name = "whole run";
  if (const std::vector<View> parts = mission_views(shown); parts.size() > 1) views.push_back(parts.back());
  std::vector<Plot> plots;
  for (const View& view : views)
    plots.push_back(overlay(runs, view, "Distance to the target", "distance", [&](const RunRecord& record) {
      return over_time(record.truth, view, [](const TruthRow& row) { return magnitude(row.relative_position_rtn); });
    }));
  for (const View& view : views)
    plots.push_back(overlay(runs, view, "Error of the relative position", "error", [&](const RunRecord& record) {
      return over_time(navigation_errors(record), view,
                       [](const NavigationError& e) { return magnitude(e.position_rtn); });
    }));
  std::erase_if(plots, is_empty);
  return {"Flights over each other", plots.empty() ? "" : plot_rows(2, std::move(plots))};
}

/// The true paths in the planes of the servicer's RTN frame, in each part of the approach.
Section trajectories(Runs runs) {
  std::vector<Plot> plots;
  for (const View& view : mission_views(longest(runs)))
    for (const RtnPlane& plane : kRtnPlanes) {
      Plot plot = plane_plot(view, plane);
      for (std::size_t k = 0; k < runs.size(); ++k)
        plot.series.push_back({runs[k].name, colour_of(k), mark_of(k), path_in(plane, view, runs[k].record)});
      if (!is_empty(plot)) plots.push_back(std::move(plot));
    }
  return {"Trajectories", plots.empty()
                              ? ""
                              : "<p class=\"note\">True positions of the target in the servicer's RTN frame.</p>\n" +
                                    plot_rows(3, std::move(plots))};
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
  for (const Section& section : {flights(runs), metrics(runs), trajectories(runs), delta_v(runs), elements(runs)})
    body += section_html(section);
  return html_page(names, body);
}

void write_html_comparison(const std::filesystem::path& file, Runs runs) {
  files::replace_text_file(file, html_comparison(runs));
}

}  // namespace vbar::report
