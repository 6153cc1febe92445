#pragma once
// The relative orbit as it was estimated before bearings that contradict it led to another one. The object of those
// bearings may be another satellite: then the earlier orbit is the better one, and a target that appears where it
// predicts shows this. It is propagated without measurements, with the burns of the servicer:
//
//   x(t + dt): both orbits in the filter's gravity,   P <- Phi P Phi' + Q + Gamma Sigma Gamma',
//
// Phi: transition of mean ROE under J2 (orbit/roe.h), Q: noise of the accelerations that the filter leaves unmodelled,
// Sigma: errors of the burns. The pair of orbits is the one of the instant at which it was kept, so that later
// corrections of the servicer's orbit do not enter the relative orbit.

#include <optional>

#include "fsw/filter/relative_navigation_filter.h"

namespace vbar::fsw::measurements {

class KeptOrbit {
 public:
  /// Keeps the orbit of the filter as it is. An orbit that is kept already stays: it is the better known one.
  void keep(const filter::RelativeNavigationFilter& filter);
  void forget() { pair_.reset(); }
  [[nodiscard]] bool is_kept() const { return pair_.has_value(); }

  /// Propagates to the epoch of the filter. An orbit that was kept for kLongest, or has become invalid, is forgotten.
  void advance(const filter::RelativeNavigationFilter& filter);

  /// ROE (dimensionless) at the epoch, and their covariance.
  [[nodiscard]] Vector6 roe() const;
  [[nodiscard]] const Matrix6& covariance() const { return covariance_; }
  /// The target's state with these ROE about `servicer`. kNotReady without an orbit.
  [[nodiscard]] Result<orbit::CartesianState> target(const orbit::CartesianState& servicer) const;

  static constexpr Duration kLongest = duration_of_seconds(43200);

 private:
  struct Pair {
    orbit::CartesianState servicer, target;
  };
  bool coast_to(GpsTime time, const filter::RelativeNavigationFilter& filter);
  bool apply(const filter::Impulse& impulse, const filter::FilterSettings& settings);

  std::optional<Pair> pair_;
  GpsTime since_;  ///< when it was kept
  GpsTime epoch_;
  Matrix6 covariance_ = Matrix6::Zero();
  filter::DifferentialAcceleration differential_;
  double differential_variance_ = 0.0;  ///< m^2/s^4
};

}  // namespace vbar::fsw::measurements
