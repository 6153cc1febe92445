#include "host_sim/report/summarise.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>

#include <fmt/format.h>

#include "host_sim/report/csv_table.h"
#include "host_sim/report/extension.h"
#include "host_sim/report/run_series.h"
#include "host_sim/report/statistics.h"

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

namespace {

// Statistics of carrier-phase navigation are those after the first fix, as the paper's are.
void summarise_navigation(const RunRecord& record, Summary& summary) {
  const std::optional<double> fix_s = first_fix(record);
  std::vector<double> position_errors, velocity_errors;
  for (const NavigationError& error : navigation_errors(record)) {
    if (fix_s && error.time_s < *fix_s) continue;
    position_errors.push_back(magnitude(error.position_rtn));
    velocity_errors.push_back(magnitude(error.velocity_rtn));
  }
  summary.first_fix_s = fix_s && !record.truth.empty() ? std::optional(*fix_s - record.truth.front().time_s) : fix_s;
  summary.navigation_nees.reset();  // it is that of the module that navigates
  summary.navigation_error_m = statistics_of(position_errors);
  summary.navigation_velocity_error_mps = statistics_of(velocity_errors);
}

void summarise_maneuvers(const RunRecord& record, Summary& summary) {
  summary.dv_mps = 0.0;
  summary.maneuvers = 0;
  for (const ManeuverRow& maneuver : record.maneuvers) {
    if (!maneuver.accepted) continue;
    summary.dv_mps += magnitude(maneuver.executed_dv_rtn_mps);
    ++summary.maneuvers;
  }
}

/// A run too short to tell, or one that navigated late, did not fail. Flight software that has to navigate says so
/// itself, unless it refused even the time of its steps.
bool never_navigated(const RunRecord& record, const Summary& summary) {
  const bool is_reported = summary.health && (summary.health->faults & telemetry_health::kFaultNeverNavigated) != 0;
  const bool is_passed = !record.of<telemetry_health>().empty() && !reached_waypoints(record).empty();
  return (is_reported || is_passed) &&
         std::ranges::none_of(record.estimates, [](const EstimateRow& row) { return row.navigation_valid != 0; });
}

/// The waypoint to whose leg a burn belongs; null after the last one. That is the waypoint it was commanded for: the
/// last burn of a fuel-optimal leg stands at the waypoint's own time and stops the arrival. A burn for none of the
/// table (of a retreat, or of flight software without waypoints) belongs to the leg in whose time it stands.
const WaypointRow* leg_of(const ManeuverRow& maneuver, const std::vector<WaypointRow>& waypoints) {
  auto found = std::ranges::find(waypoints, maneuver.waypoint_index, &WaypointRow::index);
  if (found == waypoints.end())
    found = std::ranges::find_if(waypoints,
                                 [&](const WaypointRow& row) { return maneuver.execution_time_s <= row.time_s; });
  return found != waypoints.end() ? &*found : nullptr;
}

void summarise_distance(const RunRecord& record, Summary& summary) {
  const std::optional<TrueDistance> least = min_distance(record);
  summary.min_distance_m = least ? std::optional(least->distance_m) : std::nullopt;
  summary.min_distance_at_h = least ? std::optional(least->time_s / 3600.0) : std::nullopt;
}

/// Summarises the cost of the flight computer's steps; its unit is a fact.
void summarise_flight_steps(const RunRecord& record, Summary& summary) {
  Summary::FlightStep total;
  total.unit = summary.flight_step.unit;
  double sum = 0.0;
  for (const EstimateRow& row : record.estimates) {
    ++total.count;
    total.max = std::max(total.max, row.step_cost);
    total.stack_bytes_max = std::max(total.stack_bytes_max, row.stack_bytes);
    sum += static_cast<double>(row.step_cost);
  }
  if (total.count > 0) total.mean = sum / static_cast<double>(total.count);
  summary.flight_step = total;
}

/// Of missions with a table [safety]: demands to retreat, alarms of the guard, drifts that do not keep the distance,
/// and the largest collision probability after the retreat burn of a step. Counts are zero where there was nothing to
/// count.
void summarise_safety(const RunRecord& record, Summary& summary) {
  using Health = telemetry_health;
  const auto is_one_of = [](std::int32_t fault, std::initializer_list<std::int32_t> faults) {
    return std::ranges::find(faults, fault) != faults.end();
  };
  if (record.of<telemetry_safety>().empty()) return;
  double retreats = 0.0, alarms = 0.0, drifts = 0.0, probability = 0.0;
  for (const auto& [time_s, step_time_s, event] : record.of<telemetry_event>()) {
    if (event.event != telemetry_event::kEventFaultRaised) continue;
    if (is_one_of(event.fault, {Health::kFaultRetreat})) ++retreats;
    if (is_one_of(event.fault, {Health::kFaultGuardRange, Health::kFaultGuardSilence, Health::kFaultGuardBurns,
                                Health::kFaultGuardClosing}))
      ++alarms;
    if (is_one_of(event.fault, {Health::kFaultDriftUnsafe, Health::kFaultCollisionProbability})) ++drifts;
  }
  for (const auto& [time_s, step_time_s, safety] : record.of<telemetry_safety>())
    probability = std::max(probability, safety.collision_probability);
  summary.sensor_figures["safety"] = {{"retreats", retreats},
                                      {"guard_alarms", alarms},
                                      {"drifts_unsafe", drifts},
                                      {"collision_probability_max", probability}};
}

}  // namespace

