#include <algorithm>
#include <deque>
#include <map>

#include <fmt/format.h>

#include "fsw/math/math.h"
#include "fsw/packets/messages.h"
#include "host_sim/report/plots/number_text.h"
#include "host_sim/report/sections/sections.h"
#include "host_sim/report/statistics.h"
#include "host_sim/sensors/range_finder/range_finder_kind.h"

namespace vbar::sensors {

namespace {

/// A measurement that has not reached the flight software after this time is taken to be lost.
constexpr fsw::Duration kLongestDelay = fsw::duration_of_seconds(60);

class RangeEvaluation final : public Evaluation {
 public:
  RangeEvaluation(const mission::Sensor& sensor, const EvaluationContext& context)
      : context_(context),
        own_(settings_of<RangeFinderSensor>(sensor)),
        name_(sensor.name),
        unit_(unit_of(sensor, context.servicer)) {}

  void on_measured(const twins::TruthSnapshot& truth) override {
    const RangeFinderSettings& settings = own_.range_finder;
    RangeRow row = row_at(truth.time);
    const auto sight = line_of_sight(truth, context_.servicer.name, own_.target, settings.boresight_body);
    if (sight) {
      row.true_m = sight->range_m;
      row.off_boresight_deg = sight->off_boresight_rad * 180.0 / fsw::math::kPi;
      row.in_field_of_view = sight->off_boresight_rad <= settings.half_angle_rad;
    }
    pending_.push_back({truth.time, row});
  }

  void on_inputs(fsw::GpsTime time, std::span<const twins::Packet> inputs) override {
    for (const twins::Packet& bytes : inputs) {
      const auto packet = fsw::packets::parse_packet(bytes);
      if (!packet.ok() || packet.value().header.unit != unit_) continue;
      if (const auto message = fsw::packets::decode<range_measurement>(packet.value()); message.ok())
        take(packet.value().header.time, message.value().range_m);
    }
    while (!pending_.empty() && (pending_.front().row.measured_m || pending_.front().time + kLongestDelay < time))
      release();
  }

  void finish() override {
    while (!pending_.empty()) release();
  }

 private:
  struct Pending {
    fsw::GpsTime time;
    RangeRow row;
  };

  [[nodiscard]] RangeRow row_at(fsw::GpsTime time) const {
    RangeRow row;
    row.time_s = fsw::seconds(time - context_.mission.epoch);
    row.sensor = name_;
    row.sigma_m = std::hypot(own_.range_finder.bias_sigma_m, own_.range_finder.noise_sigma_m);
    return row;
  }

  void take(fsw::GpsTime time, double measured_m) {
    auto found = std::ranges::find(pending_, time, &Pending::time);
    if (found == pending_.end()) found = pending_.insert(pending_.end(), {time, row_at(time)});
    found->row.measured_m = measured_m;
    if (found->row.true_m) found->row.error_m = measured_m - *found->row.true_m;
  }

  void release() {
    context_.record.tables.rows<RangeRow>().push_back(pending_.front().row);
    pending_.pop_front();
  }

  EvaluationContext context_;
  const RangeFinderSensor& own_;
  std::string name_;
  std::uint8_t unit_;
  std::deque<Pending> pending_;  ///< in order of time
};

}  // namespace

std::unique_ptr<Evaluation> evaluate_ranges(const mission::Sensor& sensor, const EvaluationContext& context) {
  return std::make_unique<RangeEvaluation>(sensor, context);
}

// Summary figures and report section of laser range finders.

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
