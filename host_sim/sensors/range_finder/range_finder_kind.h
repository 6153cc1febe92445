#pragma once
// kind = "range_finder": a laser range finder.

#include "host_sim/sensors/range_finder/range_finder.h"
#include "host_sim/sensors/range_finder/range_row.h"
#include "host_sim/sensors/sensor_kind.h"

namespace vbar::sensors {

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
