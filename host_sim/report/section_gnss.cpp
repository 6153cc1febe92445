#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "host_sim/report/html_page.h"
#include "host_sim/report/maneuver_series.h"
#include "host_sim/report/navigation_errors.h"
#include "host_sim/report/number_text.h"
#include "host_sim/report/paper_experiment3.h"
#include "host_sim/report/report_sections.h"
#include "host_sim/report/section_parts.h"

namespace vbar::report {
namespace {

constexpr double kMillimetres = 1e3;

// ------------------------------------------------------------------------------------------------- table of the paper

std::string mean_and_deviation(const std::optional<MeanAndDeviation>& value, int decimals) {
  if (!value) return fixed(std::nullopt, decimals);
  return fmt::format("{} ± {}", fixed(kMillimetres * value->mean, decimals),
                     fixed(kMillimetres * value->std, decimals));
}

std::optional<double> in_millimetres(const std::optional<double>& value) {
  return value ? std::optional(kMillimetres * *value) : std::nullopt;
}

/// A row of the table: a value at each waypoint and one of the whole run, as the run has them and as the paper does.
struct Metric {
  std::string name;
  std::function<std::optional<double>(const WaypointRow&)> value;
  std::function<std::optional<double>(const paper::Waypoint&)> papers_value;
  std::string whole, papers_whole;
};

std::vector<Metric> metrics(const Summary& s) {
  return {{"navigation error, mm", [](const WaypointRow& row) { return in_millimetres(row.navigation_error_m); },
           [](const paper::Waypoint& row) { return row.navigation_error_mm; },
           mean_and_deviation(s.navigation_error_m, 3), paper::kNavigationError_mm},
          {"navigation velocity error, mm/s",
           [](const WaypointRow& row) { return in_millimetres(row.navigation_velocity_error_mps); },
           [](const paper::Waypoint& row) { return row.navigation_velocity_error_mmps; },
           mean_and_deviation(s.navigation_velocity_error_mps, 3), paper::kNavigationVelocityError_mmps},
          {"control error, m", [](const WaypointRow& row) { return row.control_error_m; },
           [](const paper::Waypoint& row) { return row.control_error_m; }, "", ""},
          {"delta-v so far, mm/s", [](const WaypointRow& row) { return kMillimetres * row.cumulative_dv_mps; },
           [](const paper::Waypoint&) { return std::nullopt; },
           fmt::format("{} in {} maneuvers", fixed(kMillimetres * s.dv_mps, 3), s.maneuvers), paper::kDeltaV_mmps}};
}

bool is_beside_the_paper(const RunRecord& record) {
  return std::ranges::any_of(record.waypoints, [](const WaypointRow& row) { return paper::waypoint(row) != nullptr; });
}

/// The paper's numbers stand under those of a run that meets its waypoints.
std::string performance_table(const RunRecord& record) {
  std::vector<Column> columns{{"", false}, {"", false}};
  for (const WaypointRow& row : record.waypoints) columns.push_back({fmt::format("waypoint {}", row.index)});
  columns.push_back({"whole run, mean ± std"});

  std::vector<std::vector<std::string>> rows;
  for (const Metric& metric : metrics(record.summary)) {
    std::vector<std::string> run{metric.name, "this run"};
    std::vector<std::string> paper{"", "paper, software in the loop"};
    for (const WaypointRow& row : record.waypoints) {
      run.push_back(fixed(metric.value(row), 3));
      const paper::Waypoint* const same = paper::waypoint(row);
      paper.push_back(fixed(same != nullptr ? metric.papers_value(*same) : std::nullopt, 3));
    }
    run.push_back(metric.whole);
    paper.push_back(metric.papers_whole);
    rows.push_back(std::move(run));
    if (is_beside_the_paper(record)) rows.push_back(std::move(paper));
  }
  return table(columns, rows);
}

// ----------------------------------------------------------------------------------------------------------- in words

std::string percent(double share) {
  return fmt::format("{} %", fixed(100.0 * share, 1));
}

/// Of chi-square over its degrees of freedom, 95 % of draws lie between (Wilson and Hilferty 1931; four digits from ten
/// degrees on).
Range nis_band(std::int32_t degrees) {
  const double spread = 2.0 / (9.0 * degrees);
  const auto quantile = [&](double sigmas) { return std::pow(1.0 - spread + sigmas * std::sqrt(spread), 3.0); };
  return {quantile(-1.959964), quantile(1.959964)};
}

/// Normalised innovations of one epoch of one kind of measurement.
struct EpochNis {
  double time_s = 0.0;
  double nis = 0.0;  ///< over the number of measurements
  Range band;
};

struct NisKind {
  const char* name;
  std::int32_t GnssRow::*used;
  double GnssRow::*sum;
};
constexpr NisKind kCode{"code", &GnssRow::codes_used, &GnssRow::code_nis};
constexpr NisKind kPhase{"carrier phase", &GnssRow::phases_used, &GnssRow::phase_nis};

/// Each epoch once: a step without new measurements repeats what the one before said.
std::vector<EpochNis> epochs_of(const RunRecord& record, const NisKind& kind) {
  std::vector<EpochNis> epochs;
  std::int32_t pairs = 0;
  for (const GnssRow& row : record.gnss) {
    const bool is_new = row.pairs != pairs;
    pairs = row.pairs;
    const std::int32_t used = row.*kind.used;
    if (is_new && used > 0) epochs.push_back({row.time_s, row.*kind.sum / used, nis_band(used)});
  }
  return epochs;
}

std::string share_in_band(const std::vector<EpochNis>& epochs) {
  if (epochs.empty()) return "–";
  const auto inside =
      std::ranges::count_if(epochs, [](const EpochNis& e) { return e.nis >= e.band.low && e.nis <= e.band.high; });
  double sum = 0.0;
  for (const EpochNis& e : epochs) sum += e.nis;
  const auto count = static_cast<double>(epochs.size());
  return fmt::format("mean {}, {} of {} epochs inside the 95 % band", fixed(sum / count, 3),
                     percent(static_cast<double>(inside) / count), epochs.size());
}

std::string facts(const RunRecord& record) {
  const Summary& s = record.summary;
  const GnssRow& last = record.gnss.back();
  const std::string fix = s.first_fix_s ? fmt::format("{} s after the start", fixed(*s.first_fix_s, 0)) : "never";
  return fact_list(
      {{"first fix", fix},
       {"static floor", fixed(in_millimetres(s.static_floor_m), 3) + " mm"},
       {"NEES, 6 expected", fixed(s.navigation_nees, 2)},
       {"NIS, code", share_in_band(epochs_of(record, kCode))},
       {"NIS, carrier phase", share_in_band(epochs_of(record, kPhase))},
       {"epochs", fmt::format("{} of both receivers, {} of one alone, {} too late, {} without solution", last.pairs,
                              last.alone, last.too_late, last.no_solution)},
       {"integers", fmt::format("{} decisions to hold, {} releases, {} cycle slips, {} restarts", last.fixes,
                                last.releases, last.slips, last.restarts)},
       {"measurements refused", fmt::format("{} code, {} carrier phase", last.codes_refused, last.phases_refused)},
       {"receiver messages", fmt::format("{}, {} refused (chance patterns included)", grouped_nearest(last.messages),
                                         last.messages_refused)}});
}

// ----------------------------------------------------------------------------------------------------------------
// plots

Plot empty_plot(const RunRecord& record, const View& view, const char* title, const char* quantity, Unit unit) {
  Plot plot;
  plot.title = title;
  plot.x = time_axis(view);
  plot.y = {.name = quantity, .unit = unit};
  plot.width = 580.0;
  plot.moments = waypoint_moments(view);
  plot.events = maneuver_events(record, view);
  return plot;
}

double claimed(const NavigationError& e) {
  return std::hypot(e.sigma_rtn[0], e.sigma_rtn[1], e.sigma_rtn[2]);
}

/// Both size and claim against the floor.
Plot size_plot(const RunRecord& record, const View& view) {
  Plot plot = empty_plot(record, view, "Size of the position error", "error", Unit::kMetres);
  const std::vector<NavigationError> all = navigation_errors(record);
  const auto size = [](const NavigationError& e) { return magnitude(e.position_rtn); };
  plot.series = {{"position error", 0, Mark::kLine, over_time(all, view, size)},
                 {"one sigma as the filter claims", 1, Mark::kDashedLine, over_time(all, view, claimed)}};
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
  Plot plot = empty_plot(record, view, "Carriers of both receivers", "carriers", Unit::kNone);
  const auto points = [&](std::int32_t GnssRow::*count) {
    return over_time(record.gnss, view, [count](const GnssRow& row) { return static_cast<double>(row.*count); });
  };
  plot.series = {{"tracked", 5, Mark::kStairs, points(&GnssRow::tracked)},
                 {"held to integers", 2, Mark::kStairs, points(&GnssRow::fixed)}};
  plot.y.range = from_zero_to(std::ranges::max(record.gnss, {}, &GnssRow::tracked).tracked);
  return plot;
}

Plot nis_plot(const RunRecord& record, const View& view, const NisKind& kind) {
  const std::vector<EpochNis> epochs = epochs_of(record, kind);
  Plot plot = empty_plot(record, view, "", "NIS over its degrees", Unit::kNone);
  plot.title = fmt::format("Normalised innovations squared, {}", kind.name);
  plot.series = {
      {"of an epoch", 0, Mark::kDots, over_time(epochs, view, [](const EpochNis& e) { return e.nis; })},
      {"95 % band", 1, Mark::kDashedLine, over_time(epochs, view, [](const EpochNis& e) { return e.band.low; })},
      {"", 1, Mark::kDashedLine, over_time(epochs, view, [](const EpochNis& e) { return e.band.high; })}};
  double most = 0.0;
  for (const EpochNis& e : epochs) most = std::max({most, e.nis, e.band.high});
  plot.y.range = from_zero_to(most);
  return plot;
}

}  // namespace

std::string gnss_section(const RunRecord& record) {
  if (record.gnss.empty()) return {};
  const View view = whole_run(record);
  const Plot size = size_plot(record, view);
  const Plot carriers = carriers_plot(record, view);
  std::vector<Series> keys = size.series;
  keys.insert(keys.end(), carriers.series.begin(), carriers.series.end());
  const Plot code = nis_plot(record, view, kCode);
  const Plot phase = nis_plot(record, view, kPhase);
  return section(
      "Carrier-phase navigation",
      performance_table(record) +
          "<p class=\"note\">Means and standard deviations of navigation are over the steps from the first fix "
          "on.</p>\n" +
          facts(record) +
          "<p class=\"note\">Static floor: how far this run's antennas are from where navigation takes them to be, "
          "target against servicer, were their axes parallel. A navigation that took positions from phases alone "
          "would err by just that; the motion between epochs tells part of it. Dashed lines: waypoints. Strokes on the "
          "lower edge: maneuvers.</p>\n" +
          legend(keys) + figures(2, {svg(size), svg(carriers)}) + legend({code.series[0], code.series[1]}) +
          figures(2, {svg(code), svg(phase)}));
}

}  // namespace vbar::report
