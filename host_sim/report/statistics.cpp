#include "host_sim/report/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <vector>

#include <boost/math/distributions/chi_squared.hpp>
#include <fmt/format.h>

#include "host_sim/report/plots/number_text.h"
#include "host_sim/report/run_series.h"

namespace vbar::report {

Range chi_square_band(double degrees) {
  constexpr double kTail = 0.025;
  const boost::math::chi_squared distribution(degrees);
  return {boost::math::quantile(distribution, kTail),
          boost::math::quantile(boost::math::complement(distribution, kTail))};
}

Range mean_band(double degrees, std::size_t samples) {
  const auto count = static_cast<double>(samples);
  const Range sum = chi_square_band(degrees * count);
  return {sum.low / count, sum.high / count};
}

Fact consistency_fact(const std::string& name, const std::optional<double>& mean, double degrees, std::size_t samples) {
  Fact fact{name, fixed(mean, 2)};
  if (!mean || !std::isfinite(*mean)) return fact;
  fact.value += fmt::format(", {:g} expected", degrees);
  if (samples == 0) return fact;
  const Range band = mean_band(degrees, samples);
  fact.is_bad = *mean < band.low || *mean > band.high;
  fact.value += fmt::format("; {} the 95 % band {} to {} of {} samples",
                            !fact.is_bad       ? "inside"
                            : *mean < band.low ? "below"
                                               : "above",
                            fixed(band.low, 2), fixed(band.high, 2), grouped(samples));
  return fact;
}

namespace {

constexpr int kGnssFixed = telemetry_navigation::kSourceGnssFixed;

}  // namespace

std::vector<NavigationError> navigation_errors(const RunRecord& record) {
  std::map<double, const TruthRow*> truth_at;
  for (const TruthRow& row : record.truth) truth_at[row.time_s] = &row;
  std::vector<NavigationError> all;
  for (const EstimateRow& row : record.estimates) {
    const auto truth = truth_at.find(row.time_s);
    if (row.navigation_valid == 0 || truth == truth_at.end()) continue;
    NavigationError& error = all.emplace_back();
    error.time_s = row.time_s;
    error.sigma_rtn = row.sigma_rtn;
    for (std::size_t k = 0; k < 3; ++k) {
      error.position_rtn[k] = row.relative_position_rtn[k] - truth->second->relative_position_rtn[k];
      error.velocity_rtn[k] = row.relative_velocity_rtn[k] - truth->second->relative_velocity_rtn[k];
    }
  }
  return all;
}

std::optional<double> first_fix(const RunRecord& record) {
  const auto found = std::ranges::find_if(record.estimates, [](const EstimateRow& row) {
    return row.navigation_valid != 0 && row.navigation_source == kGnssFixed;
  });
  if (found == record.estimates.end()) return std::nullopt;
  return found->time_s;
}

namespace {

constexpr double kLongestInterpolated_s = 120.0;
constexpr int kParts = 8;

/// Cubic Hermite interpolation at `share` of the way from `a` to `b`.
double distance_between(const TruthRow& a, const TruthRow& b, double share) {
  const double dt = b.time_s - a.time_s;
  const double s = share, r = 1.0 - share;
  Triple position{};
  for (std::size_t k = 0; k < 3; ++k)
    position[k] = r * r * (1.0 + 2.0 * s) * a.relative_position_rtn[k] + r * r * s * dt * a.relative_velocity_rtn[k] +
                  s * s * (3.0 - 2.0 * s) * b.relative_position_rtn[k] - s * s * r * dt * b.relative_velocity_rtn[k];
  return magnitude(position);
}

}  // namespace

void for_each_distance(const RunRecord& record, const std::function<void(const TrueDistance&)>& visit) {
  for (std::size_t k = 0; k < record.truth.size(); ++k) {
    const TruthRow& row = record.truth[k];
    visit({row.time_s, magnitude(row.relative_position_rtn)});
    if (k + 1 == record.truth.size()) break;
    const TruthRow& next = record.truth[k + 1];
    const double dt = next.time_s - row.time_s;
    if (dt > kLongestInterpolated_s) continue;
    for (int part = 1; part < kParts; ++part) {
      const double share = static_cast<double>(part) / kParts;
      visit({row.time_s + share * dt, distance_between(row, next, share)});
    }
  }
}

std::optional<TrueDistance> min_distance(const RunRecord& record) {
  std::optional<TrueDistance> least;
  for_each_distance(record, [&](const TrueDistance& one) {
    if (!least || one.distance_m < least->distance_m) least = one;
  });
  return least;
}

namespace {

/// A burn of the mission file or of a fault takes effect when it is announced.
bool is_commanded(const ManeuverRow& row) {
  return row.waypoint_index >= 0 || row.command_time_s < row.execution_time_s;
}

}  // namespace

void summarise_thrust(const RunRecord& record, Summary& summary) {
  if (!summary.thrust) return;
  Thrust& thrust = *summary.thrust;
  thrust = {.max_thrust_n = thrust.max_thrust_n, .mass_kg = thrust.mass_kg};
  std::vector<ManeuverRow> burns;
  for (const ManeuverRow& row : executed_in_order(record))
    if (is_commanded(row)) burns.push_back(row);
  thrust.burns = static_cast<int>(burns.size());
  for (std::size_t k = 0; k < burns.size(); ++k) {
    const double duration_s = thrust.mass_kg * magnitude(burns[k].executed_dv_rtn_mps) / thrust.max_thrust_n;
    if (duration_s > thrust.longest_burn_s) {
      thrust.longest_burn_s = duration_s;
      thrust.longest_burn_at_h = burns[k].execution_time_s / 3600.0;
    }
    const bool has_next = k + 1 < burns.size();
    if (has_next && duration_s > burns[k + 1].execution_time_s - burns[k].execution_time_s) ++thrust.burns_too_long;
  }
}

std::string thrust_line(const Summary& summary) {
  if (!summary.thrust || summary.thrust->burns == 0) return "";
  const Thrust& thrust = *summary.thrust;
  return fmt::format(
      "thrust: {} of {} burns would last longer than the time to the next burn at {:g} N and {:g} kg; the longest, at "
      "{:.3f} h, {:.3g} s; burns are flown as impulses",
      thrust.burns_too_long, thrust.burns, thrust.max_thrust_n, thrust.mass_kg, thrust.longest_burn_at_h,
      thrust.longest_burn_s);
}

}  // namespace vbar::report
