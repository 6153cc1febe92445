// Flights of a campaign over each other, of the cases whose run folders are kept.

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "host_sim/campaign_report/page.h"
#include "host_sim/report/csv_table.h"
#include "host_sim/report/plots/number_text.h"
#include "host_sim/report/run_series.h"
#include "host_sim/report/statistics.h"

namespace vbar::campaign_report {

namespace {

using report::Mark;
using report::Plot;
using report::Point;

constexpr std::size_t kMaxFlights = 40, kIntervals = 240;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::array<std::string_view, 4> kColumns{"time_s", "relative_position_rtn_r_m", "relative_position_rtn_t_m",
                                                   "relative_position_rtn_n_m"};

using Position = std::array<double, 3>;

double length(const Position& r) {
  return std::hypot(r[0], r[1], r[2]);
}

/// Relative positions by time, of the rows that have one.
std::map<double, Position> positions_of(const std::filesystem::path& file) {
  std::map<double, Position> positions;
  std::vector<std::string> cells;
  std::array<std::size_t, kColumns.size()> places{};
  bool is_head = true;
  for (const std::string& line : report::read_lines(file)) {
    if (!report::split_cells(line, cells)) continue;
    if (is_head) {
      for (std::size_t k = 0; k < kColumns.size(); ++k)
        places[k] = static_cast<std::size_t>(std::ranges::find(cells, kColumns[k]) - cells.begin());
      is_head = false;
      continue;
    }
    std::array<double, kColumns.size()> row{};
    bool is_whole = true;
    for (std::size_t k = 0; k < row.size(); ++k)
      is_whole = is_whole && places[k] < cells.size() && !cells[places[k]].empty() &&
                 report::read_value(cells[places[k]], row[k]);
    if (is_whole) positions[row[0]] = {row[1], row[2], row[3]};
  }
  return positions;
}

std::optional<Flight> flight_of(const std::filesystem::path& folder, std::uint64_t number) {
  const std::filesystem::path truth = folder / "truth.csv", estimate = folder / "estimate.csv";
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(truth, ignored)) return std::nullopt;
  Flight flight{number, {}, {}};
  const std::map<double, Position> flown = positions_of(truth);
  for (const auto& [time_s, r] : flown) flight.range.push_back({report::hours(time_s), length(r)});
  if (!std::filesystem::is_regular_file(estimate, ignored)) return flight;
  for (const auto& [time_s, r] : positions_of(estimate)) {
    const auto found = flown.find(time_s);
    if (found == flown.end()) continue;
    const Position& at = found->second;
    flight.error.push_back({report::hours(time_s), length({r[0] - at[0], r[1] - at[1], r[2] - at[2]})});
  }
  return flight;
}

/// Equal intervals of time with an extreme of each.
struct Intervals {
  double start_h = 0.0, length_h = 0.0;

  [[nodiscard]] std::size_t of(double time_h) const {
    return std::min(static_cast<std::size_t>(std::max(0.0, (time_h - start_h) / length_h)), kIntervals - 1);
  }
  /// NaN where the flight has steps, but no such value; an interval without a step has the value of the one before.
  [[nodiscard]] std::vector<double> extremes(const Flight& flight, const std::vector<Point>& points,
                                             bool largest) const {
    std::vector<double> values(kIntervals, kNone);
    for (const Point& point : points) {
      double& value = values[of(point.x)];
      if (std::isnan(value) || (largest ? point.y > value : point.y < value)) value = point.y;
    }
    std::vector<bool> has_step(kIntervals, false);
    for (const Point& step : flight.range) has_step[of(step.x)] = true;
    for (std::size_t k = 1; k < kIntervals; ++k)
      if (!has_step[k]) values[k] = values[k - 1];
    return values;
  }
  [[nodiscard]] std::vector<Point> curve(const std::vector<double>& values) const {
    std::vector<Point> points;
    for (std::size_t k = 0; k < values.size(); ++k)
      points.push_back({start_h + (static_cast<double>(k) + 0.5) * length_h, values[k]});
    return points;
  }
};

std::vector<double> medians(const std::vector<std::vector<double>>& of_cases) {
  std::vector<double> values(kIntervals, kNone);
  for (std::size_t k = 0; k < kIntervals; ++k) {
    std::vector<double> sorted;
    for (const std::vector<double>& one : of_cases)
      if (!std::isnan(one[k])) sorted.push_back(one[k]);
    std::ranges::sort(sorted);
    if (!sorted.empty()) values[k] = report::quantile(sorted, 0.5);
  }
  return values;
}

Plot overlay(const std::vector<Flight>& flights, std::vector<Point> Flight::*curve, const char* title,
             const char* quantity, bool largest) {
  report::Range hours{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
  for (const Flight& flight : flights)
    if (!flight.range.empty())
      hours = {std::min(hours.low, flight.range.front().x), std::max(hours.high, flight.range.back().x)};
  const Intervals intervals{hours.low, std::max(hours.span(), 1e-6) / static_cast<double>(kIntervals)};
  Plot plot;
  plot.title = title;
  plot.x = {.name = "time", .unit = report::Unit::kHours, .range = hours};
  plot.y = {.name = quantity, .unit = report::Unit::kMetres, .logarithmic = true};
  plot.height = 260.0;
  std::vector<std::vector<double>> of_cases;
  for (const Flight& flight : flights) {
    of_cases.push_back(intervals.extremes(flight, flight.*curve, largest));
    plot.series.push_back({of_cases.size() == 1 ? "a case" : "", 5, Mark::kLine, intervals.curve(of_cases.back())});
  }
  plot.series.push_back({"median of the cases", 1, Mark::kBroadLine, intervals.curve(medians(of_cases))});
  return plot;
}

}  // namespace

std::vector<Flight> kept_flights(const std::filesystem::path& folder, const Campaign& campaign) {
  std::vector<const Case*> kept;
  for (const Case& one : campaign.cases)
    if (one.is_complete() && !one.folder.empty()) kept.push_back(&one);
  std::vector<Flight> flights;
  const std::size_t count = std::min(kept.size(), kMaxFlights);
  for (std::size_t k = 0; k < count; ++k) {
    const Case& one = *kept[k * kept.size() / count];
    if (auto flight = flight_of(folder / one.folder, one.number)) flights.push_back(std::move(*flight));
  }
  return flights;
}

report::Section flight_section(const Content& content) {
  if (content.flights.size() < 2) return {};
  const std::string note = fmt::format(
      "<p class=\"note\">Of {} whose run folders are kept; the largest error and the smallest range of each of {} "
      "intervals of time.</p>\n",
      count_text(content.flights.size(), "complete case", "complete cases"), kIntervals);
  return {"Flights over time",
          note + report::plot_rows(
                     2, {overlay(content.flights, &Flight::error, "Error of the relative position", "error", true),
                         overlay(content.flights, &Flight::range, "Range to the target", "range", false)}),
          {"runs"}};
}

}  // namespace vbar::campaign_report
