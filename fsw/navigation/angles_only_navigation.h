#pragma once
// Navigation with a camera and the servicer's own GNSS receiver: keeps the servicer's orbit smooth, finds the target's
// first relative orbit from a batch of bearings about what was known beforehand, and follows it with a filter.
//
// Everything comes in order of time. A burn at an instant counts as after it.

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

/// Where the target was last known to be; 1 sigma of a * ROE with respect to the servicer, m.
struct TargetApriori {
  GpsTime time;
  orbit::CartesianState target;
  Vector6 sigma_a_roe_m = Vector6::Zero();
};

struct AnglesOnlyCounters {
  std::int32_t bearings_used = 0;
  std::int32_t bearings_refused = 0;
  std::int32_t batches_failed = 0;
  std::int32_t doubts = 0;    ///< times that refusals in a row widened the covariance
  std::int32_t restarts = 0;  ///< of the filter, after it had begun
};

/// What is known at an image's time.
struct AnglesOnlyEpoch {
  GpsTime time;
  std::optional<orbit::CartesianState> servicer_gnss;  ///< a metre or two, of the time
  Vector3 sun_eci = Vector3::Zero();                   ///< unit vector
  std::optional<BearingMeasurement> bearing;
};

/// What became of its bearing.
enum class BearingFate : std::uint8_t { kNone, kRefused, kFilter, kBatch };

class AnglesOnlyNavigation {
 public:
  explicit AnglesOnlyNavigation(const AnglesOnlySettings& settings = {}) { configure(settings); }

  /// Replaces the settings and starts anew.
  void configure(const AnglesOnlySettings& settings);

  /// Starts anew from here. Burns between its time and the first epoch are the caller's to leave out.
  void set_apriori(const TargetApriori& apriori);

  /// Moves to an epoch and folds in what it brings. `burns`: the servicer's from the last epoch on, in order of time.
  /// An epoch before the last is ignored.
  BearingFate update(const AnglesOnlyEpoch& epoch, std::span<const Burn> burns);

  /// Whether the batch has converged and the filter runs.
  [[nodiscard]] bool valid() const { return filter_runs_ && flight_.filter.started(); }
  /// Whether there is anything to point at: at least what was known beforehand.
  [[nodiscard]] bool has_target() const { return flight_.filter.started() && flight_.own_orbit.started(); }
  [[nodiscard]] GpsTime epoch() const { return flight_.epoch; }
  [[nodiscard]] GpsTime last_bearing() const { return last_bearing_; }  ///< folded in
  [[nodiscard]] orbit::CartesianState servicer() const { return flight_.own_orbit.state(); }
  /// kNotReady unless has_target().
  [[nodiscard]] Result<orbit::CartesianState> target() const {
    return flight_.filter.target(flight_.own_orbit.state());
  }

  /// Osculating a * ROE, m, and its covariance, m^2; a: the servicer's.
  [[nodiscard]] Vector6 a_roe_m() const;
  [[nodiscard]] Matrix6 a_roe_covariance_m2() const;
  /// Covariance of the target's state in the servicer's RTN (velocity as seen in the turning frame), m and m/s.
  [[nodiscard]] Matrix6 covariance_rtn() const;

  /// The bearing expected at `time`, not before the epoch and within two hours of it.
  [[nodiscard]] Result<BearingPrediction> predict(GpsTime time, const Vector3& origin_eci, const Vector3& sun_eci,
                                                  std::span<const Burn> burns) const;

  [[nodiscard]] const BearingUpdate& last_update() const { return last_update_; }
  [[nodiscard]] const RoeFilter& filter() const { return flight_.filter; }
  [[nodiscard]] const AnglesOnlyCounters& counters() const { return counters_; }

 private:
  /// Both orbits at one instant. To look ahead is to move a copy.
  struct Flight {
    GpsTime epoch;
    OwnOrbit own_orbit;
    RoeFilter filter;
  };

  void begin(const AnglesOnlyEpoch& epoch);
  void rest_on_apriori(const AnglesOnlyEpoch& epoch);
  /// `batch`: who else is told of the burns, or null.
  void advance(Flight& flight, GpsTime time, const Vector3& sun_eci, std::span<const Burn> burns,
               BearingBatch* batch) const;
  BearingFate take_bearing(const AnglesOnlyEpoch& epoch, const BearingMeasurement& bearing);
  void solve_batch(const Vector3& sun_eci);
  void count_refusal();

  AnglesOnlySettings settings_;
  std::optional<TargetApriori> apriori_;
  orbit::CartesianState apriori_target_;  ///< at apriori_reached_, coasted
  GpsTime apriori_reached_;
  bool rests_on_apriori_ = false;  ///< no bearing has changed what was known beforehand
  Flight flight_;
  BearingBatch batch_;
  bool filter_runs_ = false;
  GpsTime last_bearing_;
  int refused_in_a_row_ = 0;
  std::size_t doubts_in_a_row_ = 0;
  BearingUpdate last_update_;
  AnglesOnlyCounters counters_;
};

}  // namespace vbar::fsw::navigation
