#pragma once
// Telemetry of navigation by GNSS as a row (gnss.csv), and its consistency with the truth.

#include <map>
#include <optional>

#include "host_sim/report/run_columns.h"

namespace vbar::sensors {

/// Telemetry of navigation by GNSS at a step (gnss.csv, only if a run has such navigation).
struct GnssRow : telemetry_gnss {
  GnssRow() : telemetry_gnss{} {}
  double time_s = 0.0;
  std::optional<double> epoch_s;  ///< epoch of the last measurements used, as time_s
};

template <report::columns::RowOf<GnssRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  visit(report::ColumnName{"time_s", "s, since the epoch of the mission"}, row.time_s);
  visit(report::ColumnName{"epoch_s", "s, since the epoch of the mission: of the last measurements used"}, row.epoch_s);
  report::columns::fields(visit, report::columns::message_of<telemetry_gnss>(row));
}

/// Returns the normalised estimation error squared, six degrees of freedom, of the steps with a fresh GNSS estimate, by
/// time. Navigation reports its covariance at the epoch of its last measurements; it is propagated to the estimate's
/// time by the Clohessy-Wiltshire equations, without what a burn in between adds. Steps whose covariance is singular
/// are left out.
[[nodiscard]] std::map<double, double> gnss_nees(const report::RunRecord& record);

}  // namespace vbar::sensors
