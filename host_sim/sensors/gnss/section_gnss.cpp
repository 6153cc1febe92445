#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "host_sim/report/plots/html_page.h"
#include "host_sim/report/plots/number_text.h"
#include "host_sim/report/published_figures.h"
#include "host_sim/report/run_series.h"
#include "host_sim/report/sections/sections.h"
#include "host_sim/report/statistics.h"
#include "host_sim/sensors/gnss/gnss_kind.h"
#include "host_sim/sensors/gnss/gnss_rows.h"

namespace vbar::sensors {
namespace {

using namespace report;  // NOLINT(google-build-using-namespace): a section is made of its parts

constexpr double kMillimetres = 1e3;

// ------------------------------------------------------------------------------------------------- table of the paper

std::optional<double> in_millimetres(const std::optional<double>& value) {
  return value ? std::optional(kMillimetres * *value) : std::nullopt;
}

std::string maneuvers(double dv_mps, int count) {
  return fmt::format("{} in {} maneuvers", fixed(kMillimetres * dv_mps, 3), count);
}

/// A row of the table: a value at each waypoint and one of the whole run, of the run and of the paper.
struct Metric {
  std::string name;
  std::function<std::optional<double>(const WaypointRow&)> value;
  std::function<std::optional<double>(const paper3::Figures&)> papers_value;
  std::string whole;
  std::function<std::string(const paper3::Totals&)> papers_whole;
};

std::vector<Metric> metrics(const Summary& s) {
  return {
      {"navigation error, mm", [](const WaypointRow& row) { return in_millimetres(row.navigation_error_m); },
       [](const paper3::Figures& paper) { return in_millimetres(paper.navigation_error_m); },
       plus_minus(s.navigation_error_m, 3, kMillimetres),
       [](const paper3::Totals& paper) { return plus_minus(paper.navigation_error_m, 3, kMillimetres); }},
      {"navigation velocity error, mm/s",
       [](const WaypointRow& row) { return in_millimetres(row.navigation_velocity_error_mps); },
       [](const paper3::Figures& paper) { return in_millimetres(paper.navigation_velocity_error_mps); },
       plus_minus(s.navigation_velocity_error_mps, 3, kMillimetres),
       [](const paper3::Totals& paper) { return plus_minus(paper.navigation_velocity_error_mps, 3, kMillimetres); }},
      {"control error, m", [](const WaypointRow& row) { return row.control_error_m; },
       [](const paper3::Figures& paper) { return paper.control_error_m; }, "",
       [](const paper3::Totals&) { return std::string(); }},
      {"cumulative delta-v, mm/s", [](const WaypointRow& row) { return kMillimetres * row.cumulative_dv_mps; },
       [](const paper3::Figures&) { return std::nullopt; }, maneuvers(s.dv_mps, s.maneuvers),
       [](const paper3::Totals& paper) { return maneuvers(paper.dv_mps, paper.maneuvers); }}};
}

std::vector<std::string> papers_row(const std::vector<WaypointRow>& waypoints, const Metric& metric, const char* name,
                                    const paper3::Figures paper3::Loops::*loop, const paper3::Totals& totals) {
  std::vector<std::string> cells{"", name};
  for (const WaypointRow& row : waypoints) {
    const paper3::Loops* const same = at_waypoint(paper3::kWaypoints, row);
    cells.push_back(fixed(same != nullptr ? metric.papers_value(same->*loop) : std::nullopt, 3));
  }
  cells.push_back(metric.papers_whole(totals));
  return cells;
}

/// The paper's figures are printed below those of a run that meets its waypoints.
std::string performance_table(const RunRecord& record) {
  const std::vector<WaypointRow> waypoints = reached_waypoints(record);
  std::vector<Column> columns{{"", false}, {"", false}};
  for (const WaypointRow& row : waypoints) columns.push_back({fmt::format("waypoint {}", row.index)});
  columns.push_back({"whole run, mean ± std"});

  std::vector<std::vector<std::string>> rows;
  for (const Metric& metric : metrics(record.summary)) {
    std::vector<std::string>& run = rows.emplace_back();
    run = {metric.name, kThisRun};
    for (const WaypointRow& row : waypoints) run.push_back(fixed(metric.value(row), 3));
    run.push_back(metric.whole);
    if (!meets_paper(paper3::kWaypoints, waypoints)) continue;
    rows.push_back(papers_row(waypoints, metric, kPaperSoftware, &paper3::Loops::software, paper3::kSoftware));
    rows.push_back(papers_row(waypoints, metric, kPaperHardware, &paper3::Loops::hardware, paper3::kHardware));
  }
  return table(columns, rows);
}

PaperColumn paper_column(const char* name, const paper3::Figures paper3::Loops::*loop, const paper3::Totals& totals) {
  const auto at = [loop](const WaypointRow& row) -> PaperColumn::AtWaypoint {
    const paper3::Loops* const same = at_waypoint(paper3::kWaypoints, row);
    if (same == nullptr) return {};
    const paper3::Figures& figures = same->*loop;
    return {figures.control_error_m, figures.navigation_error_m, figures.navigation_velocity_error_mps};
  };
  return {name, at, totals.navigation_error_m, totals.navigation_velocity_error_mps, totals.dv_mps, totals.maneuvers};
}

// ----------------------------------------------------------------------------------------------------------- in words

std::string percent(double share) {
  return fmt::format("{} %", fixed(100.0 * share, 1));
}

/// Normalised innovations of one epoch of one kind of measurement.
struct EpochNis {
  double time_s = 0.0;
  double nis = 0.0;  ///< over the number of measurements
  std::size_t measurements = 0;
  Range band;  ///< 95 % band of the distribution
};

struct NisKind {
  const char* name;
  std::int32_t GnssRow::*used;
  double GnssRow::*sum;
};
constexpr NisKind kCode{"code", &GnssRow::codes_used, &GnssRow::code_nis};
constexpr NisKind kPhase{"carrier phase", &GnssRow::phases_used, &GnssRow::phase_nis};

/// Each epoch once: a step without new measurements repeats the figures of the step before.
std::vector<EpochNis> epochs_of(const RunRecord& record, const NisKind& kind) {
  std::vector<EpochNis> epochs;
  std::int32_t pairs = 0;
  for (const GnssRow& row : record.tables.rows<GnssRow>()) {
    const bool is_new = row.pairs != pairs;
    pairs = row.pairs;
    const std::int32_t used = row.*kind.used;
    if (is_new && used > 0) {
      const auto count = static_cast<std::size_t>(used);
      epochs.push_back({row.time_s, row.*kind.sum / used, count, mean_band(1.0, count)});
    }
  }
  return epochs;
}

/// The mean over all measurements, and the share of epochs inside their own bands.
Fact nis_fact(const char* name, const std::vector<EpochNis>& epochs) {
  if (epochs.empty()) return {name, "–"};
  double sum = 0.0;
  std::size_t measurements = 0;
  for (const EpochNis& e : epochs) {
    if (!std::isfinite(e.nis)) continue;
    sum += e.nis * static_cast<double>(e.measurements);
    measurements += e.measurements;
  }
  if (measurements == 0) return {name, "–"};
  const auto inside =
      std::ranges::count_if(epochs, [](const EpochNis& e) { return e.nis >= e.band.low && e.nis <= e.band.high; });
  Fact fact = consistency_fact(name, sum / static_cast<double>(measurements), 1.0, measurements);
  fact.value += fmt::format("; {} of {} epochs inside theirs",
                            percent(static_cast<double>(inside) / static_cast<double>(epochs.size())), epochs.size());
  return fact;
}

/// Estimates that the mean NEES is of.
std::size_t count_nees(const RunRecord& record) {
  const auto nees = gnss_nees(record);
  return static_cast<std::size_t>(std::distance(nees.lower_bound(first_fix(record).value_or(0.0)), nees.end()));
}

std::string facts(const RunRecord& record) {
  const Summary& s = record.summary;
  const GnssRow& last = record.tables.rows<GnssRow>().back();
  const std::string fix = s.first_fix_s ? fmt::format("{} s after the start", fixed(*s.first_fix_s, 0)) : "never";
  return fact_list(
      {{"first fix", fix},
       {"static floor", fixed(in_millimetres(s.static_floor_m), 3) + " mm"},
       consistency_fact("NEES of the relative state, mean", s.navigation_nees, 6.0, count_nees(record)),
       nis_fact("NIS per code measurement, mean", epochs_of(record, kCode)),
       nis_fact("NIS per phase measurement, mean", epochs_of(record, kPhase)),
       {"epochs", fmt::format("{} of both receivers, {} of one receiver, {} too late, {} without solution", last.pairs,
                              last.alone, last.too_late, last.no_solution)},
       {"integer ambiguities", fmt::format("{} fixes, {} releases, {} cycle slips, {} restarts", last.fixes,
                                           last.releases, last.slips, last.restarts)},
       {"measurements rejected", fmt::format("{} code, {} carrier phase", last.codes_refused, last.phases_refused)},
       {"receiver messages", fmt::format("{}, {} rejected (chance patterns included)", grouped_nearest(last.messages),
                                         last.messages_refused)}});
}

// --------------------------------------------------------------------------------------------------------------- plots

Plot empty_plot(const RunRecord& record, const View& view, const char* title, const char* quantity, Unit unit) {
  return time_plot(view, title, quantity, unit, 250.0, &record);
}

double claimed(const NavigationError& e) {
  return magnitude({e.sigma_rtn[0], e.sigma_rtn[1], e.sigma_rtn[2]});
}

/// Both size and claim against the floor.
Plot size_plot(const RunRecord& record, const View& view) {
  Plot plot = empty_plot(record, view, "Magnitude of the position error", "error", Unit::kMetres);
  const std::vector<NavigationError> all = navigation_errors(record);
  const auto size = [](const NavigationError& e) { return magnitude(e.position_rtn); };
  plot.series = {{"position error", 0, Mark::kLine, over_time(all, view, size)},
                 {"1σ of the filter", 1, Mark::kDashedLine, over_time(all, view, claimed)}};
  const std::optional<double> floor_m = record.summary.static_floor_m;
  if (floor_m) {
    const Range across = hours_of(view);
    plot.series.push_back({"static floor", 2, Mark::kDashedLine, {{across.low, *floor_m}, {across.high, *floor_m}}});
  }
  const double from_s = settled_from(record, view);
  double largest = floor_m.value_or(0.0);
  for (const NavigationError& e : all)
    if (e.time_s >= from_s) largest = std::max({largest, size(e), claimed(e)});
  plot.y.range = from_zero_to(largest);
  return plot;
}

Plot carriers_plot(const RunRecord& record, const View& view) {
  Plot plot = empty_plot(record, view, "Carriers tracked by both receivers", "carriers", Unit::kNone);
  const auto points = [&](std::int32_t GnssRow::*count) {
    return over_time(record.tables.rows<GnssRow>(), view,
                     [count](const GnssRow& row) { return static_cast<double>(row.*count); });
  };
  plot.series = {{"tracked", 5, Mark::kStairs, points(&GnssRow::tracked)},
                 {"fixed to integers", 2, Mark::kStairs, points(&GnssRow::fixed)}};
  plot.y.range = from_zero_to(std::ranges::max(record.tables.rows<GnssRow>(), {}, &GnssRow::tracked).tracked);
  return plot;
}

Plot nis_plot(const RunRecord& record, const View& view, const NisKind& kind) {
  const std::vector<EpochNis> epochs = epochs_of(record, kind);
  Plot plot = empty_plot(record, view, "", "NIS per degree of freedom", Unit::kNone);
  plot.title = fmt::format("Normalised innovations squared, {}", kind.name);
  plot.series = {
      {"epoch", 0, Mark::kDots, over_time(epochs, view, [](const EpochNis& e) { return e.nis; })},
      {"95 % band", 1, Mark::kDashedLine, over_time(epochs, view, [](const EpochNis& e) { return e.band.low; })},
      {"", 1, Mark::kDashedLine, over_time(epochs, view, [](const EpochNis& e) { return e.band.high; })}};
  double most = 0.0;
  for (const EpochNis& e : epochs) most = std::max({most, e.nis, e.band.high});
  plot.y.range = from_zero_to(most);
  return plot;
}

}  // namespace

std::vector<report::PaperColumn> gnss_paper_columns(const report::RunRecord& record) {
  if (record.summary.navigation != "gnss" || !meets_paper(paper3::kWaypoints, reached_waypoints(record))) return {};
  return {paper_column(kPaperSoftware, &paper3::Loops::software, paper3::kSoftware),
          paper_column(kPaperHardware, &paper3::Loops::hardware, paper3::kHardware)};
}

report::Section gnss_section(const report::RunRecord& record) {
  if (record.tables.rows<GnssRow>().empty()) return {};
  const View view = whole_run(record);
  return {"Carrier-phase navigation",
          performance_table(record) +
              "<p class=\"note\">Means and standard deviations of navigation are over the steps from the first fix "
              "on.</p>\n" +
              facts(record) + kBandNote +
              "<p class=\"note\">Static floor: distance of this run's antenna phase centres from their nominal "
              "positions, target relative to servicer, for bodies with parallel axes: the error of a solution from "
              "carrier phases alone. The motion between epochs makes part of it observable.</p>\n" +
              kPlotNote + plot_rows(2, {size_plot(record, view), carriers_plot(record, view)}) +
              plot_rows(2, {nis_plot(record, view, kCode), nis_plot(record, view, kPhase)}),
          {"gnss.csv", "estimate.csv"}};
}

}  // namespace vbar::sensors
