#include <algorithm>
#include <cctype>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <fmt/format.h>

#include "host_sim/report/plots/number_text.h"
#include "host_sim/report/run_record.h"
#include "host_sim/report/statistics.h"
#include "host_sim/sensors/gnss/gnss_kind.h"
#include "host_sim/sensors/gnss/gnss_rows.h"

namespace vbar::sensors {

namespace {

using report::NavigationError;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

Eigen::Vector3d vector(const report::Triple& v) {
  return {v[0], v[1], v[2]};
}

/// Orbital rate of the servicer about the Earth, rad/s.
double orbital_rate(const report::TruthRow& truth) {
  const Eigen::Vector3d r = vector(truth.servicer_position_eci);
  return r.cross(vector(truth.servicer_velocity_eci)).norm() / r.squaredNorm();
}

/// Clohessy and Wiltshire (1960): state transition of a relative state in RTN over t seconds, circular orbit of rate n.
Matrix6 clohessy_wiltshire(double n, double t) {
  const double s = std::sin(n * t);
  const double c = std::cos(n * t);
  Matrix6 transition;
  transition << 4.0 - 3.0 * c, 0.0, 0.0, s / n, 2.0 * (1.0 - c) / n, 0.0,                   //
      6.0 * (s - n * t), 1.0, 0.0, -2.0 * (1.0 - c) / n, (4.0 * s - 3.0 * n * t) / n, 0.0,  //
      0.0, 0.0, c, 0.0, 0.0, s / n,                                                         //
      3.0 * n * s, 0.0, 0.0, c, 2.0 * s, 0.0,                                               //
      -6.0 * n * (1.0 - c), 0.0, 0.0, -2.0 * s, 4.0 * c - 3.0, 0.0,                         //
      0.0, 0.0, -n * s, 0.0, 0.0, c;
  return transition;
}

Matrix6 symmetric(const double (&lower)[21]) {
  Matrix6 matrix;
  std::size_t place = 0;
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column <= row; ++column) matrix(row, column) = matrix(column, row) = lower[place++];
  }
  return matrix;
}

std::optional<double> nees(const NavigationError& error, const GnssRow& gnss, double rate) {
  if (!gnss.epoch_s) return std::nullopt;
  const Matrix6 transition = clohessy_wiltshire(rate, error.time_s - *gnss.epoch_s);
  const Matrix6 covariance = transition * symmetric(gnss.covariance_rtn) * transition.transpose();
  const Eigen::LLT<Matrix6> factor(covariance);
  if (factor.info() != Eigen::Success) return std::nullopt;
  Vector6 e;
  e << vector(error.position_rtn), vector(error.velocity_rtn);
  return factor.matrixL().solve(e).squaredNorm();
}

template <class Row>
std::map<double, const Row*> by_time(const std::vector<Row>& rows) {
  std::map<double, const Row*> found;
  for (const Row& row : rows) found[row.time_s] = &row;
  return found;
}

/// Whether the estimate of a step is by GNSS measurements of that step.
bool is_fresh(const report::EstimateRow& estimate) {
  return estimate.navigation_source == telemetry_navigation::kSourceGnssFloat ||
         estimate.navigation_source == telemetry_navigation::kSourceGnssFixed;
}

}  // namespace

std::map<double, double> gnss_nees(const report::RunRecord& record) {
  const auto truth_at = by_time(record.truth);
  const auto gnss_at = by_time(record.tables.rows<GnssRow>());
  const auto estimate_at = by_time(record.estimates);
  std::map<double, double> all;
  for (const NavigationError& error : report::navigation_errors(record)) {
    const auto gnss = gnss_at.find(error.time_s);
    if (gnss == gnss_at.end() || !is_fresh(*estimate_at.at(error.time_s))) continue;
    if (const auto value = nees(error, *gnss->second, orbital_rate(*truth_at.at(error.time_s))))
      all[error.time_s] = *value;
  }
  return all;
}

using report::ConsistencyFigure;

std::vector<ConsistencyFigure> gnss_consistency(const report::RunRecord& record) {
  constexpr double kStates = 6.0;
  std::vector<ConsistencyFigure> figures;
  for (const auto& [time_s, nees] : gnss_nees(record))
    figures.push_back({time_s, ConsistencyFigure::Kind::kNees, nees, kStates});
  std::int32_t pairs = 0;
  for (const GnssRow& row : record.tables.rows<GnssRow>()) {
    const bool is_new = row.pairs != pairs;  // a step without new measurements repeats the figures
    pairs = row.pairs;
    if (!is_new) continue;
    figures.push_back({row.time_s, ConsistencyFigure::Kind::kNis, row.code_nis + row.phase_nis,
                       static_cast<double>(row.codes_used + row.phases_used)});
  }
  return figures;
}

// Summary figures of navigation by GNSS, and the report section on the noise of both receivers' measurements.

