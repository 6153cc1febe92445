#pragma once
// Telemetry of navigation by GNSS as a row (gnss.csv), and its consistency with the truth.

#include <map>
#include <optional>
#include <string>

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

// The noise of one signal, from differences between the two receivers of a run (signal_noise.csv).

/// Noise of one signal. Sigmas are those of double differences. Absent: too few measurements.
struct SignalNoiseRow {
  std::string signal;            ///< "GPS L1"
  std::size_t measurements = 0;  ///< differences between the receivers
  std::size_t excluded = 0;      ///< differences a quarter of a wavelength or more from an integer
  std::optional<double> phase_sigma_mm;
  std::optional<double> phase_sigma_stated_mm;  ///< by the receivers' own estimates
  std::optional<double> phase_correlation_10s;
  std::optional<double> code_sigma_m;
  std::optional<double> code_sigma_stated_m;
  std::optional<double> code_correlation_10s;
  /// Correlated part of the phase of one channel of one receiver, as a first-order Gauss-Markov process. Absent: not
  /// significant.
  std::optional<double> phase_wander_sigma_mm;
  std::optional<double> phase_wander_time_s;
};

template <report::columns::RowOf<SignalNoiseRow> Row, class Visitor>
void visit_columns(Row& row, Visitor& visit) {
  using report::ColumnName;
  visit(ColumnName{"signal", "GNSS and carrier"}, row.signal);
  visit(ColumnName{"measurements", "differences between the receivers"}, row.measurements);
  visit(ColumnName{"excluded", "differences a quarter of a wavelength or more from an integer"}, row.excluded);
  visit(ColumnName{"phase_sigma_mm", "of carrier double differences"}, row.phase_sigma_mm);
  visit(ColumnName{"phase_sigma_stated_mm", "the same by the receivers' own estimates"}, row.phase_sigma_stated_mm);
  visit(ColumnName{"phase_correlation_10s", "of double differences 10 s apart"}, row.phase_correlation_10s);
  visit(ColumnName{"code_sigma_m", "of code double differences"}, row.code_sigma_m);
  visit(ColumnName{"code_sigma_stated_m", "the same by the receivers' own estimates"}, row.code_sigma_stated_m);
  visit(ColumnName{"code_correlation_10s", "of double differences 10 s apart"}, row.code_correlation_10s);
  visit(ColumnName{"phase_wander_sigma_mm",
                   "correlated part of the phase of one channel, first-order Gauss-Markov; empty: not significant"},
        row.phase_wander_sigma_mm);
  visit(ColumnName{"phase_wander_time_s", "time constant of that process"}, row.phase_wander_time_s);
}

}  // namespace vbar::sensors
