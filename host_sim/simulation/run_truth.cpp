#include "host_sim/simulation/run_truth.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <variant>

#include "host_sim/simulation/initial_state.h"
#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/truth/orbital_motion.h"

namespace vbar::app {

RunTruth::RunTruth(const mission::Mission& mission, const mission::Spacecraft& servicer,
                   const std::filesystem::path& data_directory)
    : epoch_(mission.epoch),
      truth_(truth_settings(mission, data_directory)),
      earth_rotation_(truth_.data().earth_orientation, mission.epoch),
      is_pointed_(servicer.attitude && std::holds_alternative<mission::Commanded>(*servicer.attitude)) {
  place_spacecraft(mission, data_directory, truth_);
  set_attitudes(mission, data_directory, truth_);
  servicer_ = truth_.index_of(servicer.name);
  for (const mission::Spacecraft& spacecraft : mission.spacecraft) {
    names_.push_back(spacecraft.name);
    indices_.push_back(truth_.index_of(spacecraft.name));
  }
}

twins::TruthSnapshot RunTruth::snapshot(twins::TruthDetail detail) {
  twins::TruthSnapshot truth;
  truth.time = truth_.time();
  truth.R_itrf_gcrf = earth_rotation_.R_itrf_gcrf_at(mission_seconds(truth.time));
  for (std::size_t k = 0; k < names_.size(); ++k) {
    const std::size_t index = indices_[k];
    twins::SpacecraftTruth& one = truth.spacecraft.emplace_back();
    one.name = names_[k];
    one.orbit = truth_.state(index);
    if (truth_.has_attitude(index)) one.attitude = truth_.attitude(index);
    if (detail == twins::TruthDetail::kAccelerations) add_accelerations(index, one);
  }
  return truth;
}

// The angular one by a difference of second order into the past, as far as the attitude is kept.
void RunTruth::add_accelerations(std::size_t index, twins::SpacecraftTruth& one) const {
  one.acceleration_eci = truth_.acceleration_eci(index, one.orbit);
  if (!one.attitude) return;
  constexpr double kStep_s = 0.05;
  const auto rate = [&](int steps) {
    return truth_.attitude_at(index, truth_.time() - fsw::nearest_duration(steps * kStep_s)).rate_body;
  };
  try {
    one.angular_acceleration_body = (3.0 * one.attitude->rate_body - 4.0 * rate(1) + rate(2)) / (2.0 * kStep_s);
  } catch (const std::out_of_range&) {
    one.angular_acceleration_body = std::nullopt;  // the attitude began less than a tenth of a second ago
  }
}

twins::TruthSnapshot RunTruth::at(fsw::GpsTime time) {
  const fsw::Duration ahead = time - truth_.time();
  if (ahead < fsw::Duration{} || ahead > kHorizon)
    throw std::out_of_range("the truth's outlook reaches one second ahead");
  twins::TruthSnapshot truth = snapshot(twins::TruthDetail::kAccelerations);
  truth.time = time;
  truth.R_itrf_gcrf = earth_rotation_.R_itrf_gcrf_at(mission_seconds(time));
  const double dt = fsw::seconds(ahead);
  for (std::size_t k = 0; k < names_.size(); ++k) {
    twins::SpacecraftTruth& one = truth.spacecraft[k];
    one.orbit = truth_.state_ahead(indices_[k], time);
    one.acceleration_eci = truth_.acceleration_eci(indices_[k], one.orbit);
    if (!one.attitude) continue;
    one.attitude =
        truth::attitude_ahead(*one.attitude, one.angular_acceleration_body.value_or(fsw::Vector3::Zero()), dt);
  }
  return truth;
}

void RunTruth::point(fsw::GpsTime time, const fsw::Vector3& boresight_rtn, const fsw::Vector3& boresight_rate_rtn) {
  if (is_pointed_) static_cast<void>(truth_.command_pointing(servicer_, time, boresight_rtn, boresight_rate_rtn));
}

namespace {

truth::TruthStatistics since(const truth::TruthStatistics& before, const truth::TruthStatistics& now) {
  return {now.steps - before.steps, now.rejected_steps - before.rejected_steps,
          now.force_evaluations - before.force_evaluations, now.edges_crossed - before.edges_crossed,
          now.wall_s - before.wall_s};
}

}  // namespace

/// Sums what drag takes from the semi-major axis: da/dt = 2 a^2 / GM (velocity . drag), by the trapezoidal rule over
/// the sampling times. The motion itself does not show it: the field's tesserals move the mean semi-major axis
/// by ten metres, more than a day's drag.
class Propagation::DecayMeter {
 public:
  explicit DecayMeter(double gm) : gm_(gm) {}

  void add(double seconds, const fsw::orbit::CartesianState& state, const fsw::Vector3& drag_eci) {
    const double a = 1.0 / (2.0 / state.position_eci.norm() - state.velocity_eci.squaredNorm() / gm_);
    const double rate = 2.0 * a * a / gm_ * state.velocity_eci.dot(drag_eci);
    if (last_) change_ += 0.5 * (rate + last_->rate) * (seconds - last_->seconds);
    last_ = {seconds, rate};
  }

  [[nodiscard]] std::optional<double> change() const { return last_ ? std::optional(change_) : std::nullopt; }

 private:
  struct Sample {
    double seconds;
    double rate;
  };

