#pragma once
// The true motion of all spacecraft of a run: the ground truth that every error is measured against.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "fsw/core/gps_time.h"
#include "fsw/core/types.h"
#include "fsw/orbit/elements.h"
#include "host_sim/truth/attitude/attitude_settings.h"
#include "host_sim/truth/earth/earth_orientation.h"
#include "host_sim/truth/forces/gravity_field.h"
#include "host_sim/truth/spacecraft_propagator.h"

namespace vbar::truth {

struct TruthSettings {
  fsw::GpsTime epoch;        ///< start of the run
  int gravity_degree = 60;   ///< 0 (point mass) to 120
  int gravity_order = 60;    ///< 0 to the degree
  double tolerance = 1e-13;  ///< local error a step, in units of the orbit's size: kSmallestTolerance to 1e-3
  int threads = 1;           ///< at most so many spacecraft are propagated at a time; does not change a bit
  std::filesystem::path data_directory;  ///< the project's data folder (gravity and Earth orientation)

  /// Below it rounding, which a step cannot beat, would decide about the step size.
  static constexpr double kSmallestTolerance = 1e-14;
};

/// Cost of a run so far, over all spacecraft.
struct TruthStatistics {
  std::int64_t steps = 0;
  std::int64_t rejected_steps = 0;
  std::int64_t force_evaluations = 0;
  double wall_s = 0.0;  ///< wall-clock time spent inside the model
};

/// Every spacecraft has its own integrator with the same settings, and its steps depend on its own state and impulses
/// only: not on the times asked for, the other spacecraft, or the number of threads. All calls from one thread.
class TruthModel {
 public:
  /// Loads the data. Throws std::invalid_argument for a setting out of range, std::runtime_error for a missing or
  /// damaged file, std::out_of_range for an epoch outside the Earth orientation data.
  explicit TruthModel(const TruthSettings& settings);

  /// Adds a spacecraft at the current time and returns its index (0, 1, ...). `osculating`: position and velocity in
  /// GCRF. Throws std::invalid_argument for an empty or used name, std::domain_error for a state that is not an orbit.
  std::size_t add_spacecraft(const std::string& name, const fsw::orbit::CartesianState& osculating);

  std::size_t spacecraft_count() const { return spacecraft_.size(); }

  /// Throws std::invalid_argument for a name that no spacecraft has.
  std::size_t index_of(std::string_view name) const;

  /// Moves all spacecraft to exactly `time`. Throws std::invalid_argument for a time before the current one,
  /// std::domain_error if a spacecraft re-enters or leaves its ellipse, std::out_of_range if the Earth orientation data
  /// end; the model is then of no further use.
  void advance_to(fsw::GpsTime time);

  fsw::GpsTime time() const { return time_; }

  /// Osculating state in GCRF at the current time. Throws std::out_of_range for an index that no spacecraft has.
  fsw::orbit::CartesianState state(std::size_t index) const;
  fsw::orbit::CartesianState state(std::string_view name) const { return state(index_of(name)); }

  /// State at another time near the current one: within the integration steps kept, from some minutes before to at
  /// least the current time. Throws std::out_of_range outside.
  fsw::orbit::CartesianState state_at(std::size_t index, fsw::GpsTime time) const;

  /// Adds a velocity (m/s, in the spacecraft's own RTN) at the current time.
  void apply_impulse_rtn(std::size_t index, const fsw::Vector3& dv_rtn);

  /// Gives a spacecraft an attitude from the current time on. Throws std::invalid_argument for settings that make none
  /// (a body that is none, axes that are not two, a spacecraft to point at that is not there).
  void set_attitude(std::size_t index, const AttitudeSettings& settings);

  bool has_attitude(std::size_t index) const { return spacecraft_.at(index)->has_attitude(); }

  /// Attitude at the current time. Throws std::logic_error if the spacecraft has none, std::domain_error where its
  /// pointing does not determine it.
  AttitudeState attitude(std::size_t index) const { return attitude_at(index, time_); }

  /// Attitude at another time near the current one, as state_at; of a spacecraft that points at another, where the
  /// states of both are kept.
  AttitudeState attitude_at(std::size_t index, fsw::GpsTime time) const;

  TruthStatistics statistics() const;

 private:
  double seconds_after_epoch(fsw::GpsTime time) const { return fsw::seconds(time - settings_.epoch); }
  void advance_in_parallel(const std::vector<SpacecraftPropagator*>& spacecraft, double seconds) const;

  TruthSettings settings_;
  fsw::GpsTime time_;
  std::shared_ptr<const EarthOrientationSeries> earth_orientation_;
  std::shared_ptr<const GravityField> gravity_;
  std::vector<std::unique_ptr<SpacecraftPropagator>> spacecraft_;
  double wall_s_ = 0.0;
};

}  // namespace vbar::truth
