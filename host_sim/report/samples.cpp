#include "host_sim/report/samples.h"

#include <algorithm>
#include <cmath>

#include "host_sim/report/extension.h"
#include "host_sim/report/navigation_errors.h"

namespace vbar::report {
namespace {

using Kind = ConsistencyFigure::Kind;

constexpr double kHour_s = 3600.0;
constexpr double kTimeTolerance_s = 1e-6;  // hours do not hold nanoseconds

std::vector<ConsistencyFigure> figures_of(const RunRecord& record) {
  std::vector<ConsistencyFigure> all;
  for (const Extension* extension : record.extensions) {
    if (extension->consistency == nullptr) continue;
    const std::vector<ConsistencyFigure> some = extension->consistency(record);
    all.insert(all.end(), some.begin(), some.end());
  }
  std::erase_if(all, [](const ConsistencyFigure& f) { return !std::isfinite(f.value) || !(f.dimension > 0.0); });
  std::ranges::stable_sort(all, {}, &ConsistencyFigure::time_s);
  return all;
}

/// Mean of the figures' values or dimensions.
std::optional<double> mean(const std::vector<ConsistencyFigure>& figures, Kind kind,
                           double ConsistencyFigure::*member) {
  double sum = 0.0, count = 0.0;
  for (const ConsistencyFigure& figure : figures) {
    if (figure.kind != kind) continue;
    sum += figure.*member;
    count += 1.0;
  }
  return count > 0.0 ? std::optional(sum / count) : std::nullopt;
}

double root_of_squares(double a, double b, double c) {
  return std::sqrt(a * a + b * b + c * c);
}

/// Returns the error at the last step until the time, null if its estimate is invalid.
const NavigationError* error_at(const RunRecord& record, const std::vector<NavigationError>& errors, double time_s) {
  const auto step = std::ranges::upper_bound(record.estimates, time_s + kTimeTolerance_s, {}, &EstimateRow::time_s);
  if (step == record.estimates.begin()) return nullptr;
  const auto found = std::ranges::lower_bound(errors, std::prev(step)->time_s, {}, &NavigationError::time_s);
  return found != errors.end() && found->time_s == std::prev(step)->time_s ? &*found : nullptr;
}

/// Navigation that claims no uncertainty has none to show.
void fill_sigmas(const Sextuple& sigma, Sample& sample) {
  const double all = root_of_squares(sigma[0], sigma[1], sigma[2]);
  if (!(all > 0.0)) return;
  sample.sigma_m = all;
  sample.sigma_r_m = sigma[0];
  sample.sigma_t_m = sigma[1];
  sample.sigma_n_m = sigma[2];
  sample.sigma_velocity_mps = root_of_squares(sigma[3], sigma[4], sigma[5]);
}

void fill(const NavigationError& error, Sample& sample) {
  sample.navigation_error_m = magnitude(error.position_rtn);
  sample.navigation_error_r_m = error.position_rtn[0];
  sample.navigation_error_t_m = error.position_rtn[1];
  sample.navigation_error_n_m = error.position_rtn[2];
  sample.navigation_velocity_error_mps = magnitude(error.velocity_rtn);
  fill_sigmas(error.sigma_rtn, sample);
}

void fill(const std::vector<ConsistencyFigure>& figures, double after_s, double until_s, Sample& sample) {
  for (const ConsistencyFigure& figure : figures) {
    if (figure.time_s <= after_s + kTimeTolerance_s || figure.time_s > until_s + kTimeTolerance_s) continue;
    (figure.kind == Kind::kNees ? sample.nees : sample.nis) = figure.value;
    (figure.kind == Kind::kNees ? sample.nees_dimension : sample.nis_dimension) = figure.dimension;
  }
}

}  // namespace

void summarise_consistency(const RunRecord& record, Summary& summary) {
  const std::vector<ConsistencyFigure> figures = figures_of(record);
  summary.navigation_nees_dimension = mean(figures, Kind::kNees, &ConsistencyFigure::dimension);
  summary.navigation_nis = mean(figures, Kind::kNis, &ConsistencyFigure::value);
  summary.navigation_nis_dimension = mean(figures, Kind::kNis, &ConsistencyFigure::dimension);

  const std::vector<NavigationError> errors = navigation_errors(record);
  double previous_s = -1.0;
  for (Sample& sample : summary.samples) {
    sample = {.time_h = sample.time_h};
    const double time_s = kHour_s * sample.time_h;
    const NavigationError* const error = error_at(record, errors, time_s);
    if (error != nullptr) fill(*error, sample);
    fill(figures, previous_s, time_s, sample);
    previous_s = time_s;
  }
}

}  // namespace vbar::report
