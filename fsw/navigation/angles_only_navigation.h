#pragma once
// Navigation with a camera and the servicer's own GNSS receiver: estimates a smooth orbit of the servicer, determines
// the initial relative orbit from a batch of bearings with an a-priori orbit, and then estimates it by a filter.
//
// Epochs must be passed in order of time. A measurement at the time of a burn counts as after it.

#include <cstdint>
#include <optional>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/navigation/bearing.h"
#include "fsw/navigation/bearing_batch.h"
#include "fsw/navigation/burn.h"
#include "fsw/navigation/own_orbit.h"
#include "fsw/navigation/roe_filter.h"
#include "fsw/orbit/earth_rotation.h"

namespace vbar::fsw::navigation {

struct AnglesOnlySettings {
  OwnOrbitSettings own_orbit;
  RoeFilterSettings filter;
  BearingBatchSettings batch;
  orbit::EarthOrientation earth;
};

/// A-priori orbit of the target; 1 sigma of a * ROE with respect to the servicer, m.
struct TargetApriori {
  GpsTime time;
  orbit::CartesianState target;
  Vector6 sigma_a_roe_m = Vector6::Zero();
};

struct AnglesOnlyCounters {
  std::int32_t bearings_used = 0;
  std::int32_t bearings_refused = 0;
  std::int32_t batches_failed = 0;
  std::int32_t inflations = 0;  ///< number of covariance inflations after consecutive refusals
  std::int32_t restarts = 0;    ///< of the filter, after initialisation
};

/// Inputs at the time of an image.
struct AnglesOnlyEpoch {
  GpsTime time;
  std::optional<orbit::CartesianState> servicer_gnss;  ///< accurate to a metre or two, at the time
  Vector3 sun_eci = Vector3::Zero();                   ///< unit vector
  std::optional<BearingMeasurement> bearing;
};

/// Edit status of the bearing.
enum class BearingEditStatus : std::uint8_t { kNone, kRefused, kFilter, kBatch };

class AnglesOnlyNavigation {
 public:
  explicit AnglesOnlyNavigation(const AnglesOnlySettings& settings = {}) { configure(settings); }

  /// Replaces the settings and restarts.
  void configure(const AnglesOnlySettings& settings);

  /// Restarts from this orbit. Burns between its time and the first epoch must be left out by the caller.
  void set_apriori(const TargetApriori& apriori);

  /// Propagates to an epoch and processes its inputs. `burns`: the servicer's from the last epoch on, in order of time.
  /// An epoch before the last is ignored.
  BearingEditStatus update(const AnglesOnlyEpoch& epoch, std::span<const Burn> burns);

  /// Whether the batch has converged and the filter runs.
  [[nodiscard]] bool valid() const { return filter_runs_ && orbits_.filter.started(); }
  /// Whether a pointing direction is available, at least from the a-priori orbit.
  [[nodiscard]] bool has_target() const { return orbits_.filter.started() && orbits_.own_orbit.started(); }
  [[nodiscard]] GpsTime epoch() const { return orbits_.epoch; }
  [[nodiscard]] GpsTime last_bearing() const { return last_bearing_; }  ///< processed
  [[nodiscard]] orbit::CartesianState servicer() const { return orbits_.own_orbit.state(); }
  /// kNotReady unless has_target().
  [[nodiscard]] Result<orbit::CartesianState> target() const {
    return orbits_.filter.target(orbits_.own_orbit.state());
  }

  /// Osculating a * ROE, m, and its covariance, m^2; a: the servicer's.
  [[nodiscard]] Vector6 a_roe_m() const;
  [[nodiscard]] Matrix6 a_roe_covariance_m2() const;
  /// Covariance of the target's state in the servicer's RTN (velocity as seen in the rotating frame), m and m/s.
  [[nodiscard]] Matrix6 covariance_rtn() const;

  /// The bearing expected at `time`, not before the epoch and within two hours of it.
  [[nodiscard]] Result<BearingPrediction> predict(GpsTime time, const Vector3& origin_eci, const Vector3& sun_eci,
                                                  std::span<const Burn> burns) const;

  [[nodiscard]] const BearingUpdate& last_update() const { return last_update_; }
  [[nodiscard]] const RoeFilter& filter() const { return orbits_.filter; }
  [[nodiscard]] const AnglesOnlyCounters& counters() const { return counters_; }

 private:
  /// Both orbits at one instant. A prediction propagates a copy.
  struct OrbitPair {
    GpsTime epoch;
    OwnOrbit own_orbit;
    RoeFilter filter;
  };

  void begin(const AnglesOnlyEpoch& epoch);
  void reset_to_apriori(const AnglesOnlyEpoch& epoch);
  /// `batch`: also receives the burns, or null.
  void advance(OrbitPair& orbits, GpsTime time, const Vector3& sun_eci, std::span<const Burn> burns,
               BearingBatch* batch) const;
  BearingEditStatus take_bearing(const AnglesOnlyEpoch& epoch, const BearingMeasurement& bearing);
  void solve_batch(const Vector3& sun_eci);
  void count_refusal();

  AnglesOnlySettings settings_;
  std::optional<TargetApriori> apriori_;
  orbit::CartesianState apriori_target_;  ///< at apriori_reached_, propagated
  GpsTime apriori_reached_;
  bool is_apriori_only_ = false;  ///< no bearing has been processed since the a-priori orbit
  OrbitPair orbits_;
  BearingBatch batch_;
  bool filter_runs_ = false;
  GpsTime last_bearing_;
  int refused_in_a_row_ = 0;
  std::size_t inflations_in_a_row_ = 0;
  BearingUpdate last_update_;
  AnglesOnlyCounters counters_;
};

}  // namespace vbar::fsw::navigation