Summary summarise(const RunRecord& record) {
  Summary summary = record.summary;
  // A killed run did not say how long it was.
  if (!summary.complete && summary.simulated_s == 0.0 && !record.truth.empty())
    summary.simulated_s = record.truth.back().time_s - record.truth.front().time_s;
  summarise_navigation(record, summary);
  summarise_maneuvers(record, summary);
  summarise_thrust(record, summary);
  summarise_distance(record, summary);
  summarise_flight_steps(record, summary);
  summary.sensor_figures.clear();
  for (const Extension* extension : record.extensions)
    if (extension->summarise != nullptr) extension->summarise(record, summary);
  summarise_safety(record, summary);
  summarise_consistency(record, summary);
  if (!record.of<telemetry_health>().empty()) summary.health = record.of<telemetry_health>().back().message;
  summary.never_navigated = never_navigated(record, summary);
  return summary;
}

void evaluate(RunRecord& record) {
  const std::vector<NavigationError> errors = navigation_errors(record);
  double cumulative = 0.0;
  for (WaypointRow& waypoint : record.waypoints) {
    const auto error = std::ranges::find(errors, waypoint.time_s, &NavigationError::time_s);
    if (error != errors.end()) {
      waypoint.navigation_error_m = magnitude(error->position_rtn);
      waypoint.navigation_velocity_error_mps = magnitude(error->velocity_rtn);
    }
    waypoint.leg_dv_mps = 0.0;
    waypoint.leg_maneuvers = 0;
    for (const ManeuverRow& maneuver : record.maneuvers) {
      if (!maneuver.accepted || leg_of(maneuver, record.waypoints) != &waypoint) continue;
      waypoint.leg_dv_mps += magnitude(maneuver.executed_dv_rtn_mps);
      ++waypoint.leg_maneuvers;
    }
    cumulative += waypoint.leg_dv_mps;
    waypoint.cumulative_dv_mps = cumulative;
  }
  record.summary = summarise(record);
}

std::string output_line(const Summary& summary) {
  const FlightOutput& output = summary.flight_output;
  std::string line;
  const auto add = [&](std::uint64_t count, const std::string& text) {
    if (count > 0) line += (line.empty() ? "" : ", ") + text;
  };
  const auto steps = [&](std::uint64_t count) { return fmt::format("{} of {} steps", count, output.steps); };
  add(output.steps_failed,
      fmt::format("{} returned an error (the last one status {})", steps(output.steps_failed), output.last_status));
  add(output.steps_silent, steps(output.steps_silent) + " sent nothing");
  add(output.packets_invalid, fmt::format("{} packets that it sent are invalid", output.packets_invalid));
  add(output.packets_dropped, fmt::format("{} packets that it sent were dropped", output.packets_dropped));
  add(output.inputs_refused, fmt::format("{} inputs refused with an error", output.inputs_refused));
  return line;
}

std::string health_line(const telemetry_health& health) {
  std::string line;
  visit_fields(health, [&](const Field& field, const auto& value) {
    const std::string_view name = field.name;
    if (value == 0 || name == "step" || name == "packets_accepted") return;
    std::string words(name);
    std::ranges::replace(words, '_', ' ');
    line += line.empty() ? "" : ", ";
    line +=
        words + " " + (field.codes.count > 0 ? word_of(field.codes, static_cast<int>(value)) : std::to_string(value));
  });
  return line;
}

}  // namespace vbar::report