  double gm_;
  double change_ = 0.0;
  std::optional<Sample> last_;
};

Propagation::Propagation(const mission::Mission& mission, const std::filesystem::path& data_directory)
    : mission_(mission),
      truth_(truth_settings(mission, data_directory)),
      earth_rotation_(truth_.data().earth_orientation, mission.epoch) {
  place_spacecraft(mission, data_directory, truth_);
  mission_place_.resize(mission.spacecraft.size());
  for (const mission::Spacecraft& spacecraft : mission.spacecraft) {
    const std::size_t index = truth_.index_of(spacecraft.name);
    mission_place_[index] = truth_index_.size();
    truth_index_.push_back(index);
  }
}

std::vector<fsw::GpsTime> Propagation::sampling_times() const {
  std::vector<fsw::GpsTime> times;
  for (fsw::GpsTime time = mission_.start_time(); time < mission_.end_time(); time = mission_.step.next_after(time))
    times.push_back(time);
  times.push_back(mission_.end_time());
  return times;
}

std::vector<std::string> Propagation::names() const {
  std::vector<std::string> names;
  for (const mission::Spacecraft& spacecraft : mission_.spacecraft) names.push_back(spacecraft.name);
  return names;
}

fsw::Vector3 Propagation::drag_eci(std::size_t truth_index) {
  const std::vector<truth::ForceAcceleration> shares = truth_.accelerations(truth_index);
  const auto drag = std::ranges::find(shares, std::string_view("drag"), &truth::ForceAcceleration::force);
  return drag == shares.end() ? fsw::Vector3::Zero().eval() : drag->acceleration_eci;
}

/// Returns a number that makes the start of threads, and the memory of a spacecraft that the processor's caches no
/// longer hold, cheap beside the work, and a stop prompt.
std::size_t Propagation::samplings_at_once() const {
  // Of all spacecraft together; each bound is a tenth of a second of work or so.
  constexpr double kSimulated_s = 1e5, kRows = 1e4;
  constexpr double kMin = 16.0;
  const double step_s = fsw::seconds(mission_.step.next_after(mission_.start_time()) - mission_.start_time());
  const double rows = std::min(kSimulated_s / step_s, kRows);
  return static_cast<std::size_t>(std::max(rows / static_cast<double>(mission_.spacecraft.size()), kMin));
}

report::EphemerisRow Propagation::row_at(const Sampling& sampling, std::size_t truth_index) const {
  report::EphemerisRow row;
  row.time = sampling.time;
  row.time_s = sampling.time_s;
  row.state = truth_.state(truth_index);
  row.geodetic = truth::geodetic_from_itrf(sampling.R_itrf_gcrf * row.state.position_eci);
  return row;
}

void Propagation::fly_through(std::span<const fsw::GpsTime> times, std::vector<DecayMeter>& decay, const RowSink& sink,
                              report::PropagationRecord& record) {
  std::vector<Sampling> samplings;
  for (const fsw::GpsTime time : times) {
    const double time_s = fsw::seconds(time - mission_.epoch);
    samplings.push_back({time, time_s, earth_rotation_.R_itrf_gcrf_at(time_s)});
  }
  truth_.advance_through(times, [&](std::size_t index, std::size_t place) {
    const auto started = std::chrono::steady_clock::now();
    const std::size_t k = mission_place_[index];
    const report::EphemerisRow row = row_at(samplings[place], index);
    if (mission_.truth.forces.drag) decay[k].add(row.time_s, row.state, drag_eci(index));
    report::PropagatedSpacecraft& outcome = record.spacecraft[k];
    if (row.time == mission_.start_time()) outcome.first_altitude_m = row.geodetic.altitude;
    outcome.last_altitude_m = row.geodetic.altitude;
    sink(k, row);
    sampling_s_[k] += std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  });
}

report::PropagationRecord Propagation::run(const RowSink& sink, const std::function<void(fsw::Duration)>& progress,
                                           const std::function<bool()>& stop_requested) {
  auto started = std::chrono::steady_clock::now();
  report::PropagationRecord record;
  record.mission = mission_.name;
  record.threads = mission_.truth.threads;
  record.data_notes = truth_.data().notes;
  std::vector<DecayMeter> decay;
  for (std::size_t k = 0; k < truth_index_.size(); ++k) {
    record.spacecraft.emplace_back().name = mission_.spacecraft[k].name;
    decay.emplace_back(truth_.data().gravity->gm());
  }
  sampling_s_.assign(truth_index_.size(), 0.0);
  std::vector<truth::TruthStatistics> at_start(truth_index_.size());
  truth::TruthStatistics total_at_start;
  try {
    // What leads from the epoch to the start is not part of the span that is reported.
    truth_.advance_to(mission_.start_time());
    started = std::chrono::steady_clock::now();
    for (std::size_t k = 0; k < truth_index_.size(); ++k) at_start[k] = truth_.statistics(truth_index_[k]);
    total_at_start = truth_.statistics();
    truth_.measure_force_times(true);
    record.complete = true;
    const std::vector<fsw::GpsTime> times = sampling_times();
    for (std::size_t first = 0; first < times.size();) {
      if (stop_requested && stop_requested()) {
        record.complete = false;
        record.incomplete_reason = kInterruption;
        break;
      }
      const std::size_t count = std::min(samplings_at_once(), times.size() - first);
      fly_through(std::span(times).subspan(first, count), decay, sink, record);
      first += count;
      if (progress) progress(truth_.time() - mission_.start_time());
    }
  } catch (const std::exception& error) {
    record.complete = false;
    record.incomplete_reason = error.what();
  }
  for (std::size_t k = 0; k < truth_index_.size(); ++k) {
    record.spacecraft[k].statistics = since(at_start[k], truth_.statistics(truth_index_[k]));
    record.spacecraft[k].semi_major_axis_change_by_drag_m = decay[k].change();
  }
  record.total = since(total_at_start, truth_.statistics());
  record.force_times = truth_.force_times();
  record.force_times.push_back({"sampling", std::accumulate(sampling_s_.begin(), sampling_s_.end(), 0.0)});
  record.simulated_s = fsw::seconds(truth_.time() - mission_.start_time());
  record.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return record;
}

}  // namespace vbar::app
