#pragma once
// The true motion of all spacecraft of a run: the reference of every error.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"
#include "host_sim/truth/attitude/attitude_settings.h"
#include "host_sim/truth/force_list.h"
#include "host_sim/truth/spacecraft_propagator.h"
#include "host_sim/truth/truth_settings.h"

namespace vbar::truth {

/// Cost of a run so far, of one spacecraft or of all.
struct TruthStatistics {
  std::int64_t steps = 0;
  std::int64_t rejected_steps = 0;
  std::int64_t force_evaluations = 0;
  std::int64_t edges_crossed = 0;  ///< number of shadow edges crossed
  double wall_s = 0.0;             ///< wall-clock time spent inside the model; stated for all spacecraft together only
};

/// Truth of all spacecraft. Every spacecraft has its own integrator with the same settings, and its steps depend on its
/// own state and impulses only: not on the times asked for, the other spacecraft, or the number of threads. All calls
/// from one thread, but for those that advance_through() allows.
class TruthModel {
 public:
  /// Loads the data. Throws std::invalid_argument for a setting out of range, std::runtime_error for a missing or
  /// damaged file, std::out_of_range if the data do not reach from the epoch to the end.
  explicit TruthModel(const TruthSettings& settings);

  /// Adds a spacecraft at the current time and returns its index (0, 1, ...). Throws std::invalid_argument for an empty
  /// or used name and for a mass, area or coefficient that one of the forces needs and the spacecraft does not have,
  /// std::domain_error for a state that is not an orbit.
  std::size_t add_spacecraft(const SpacecraftSettings& spacecraft);

  /// Adds a spacecraft without a surface, on which no surface force acts.
  std::size_t add_spacecraft(const std::string& name, const fsw::orbit::CartesianState& osculating) {
    return add_spacecraft({name, osculating, {}});
  }

  /// Returns the data that the forces share.
  const ForceData& data() const { return data_; }

  /// Adds a sentence to the notes of the data.
  void add_data_note(std::string note) { data_.notes.push_back(std::move(note)); }

  std::size_t spacecraft_count() const { return spacecraft_.size(); }

  /// Throws std::invalid_argument for a name that no spacecraft has.
  std::size_t index_of(std::string_view name) const;

  /// Moves all spacecraft to exactly `time`. Throws std::invalid_argument for a time before the current one,
  /// std::domain_error if a spacecraft re-enters or leaves its ellipse, std::out_of_range if the Earth orientation data
  /// end; the model must not be used any more.
  void advance_to(fsw::GpsTime time);

  /// Moves all spacecraft to each of `times`, which ascend, and calls `at(index, place)` when a spacecraft is at
  /// times[place]: in order of time for one spacecraft, for several at once, from the threads of the settings. What is
  /// called may ask for state(index) and accelerations(index) of that spacecraft only. If spacecraft fail, the others
  /// reach the last time, time() is the last one that all have reached, and the first failure is thrown as by
  /// advance_to(); the model must not be used any more.
  void advance_through(std::span<const fsw::GpsTime> times,
                       const std::function<void(std::size_t index, std::size_t place)>& at);

  fsw::GpsTime time() const { return time_; }

  /// Returns the osculating state in GCRF at the current time. Throws std::out_of_range for an index that no spacecraft
  /// has.
  fsw::orbit::CartesianState state(std::size_t index) const;
  fsw::orbit::CartesianState state(std::string_view name) const { return state(index_of(name)); }

  /// Returns the state at another time near the current one: within the integration steps kept, from some minutes
  /// before to at least the current time. Throws std::out_of_range outside.
  fsw::orbit::CartesianState state_at(std::size_t index, fsw::GpsTime time) const;

  /// Returns the state at a time up to a second or so after the current one. No step is taken for it: beyond the last
  /// one the perturbations are those of the current time (to a micrometre in a second).
  fsw::orbit::CartesianState state_ahead(std::size_t index, fsw::GpsTime time) const;

  /// Returns the total acceleration at a state of about the current time, the point mass included.
  fsw::Vector3 acceleration_eci(std::size_t index, const fsw::orbit::CartesianState& state) const;

  /// Adds a velocity (m/s, in the spacecraft's own RTN) at the current time.
  void apply_impulse_rtn(std::size_t index, const fsw::Vector3& dv_rtn);

  /// Begins a burn with a duration at the current time, whatever `arc.begin_s` states. Throws std::logic_error for a
  /// spacecraft whose burns are impulses.
  void begin_burn(std::size_t index, ThrustArc arc);

  /// Gives a spacecraft an attitude from the current time on. Throws std::invalid_argument for inconsistent settings
  /// (an invalid body, parallel axes, an unknown spacecraft to point at). `later`: the attitudes that follow, in order
  /// of time; the last one of those that begin before the current time, or at it, holds at once, without a slew.
  void set_attitude(std::size_t index, const AttitudeSettings& settings,
                    const std::vector<LaterAttitudeSettings>& later = {});

  /// Commands the boresight of a spacecraft with a commanded attitude to a direction in its own RTN: a unit vector and
  /// its rate there (1/s), at `time`. A command for the past takes effect now, with its line advanced to now. False if
  /// it is rejected (CommandedAttitude::take). Throws std::logic_error if the attitude is not a commanded one.
  bool command_pointing(std::size_t index, fsw::GpsTime time, const fsw::Vector3& boresight_rtn,
                        const fsw::Vector3& boresight_rate_rtn);

  bool has_attitude(std::size_t index) const { return spacecraft_.at(index)->has_attitude(); }

  /// Returns the attitude at the current time. Throws std::logic_error if the spacecraft has none, std::domain_error
  /// where its pointing does not determine it.
  AttitudeState attitude(std::size_t index) const { return attitude_at(index, time_); }

  /// Returns the attitude at another time near the current one, as state_at; for a spacecraft that points at another,
  /// where the states of both are kept.
  AttitudeState attitude_at(std::size_t index, fsw::GpsTime time) const;

  TruthStatistics statistics() const;
  TruthStatistics statistics(std::size_t index) const;

  /// Returns the forces' shares of a spacecraft's acceleration beside the Earth's point mass, at the current time.
  std::vector<ForceAcceleration> accelerations(std::size_t index) { return spacecraft_.at(index)->accelerations(); }

  /// Measures the time of each force from now on, or stops measuring. Times are sums over the spacecraft, in the
  /// forces' order, that of the frames first.
  void measure_force_times(bool on);
  std::vector<ForceTime> force_times() const;

 private:
  double seconds_after_epoch(fsw::GpsTime time) const { return fsw::seconds(time - settings_.epoch); }
  fsw::Vector3 perturbation_eci(std::size_t index) const;
  std::unique_ptr<AttitudeMotion> attitude_motion(std::size_t index, const AttitudeSettings& settings);
  void work_in_parallel(std::size_t count, const std::function<void(std::size_t)>& work) const;

  TruthSettings settings_;
  fsw::GpsTime time_;
  ForceData data_;
  bool measures_force_times_ = false;
  std::vector<std::unique_ptr<SpacecraftPropagator>> spacecraft_;
  std::map<std::string, std::size_t, std::less<>> index_of_name_;
  double wall_s_ = 0.0;
};

}  // namespace vbar::truth
