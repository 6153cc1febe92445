#pragma once
// Navigation of two cooperative spacecraft by their GNSS receivers: pairs the epochs of both by their tags, in order;
// estimates the servicer's orbit, the relative orbit, and the integers of the carrier phases.

#include <cstdint>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/gnss/ephemeris.h"
#include "fsw/navigation/ambiguity_resolution.h"
#include "fsw/navigation/attitude_history.h"
#include "fsw/navigation/burn.h"
#include "fsw/navigation/differential.h"
#include "fsw/navigation/ephemeris_store.h"
#include "fsw/navigation/epoch_buffer.h"
#include "fsw/navigation/orbit_filter.h"
#include "fsw/navigation/relative_filter.h"
#include "fsw/orbit/earth_rotation.h"

namespace vbar::fsw::navigation {

enum class Receiver : std::uint8_t { kServicer = 0, kTarget = 1 };

struct GnssNavigationSettings {
  RelativeFilterSettings relative;
  AmbiguitySettings ambiguities;
  orbit::EarthOrientation earth;
  Vector3 servicer_antenna_body_m = Vector3::Zero();
  Vector3 target_antenna_body_m = Vector3::Zero();
  Duration pair_wait = duration_of_seconds(12);  ///< how long an epoch waits for its counterpart
};

struct GnssNavigationCounters {
  std::int32_t pairs = 0;        ///< epochs of both receivers processed
  std::int32_t alone = 0;        ///< of the servicer only: the counterpart did not arrive in time
  std::int32_t too_late = 0;     ///< arrived after their time had been processed, or twice
  std::int32_t no_solution = 0;  ///< pairs without a single-point solution on either side, or without attitude
  std::int32_t codes_refused = 0;
  std::int32_t phases_refused = 0;
  std::int32_t slips = 0;
  std::int32_t restarts = 0;  ///< of the relative filter, after initialisation
};

class GnssNavigation {
 public:
  explicit GnssNavigation(const GnssNavigationSettings& settings = {});

  /// Replaces the settings and restarts; ephemerides stay.
  void configure(const GnssNavigationSettings& settings);

  void take(Receiver receiver, const gnss::ObservationEpoch& epoch);
  void take(const gnss::Ephemeris& ephemeris);
  void take(Receiver receiver, const AttitudeSample& attitude);

  /// Processes the epochs available until `now`. `burns`: the servicer's from the epoch on, in order of time.
  void update(GpsTime now, std::span<const Burn> burns);

  /// Whether there is a relative orbit, and its epoch.
  [[nodiscard]] bool valid() const { return orbit_.started() && relative_.started(); }
  [[nodiscard]] GpsTime epoch() const { return epoch_; }
  /// Latest common epoch of both receivers: since then the relative orbit is propagated only. At most epoch().
  [[nodiscard]] GpsTime last_pair() const { return last_pair_; }
  /// The servicer's own orbit is available before the relative one, or without it.
  [[nodiscard]] bool has_servicer() const { return orbit_.started(); }
  [[nodiscard]] orbit::CartesianState servicer() const { return orbit_.state(); }
  [[nodiscard]] orbit::CartesianState target() const;
  /// Covariance of the relative state in the servicer's RTN (velocity as seen in the rotating frame), m and m/s.
  [[nodiscard]] Matrix6 covariance_rtn() const;

  /// By the sensors of the spacecraft; no value without a sample near `time` (attitude_history.h).
  [[nodiscard]] std::optional<Matrix3> R_eci_body_at(Receiver receiver, GpsTime time) const {
    return attitudes_[static_cast<std::size_t>(receiver)].R_eci_body_at(time);
  }
  [[nodiscard]] const RelativeFilter& relative() const { return relative_; }
  [[nodiscard]] const AmbiguityResolution& ambiguities() const { return ambiguities_; }
  [[nodiscard]] const GnssNavigationCounters& counters() const { return counters_; }
  [[nodiscard]] const RelativeUpdate& last_update() const { return last_update_; }

 private:
  void advance_to(GpsTime time, std::span<const Burn> burns);
  void take_epoch(const gnss::ObservationEpoch& epoch, const gnss::ObservationEpoch* other,
                  std::span<const Burn> burns);
  void take_pair(const gnss::ObservationEpoch& ours, const gnss::ObservationEpoch& theirs, double servicer_clock_m,
                 const EarthFrame& frame);

  GnssNavigationSettings settings_;
  EphemerisStore ephemerides_;
  std::array<EpochBuffer, 2> waiting_{};
  std::array<AttitudeHistory, 2> attitudes_{};
  OrbitFilter orbit_;
  RelativeFilter relative_;
  AmbiguityResolution ambiguities_;
  DifferentialEpoch differences_;
  bool has_epoch_ = false;
  GpsTime epoch_;  ///< of the last servicer epoch processed
  GpsTime last_pair_;
  bool relative_has_begun_ = false;
  int contradicted_in_a_row_ = 0;  ///< epochs whose codes were mostly refused
  GnssNavigationCounters counters_;
  RelativeUpdate last_update_;
};

}  // namespace vbar::fsw::navigation