namespace {

using report::fixed;

/// "GPS L1" as a part of a name of a figure: "gps_l1".
std::string name_part(std::string signal) {
  std::ranges::transform(signal, signal.begin(),
                         [](unsigned char c) { return static_cast<char>(c == ' ' ? '_' : std::tolower(c)); });
  return signal;
}

void add(std::map<std::string, double>& figures, const std::string& name, const std::optional<double>& value) {
  if (value) figures[name] = *value;
}

std::string stated(const std::optional<double>& measured, const std::optional<double>& stated, int decimals) {
  return fmt::format("{} ({})", fixed(measured, decimals), fixed(stated, decimals));
}

std::string wander(const SignalNoiseRow& row) {
  if (!row.phase_wander_sigma_mm) return "not significant";
  return fmt::format("{} mm over {} s", fixed(row.phase_wander_sigma_mm, 2), fixed(row.phase_wander_time_s, 0));
}

std::string noise_table(const std::vector<SignalNoiseRow>& signals) {
  const std::vector<report::Column> columns{{"signal", false},
                                            {"differences"},
                                            {"phase σ (stated), mm"},
                                            {"phase correlation, 10 s"},
                                            {"phase wander of a channel"},
                                            {"code σ (stated), m"},
                                            {"code correlation, 10 s"}};
  std::vector<std::vector<std::string>> rows;
  for (const SignalNoiseRow& row : signals)
    rows.push_back({row.signal, report::grouped(row.measurements),
                    stated(row.phase_sigma_mm, row.phase_sigma_stated_mm, 2), fixed(row.phase_correlation_10s, 2),
                    wander(row), stated(row.code_sigma_m, row.code_sigma_stated_m, 3),
                    fixed(row.code_correlation_10s, 2)});
  return report::table(columns, rows);
}

}  // namespace

std::optional<double> time_to_20_mm(const report::RunRecord& record) {
  constexpr double kBound_m = 0.02;
  const std::vector<report::NavigationError> errors = report::navigation_errors(record);
  if (errors.empty() || record.estimates.empty()) return std::nullopt;
  const auto is_within = [](const report::NavigationError& e) {
    // False for a NaN, of which std::hypot with three arguments may lose one (GCC 12).
    const auto& [r, t, n] = e.position_rtn;
    return std::sqrt(r * r + t * t + n * n) < kBound_m;
  };
  const auto last_outside = std::find_if_not(errors.rbegin(), errors.rend(), is_within);
  if (last_outside == errors.rbegin()) return std::nullopt;
  return last_outside.base()->time_s - record.estimates.front().time_s;
}

namespace {

/// After the first fix: the longest time without integers that are held, and the time in which the estimate was
/// propagated alone.
void add_times_without_fix(const report::RunRecord& record, double fix_s, std::map<std::string, double>& figures) {
  double fixed_s = fix_s, longest_s = 0.0, propagated_s = 0.0;
  for (std::size_t k = 0; k < record.estimates.size(); ++k) {
    const report::EstimateRow& row = record.estimates[k];
    if (row.time_s < fix_s) continue;
    longest_s = std::max(longest_s, row.time_s - fixed_s);
    if (row.navigation_source == telemetry_navigation::kSourceGnssFixed) fixed_s = row.time_s;
    if (row.navigation_source == telemetry_navigation::kSourcePropagated && k > 0)
      propagated_s += row.time_s - record.estimates[k - 1].time_s;
  }
  figures["longest_without_fix_s"] = longest_s;
  figures["propagated_s"] = propagated_s;
}

}  // namespace

void summarise_gnss(const report::RunRecord& record, report::Summary& summary) {
  if (record.tables.rows<GnssRow>().empty()) return;
  const std::optional<double> fix_s = report::first_fix(record);
  std::vector<double> nees;
  for (const auto& [time_s, value] : gnss_nees(record))
    if (!fix_s || time_s >= *fix_s) nees.push_back(value);
  summary.navigation_nees = report::mean_of(nees);
  std::map<std::string, double>& figures = summary.sensor_figures["gnss"];
  add(figures, "time_to_20_mm_s", time_to_20_mm(record));
  if (fix_s) add_times_without_fix(record, *fix_s, figures);
  for (const SignalNoiseRow& row : record.tables.rows<SignalNoiseRow>()) {
    const std::string signal = name_part(row.signal);
    add(figures, signal + "_phase_sigma_mm", row.phase_sigma_mm);
    add(figures, signal + "_phase_correlation_10s", row.phase_correlation_10s);
    add(figures, signal + "_phase_wander_sigma_mm", row.phase_wander_sigma_mm);
    add(figures, signal + "_phase_wander_time_s", row.phase_wander_time_s);
    add(figures, signal + "_code_sigma_m", row.code_sigma_m);
    add(figures, signal + "_code_correlation_10s", row.code_correlation_10s);
  }
}

report::Section signal_noise_section(const report::RunRecord& record) {
  const std::vector<SignalNoiseRow>& signals = record.tables.rows<SignalNoiseRow>();
  if (signals.empty()) return {};
  const auto after_start = [](const std::optional<double>& s) {
    return s ? fixed(s, 0) + " s after the start" : std::string("never");
  };
  const std::size_t excluded = [&] {
    std::size_t sum = 0;
    for (const SignalNoiseRow& row : signals) sum += row.excluded;
    return sum;
  }();
  return {"Measurement noise",
          report::fact_list({{"first fix", after_start(record.summary.first_fix_s)},
                             {"relative position error below 20 mm for good", after_start(time_to_20_mm(record))},
                             {"phases a quarter of a wavelength from an integer", report::grouped(excluded)}}) +
              noise_table(signals) +
              "<p class=\"note\">Of double differences between the two receivers, without integers, geometry and a "
              "baseline estimated at each epoch; in parentheses the receivers' own estimates. Correlation: of one "
              "satellite's residuals 10 s apart, after 120 s of lock. White noise has none, tracking loops and "
              "smoothing of real receivers "
              "and the channels of an RF generator leave some. The wander is that of one channel of one receiver, as a "
              "first-order Gauss-Markov process.</p>\n",
          {"signal_noise.csv"}};
}

}  // namespace vbar::sensors
