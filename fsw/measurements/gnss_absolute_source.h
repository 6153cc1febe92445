#pragma once
// Source: single-point positions of the servicer's own receiver, for its own orbit.

#include <cstdint>
#include <optional>

#include "fsw/filter/relative_navigation_filter.h"
#include "fsw/gnss/observation.h"
#include "fsw/gnss/single_point.h"
#include "fsw/measurements/aid.h"
#include "fsw/measurements/source.h"

namespace vbar::fsw::measurements {

// Single-point positions of the servicer's own receiver as an aid of the filter: they determine its absolute orbit.

struct OwnGnssCounters {
  std::int32_t used = 0;
  std::int32_t no_solution = 0;  ///< epochs without a single-point solution
  std::int32_t rejected = 0;     ///< positions that contradict the absolute orbit
};

class GnssAbsoluteAiding {
 public:
  /// Nominal phase centre from the centre of mass, m, body axes.
  void set_antenna(const Vector3& antenna_body_m) { antenna_body_m_ = antenna_body_m; }

  /// Errors of ranges; by default those of broadcast ephemerides.
  void set_range_errors(const gnss::RangeErrors& errors) { range_errors_ = errors; }

  /// Processes an epoch at whose tag the filter stands, and returns its single-point solution (status: that of
  /// single_point(), or kNotReady for another time). The position is referred to the centre of mass; without an
  /// attitude its covariance includes the lever arm.
  Result<gnss::SinglePoint> process(const gnss::ObservationEpoch& epoch, const std::optional<Matrix3>& R_eci_body,
                                    const gnss::EphemerisStore& ephemerides, const gnss::EarthFrame& frame,
                                    filter::RelativeNavigationFilter& filter);

  /// Suspends, at each step, after kSilence without an accepted position.
  void watch(GpsTime now);

  [[nodiscard]] const OwnGnssCounters& counters() const { return counters_; }
  [[nodiscard]] Aid& aid() { return aid_; }
  [[nodiscard]] const Aid& aid() const { return aid_; }

  static constexpr Duration kSilence = duration_of_seconds(60);

 private:
  Aid aid_;
  Vector3 antenna_body_m_ = Vector3::Zero();
  gnss::RangeErrors range_errors_;
  GpsTime last_accepted_;
  OwnGnssCounters counters_;
};

/// An antenna on the spacecraft.
[[nodiscard]] bool is_valid(const receiver_configuration& configuration);

class GnssAbsoluteSource {
 public:
  static constexpr std::int32_t kUse = navigation_configuration::kUseOwnGnss;
  bool configure(const Configuration& configuration);
  void collect(Context& context, RecordFiler records);
  void process_record(const Record& record, Context& context, filter::RelativeNavigationFilter& filter);
  [[nodiscard]] std::optional<GpsTime> pending_since(GpsTime /*now*/) const { return std::nullopt; }
  void watch(GpsTime now, filter::RelativeNavigationFilter& /*filter*/) { aiding_.watch(now); }
  void stop(GpsTime now, filter::RelativeNavigationFilter& /*filter*/) { aid().go_to(AidState::kOff, now); }
  void report(const Telemetry& /*telemetry*/) const {}
  [[nodiscard]] Aid& aid() { return aiding_.aid(); }
  [[nodiscard]] const Aid& aid() const { return aiding_.aid(); }
  /// Its positions do not measure the relative orbit.
  [[nodiscard]] static GpsTime last_measurement() { return {}; }
  [[nodiscard]] const OwnGnssCounters& counters() const { return aiding_.counters(); }

 private:
  GnssAbsoluteAiding aiding_;
  GpsTime filed_until_{-1};
};

}  // namespace vbar::fsw::measurements
