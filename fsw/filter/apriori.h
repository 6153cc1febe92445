#pragma once
// The orbit of the target before any measurement, from the ground.

#include <cstdint>

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "fsw/filter/absolute_orbit.h"
#include "fsw/orbit/earth_rotation.h"
#include "fsw/orbit/elements.h"

namespace vbar::fsw::filter {

/// Either an absolute orbit, of two-line-element quality, or the mean ROE of preceding navigation.
struct TargetApriori {
  enum class Kind : std::uint8_t { kAbsoluteOrbit, kMeanRoe };
  Kind kind = Kind::kAbsoluteOrbit;
  GpsTime time;
  orbit::CartesianState target;                    ///< kAbsoluteOrbit
  Vector6 mean_a_roe_m = Vector6::Zero();          ///< kMeanRoe
  Vector6 sigma_a_roe_m = Vector6::Constant(1.0);  ///< 1 sigma of a * ROE with respect to the servicer
};

/// Osculating ROE (dimensionless) with covariance.
struct AprioriRoe {
  Vector6 roe = Vector6::Zero();
  Matrix6 covariance = Matrix6::Zero();
};

/// An a-priori orbit that is propagated with time.
class Apriori {
 public:
  Apriori() = default;
  explicit Apriori(const TargetApriori& known) : known_(known), target_(known.target), reached_(known.time) {}

  [[nodiscard]] const TargetApriori& known() const { return known_; }

  /// Returns the elements with respect to the servicer at `time`. kNotReady before the time of the a-priori orbit, or
  /// (for ROE, which are not propagated beyond a linear drift) more than ten minutes after it; kOutOfRange for an
  /// invalid orbit. The covariance of an absolute orbit includes that of the servicer's orbit: 0.1 m/s of the latter
  /// cause 200 m of a * da.
  Result<AprioriRoe> at(GpsTime time, const AbsoluteOrbitFilter& absolute_orbit, const orbit::EarthOrientation& earth);

 private:
  Result<AprioriRoe> of_absolute_orbit(GpsTime time, const AbsoluteOrbitFilter& absolute_orbit,
                                       const orbit::EarthOrientation& earth);
  [[nodiscard]] Result<AprioriRoe> of_mean_roe(GpsTime time, const AbsoluteOrbitFilter& absolute_orbit) const;

  TargetApriori known_;
  orbit::CartesianState target_;  ///< at reached_
  GpsTime reached_;
};

}  // namespace vbar::fsw::filter
