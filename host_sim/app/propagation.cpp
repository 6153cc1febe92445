#include "host_sim/app/propagation.h"

#include <chrono>
#include <cmath>
#include <exception>
#include <optional>

#include "fsw/orbit/mean_osculating.h"
#include "host_sim/app/initial_orbits.h"
#include "host_sim/truth/earth/geodetic.h"

namespace vbar::app {

/// Averages the mean semi-major axis over the first and the last revolution of a flight.
class Propagation::DecayMeter {
 public:
  DecayMeter(const fsw::orbit::CartesianState& start, double gm, fsw::Duration flight) {
    const double a = 1.0 / (2.0 / start.position_eci.norm() - start.velocity_eci.squaredNorm() / gm);
    const fsw::Duration revolution = fsw::nearest_duration(2.0 * M_PI * std::sqrt(a / gm) * a);
    if (revolution + revolution > flight) return;
    first_end_ = revolution;
    last_start_ = fsw::Duration{flight.ns - revolution.ns};
  }

  void add(fsw::Duration since_start, const fsw::orbit::CartesianState& state) {
    if (!first_end_) return;
    Average* average = since_start < *first_end_ ? &first_ : since_start > last_start_ ? &last_ : nullptr;
    if (average == nullptr) return;
    const auto osculating = fsw::orbit::qns_from_cartesian(state);
    if (!osculating.ok()) return;
    const auto mean = fsw::orbit::mean_from_osculating(osculating.value());
    if (!mean.ok()) return;
    average->sum += mean.value().a;
    ++average->count;
  }

  [[nodiscard]] std::optional<double> change() const {
    if (first_.count == 0 || last_.count == 0) return std::nullopt;
    return last_.sum / last_.count - first_.sum / first_.count;
  }

 private:
  struct Average {
    double sum = 0.0;
    int count = 0;
  };

  std::optional<fsw::Duration> first_end_;  ///< nothing if the flight is too short
  fsw::Duration last_start_;
  Average first_, last_;
};

Propagation::Propagation(const mission::Mission& mission, const std::filesystem::path& data_directory)
    : mission_(mission),
      truth_(truth_settings(mission, data_directory)),
      earth_rotation_(truth_.data().earth_orientation, mission.epoch) {
  place_spacecraft(mission, truth_);
  for (const mission::Spacecraft& spacecraft : mission.spacecraft)
    truth_index_.push_back(truth_.index_of(spacecraft.name));
}

std::vector<fsw::GpsTime> Propagation::sampling_times() const {
  std::vector<fsw::GpsTime> times;
  for (fsw::GpsTime time = mission_.start_time(); time < mission_.end_time(); time = time + mission_.step)
    times.push_back(time);
  times.push_back(mission_.end_time());
  return times;
}

std::vector<std::string> Propagation::names() const {
  std::vector<std::string> names;
  for (const mission::Spacecraft& spacecraft : mission_.spacecraft) names.push_back(spacecraft.name);
  return names;
}

void Propagation::sample(std::vector<DecayMeter>& decay, const RowSink& sink, report::PropagationRecord& record) {
  report::EphemerisRow row;
  row.time = truth_.time();
  row.time_s = fsw::seconds(row.time - mission_.epoch);
  const fsw::Matrix3 R_itrf_gcrf = earth_rotation_.R_itrf_gcrf_at(row.time_s);
  for (std::size_t k = 0; k < truth_index_.size(); ++k) {
    row.state = truth_.state(truth_index_[k]);
    row.geodetic = truth::geodetic_from_itrf(R_itrf_gcrf * row.state.position_eci);
    decay[k].add(row.time - mission_.start_time(), row.state);
    report::PropagatedSpacecraft& outcome = record.spacecraft[k];
    if (row.time == mission_.start_time()) outcome.first_altitude_m = row.geodetic.altitude;
    outcome.last_altitude_m = row.geodetic.altitude;
    sink(k, row);
  }
}

report::PropagationRecord Propagation::run(const RowSink& sink, const std::function<void(fsw::Duration)>& progress,
                                           const std::function<bool()>& stop_requested) {
  const auto started = std::chrono::steady_clock::now();
  report::PropagationRecord record;
  record.mission = mission_.name;
  record.threads = mission_.truth.threads;
  std::vector<DecayMeter> decay;
  for (std::size_t k = 0; k < truth_index_.size(); ++k) {
    record.spacecraft.emplace_back().name = mission_.spacecraft[k].name;
    decay.emplace_back(truth_.state(truth_index_[k]), truth_.data().gravity->gm(), mission_.duration);
  }
  truth_.measure_force_times(true);
  try {
    record.complete = true;
    for (const fsw::GpsTime time : sampling_times()) {
      if (stop_requested && stop_requested()) {
        record.complete = false;
        record.incomplete_reason = "interrupted";
        break;
      }
      truth_.advance_to(time);
      sample(decay, sink, record);
      if (progress) progress(time - mission_.start_time());
    }
  } catch (const std::exception& error) {
    record.complete = false;
    record.incomplete_reason = error.what();
  }
  for (std::size_t k = 0; k < truth_index_.size(); ++k) {
    record.spacecraft[k].statistics = truth_.statistics(truth_index_[k]);
    record.spacecraft[k].semi_major_axis_change_m = decay[k].change();
  }
  record.total = truth_.statistics();
  record.force_times = truth_.force_times();
  record.simulated_s = fsw::seconds(truth_.time() - mission_.start_time());
  record.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return record;
}

}  // namespace vbar::app
