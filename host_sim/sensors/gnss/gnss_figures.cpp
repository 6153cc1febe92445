// Summary figures of navigation by GNSS, and the report section on the noise of both receivers' measurements.

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "host_sim/report/navigation_errors.h"
#include "host_sim/report/number_text.h"
#include "host_sim/report/run_record.h"
#include "host_sim/report/statistics.h"
#include "host_sim/sensors/gnss/gnss_kind.h"
#include "host_sim/sensors/gnss/gnss_row.h"
#include "host_sim/sensors/gnss/signal_noise_row.h"

namespace vbar::sensors {
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

void summarise_gnss(const report::RunRecord& record, report::Summary& summary) {
  if (record.tables.rows<GnssRow>().empty()) return;
  const std::optional<double> fix_s = report::first_fix(record);
  std::vector<double> nees;
  for (const auto& [time_s, value] : gnss_nees(record))
    if (!fix_s || time_s >= *fix_s) nees.push_back(value);
  summary.navigation_nees = report::mean_of(nees);
  std::map<std::string, double>& figures = summary.sensor_figures["gnss"];
  add(figures, "time_to_20_mm_s", time_to_20_mm(record));
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
