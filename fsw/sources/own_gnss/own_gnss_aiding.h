#pragma once
// Single-point positions of the servicer's own receiver as an aid of the filter: they determine its absolute orbit.

#include <cstdint>
#include <optional>

#include "fsw/gnss/observation.h"
#include "fsw/navigation/single_point.h"
#include "fsw/sources/aid.h"
#include "fsw/trunk/trunk.h"

namespace vbar::fsw::sources {

struct OwnGnssCounters {
  std::int32_t used = 0;
  std::int32_t no_solution = 0;  ///< epochs without a single-point solution
  std::int32_t rejected = 0;     ///< positions that contradict the absolute orbit
};

class OwnGnssAiding {
 public:
  /// Nominal phase centre from the centre of mass, m, body axes.
  void set_antenna(const Vector3& antenna_body_m) { antenna_body_m_ = antenna_body_m; }

  /// Processes an epoch at whose tag the filter stands, and returns its single-point solution (status: that of
  /// single_point(), or kNotReady for another time). The position is referred to the centre of mass; without an
  /// attitude its covariance includes the lever arm.
  Result<navigation::SinglePoint> process(const gnss::ObservationEpoch& epoch, const std::optional<Matrix3>& R_eci_body,
                                          const navigation::EphemerisStore& ephemerides,
                                          const navigation::EarthFrame& frame,
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
  GpsTime last_accepted_;
  OwnGnssCounters counters_;
};

}  // namespace vbar::fsw::sources
