#pragma once
// A measurement of a laser range finder beside the truth (range_finder.csv).

#include <optional>
#include <string>

#include "host_sim/report/run_columns.h"
#include "host_sim/sensors/range_finder/range_finder.h"
#include "host_sim/sensors/sensor_kind.h"

namespace vbar::sensors {

struct RangeRow {
  double time_s = 0.0;               ///< since the mission's epoch
  std::string sensor;                ///< its name
  std::optional<double> measured_m;  ///< as the flight software received it; absent: it received none
  std::optional<double> true_m;      ///< between centres of mass; absent: a recorded measurement
  std::optional<double> error_m;     ///< measured less true
  std::optional<double> off_boresight_deg;
  bool in_field_of_view = false;
  double sigma_m = 0.0;  ///< 1 sigma of an error, bias and noise together
};

template <report::columns::RowOf<RangeRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  using report::ColumnName;
  visit(ColumnName{"time_s", "s, since the epoch of the mission"}, row.time_s);
  visit(ColumnName{"sensor", "its name"}, row.sensor);
  visit(ColumnName{"measured_m", "as the flight software received it; empty: it received none"}, row.measured_m);
  visit(ColumnName{"true_m", "between centres of mass; empty: a recorded measurement"}, row.true_m);
  visit(ColumnName{"error_m", "measured minus true"}, row.error_m);
  visit(ColumnName{"off_boresight_deg", "angle of the target from the boresight"}, row.off_boresight_deg);
  visit(ColumnName{"in_field_of_view", "1: the target was in the field of view"}, row.in_field_of_view);
  visit(ColumnName{"sigma_m", "1 sigma of an error, bias and noise together"}, row.sigma_m);
}

// kind = "range_finder": a laser range finder.

/// Settings of a range finder. It observes no spacecraft in the sense of SensorSettings::observed: it does not choose
/// the kind of navigation.
struct RangeFinderSensor : mission::SensorSettings {
  std::string target;
  RangeFinderSettings range_finder;
  bool is_used_by_navigation = false;
};

extern const SensorKind kRangeFinder;

// In range_report.cpp.
[[nodiscard]] std::unique_ptr<Evaluation> evaluate_ranges(const mission::Sensor& sensor,
                                                          const EvaluationContext& context);

// In range_report.cpp.
void summarise_ranges(const report::RunRecord& record, report::Summary& summary);
[[nodiscard]] report::Section range_section(const report::RunRecord& record);

}  // namespace vbar::sensors
