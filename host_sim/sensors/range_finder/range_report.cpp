// Summary figures and report section of laser range finders.

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "host_sim/report/number_text.h"
#include "host_sim/report/section_parts.h"
#include "host_sim/report/statistics.h"
#include "host_sim/sensors/range_finder/range_finder_kind.h"

namespace vbar::sensors {
namespace {

using report::Mark;
using report::Plot;
using report::Unit;

std::map<std::string, std::vector<RangeRow>> by_sensor(const report::RunRecord& record) {
  std::map<std::string, std::vector<RangeRow>> sensors;
  for (const RangeRow& row : record.tables.rows<RangeRow>()) sensors[row.sensor].push_back(row);
  return sensors;
}

std::vector<double> errors_of(const std::vector<RangeRow>& rows) {
  std::vector<double> errors;
  for (const RangeRow& row : rows)
    if (row.error_m) errors.push_back(*row.error_m);
  return errors;
}

std::size_t count_if(const std::vector<RangeRow>& rows, auto&& is) {
  return static_cast<std::size_t>(std::ranges::count_if(rows, is));
}
std::size_t measurements(const std::vector<RangeRow>& rows) {
  return count_if(rows, [](const RangeRow& row) { return row.measured_m.has_value(); });
}
std::size_t in_view(const std::vector<RangeRow>& rows) {
  return count_if(rows, [](const RangeRow& row) { return row.in_field_of_view; });
}

std::string facts(const std::vector<RangeRow>& rows) {
  const std::vector<double> errors = errors_of(rows);
  const auto outside = std::ranges::count_if(
      rows, [](const RangeRow& row) { return row.error_m && !(std::abs(*row.error_m) <= 3.0 * row.sigma_m); });
  std::vector<report::Fact> list{
      {"measurements", fmt::format("{} at {} epochs, with the target in the field of view at {}", measurements(rows),
                                   rows.size(), in_view(rows))}};
  if (!errors.empty()) {
    const report::MeanAndDeviation error = report::statistics(errors);
    list.push_back({"range error, mean ± std",
                    fmt::format("{} ± {} m", report::fixed(error.mean, 3), report::fixed(error.std, 3))});
    list.push_back({"σ of bias and noise, as configured", report::fixed(rows.front().sigma_m, 3) + " m"});
    list.push_back({"errors beyond 3σ", std::to_string(outside)});
  }
  return report::fact_list(list);
}

std::vector<report::Point> points(const std::vector<RangeRow>& rows, const report::View& view,
                                  std::optional<double> RangeRow::*value) {
  return report::over_time(rows, view, [value](const RangeRow& row) { return (row.*value).value_or(std::nan("")); });
}

Plot error_plot(const std::string& sensor, const std::vector<RangeRow>& rows, const report::View& view) {
  Plot plot = report::time_plot(view, sensor + ", range error", "measured less true", Unit::kMetres);
  const report::Range across = report::hours_of(view);
  const double bound = 3.0 * rows.front().sigma_m;
  plot.series = {{"error", 0, Mark::kDots, points(rows, view, &RangeRow::error_m)},
                 {"±3σ of bias and noise", 1, Mark::kDashedLine, {{across.low, bound}, {across.high, bound}}},
                 {"", 1, Mark::kDashedLine, {{across.low, -bound}, {across.high, -bound}}}};
  return plot;
}

Plot range_plot(const std::string& sensor, const std::vector<RangeRow>& rows, const report::View& view) {
  Plot plot = report::time_plot(view, sensor + ", range", "range", Unit::kMetres);
  plot.series = {{"true", 2, Mark::kLine, points(rows, view, &RangeRow::true_m)},
                 {"measured", 0, Mark::kDots, points(rows, view, &RangeRow::measured_m)}};
  return plot;
}

}  // namespace

void summarise_ranges(const report::RunRecord& record, report::Summary& summary) {
  for (const auto& [sensor, rows] : by_sensor(record)) {
    std::map<std::string, double>& figures = summary.sensor_figures[sensor];
    figures["epochs"] = static_cast<double>(rows.size());
    figures["in_field_of_view"] = static_cast<double>(in_view(rows));
    figures["measurements"] = static_cast<double>(measurements(rows));
    const std::vector<double> errors = errors_of(rows);
    if (errors.empty()) continue;
    const report::MeanAndDeviation error = report::statistics(errors);
    figures["range_error_mean_m"] = error.mean;
    figures["range_error_std_m"] = error.std;
  }
}

report::Section range_section(const report::RunRecord& record) {
  const auto sensors = by_sensor(record);
  if (sensors.empty()) return {};
  const report::View view = report::whole_run(record);
  std::string content =
      "<p class=\"note\">Range between the centres of mass of servicer and target. Navigation does not use it.</p>\n";
  for (const auto& [sensor, rows] : sensors)
    content += facts(rows) + report::plot_rows(2, {error_plot(sensor, rows, view), range_plot(sensor, rows, view)});
  return {"Laser range finder", content, {"range_finder.csv"}};
}

}  // namespace vbar::sensors
