#pragma once
// Position and clock of one receiver from one epoch of pseudoranges: iterated least squares without a-priori values.

#include <cstddef>

#include "fsw/core/result.h"
#include "fsw/core/types.h"
#include "fsw/gnss/differential.h"
#include "fsw/gnss/observation.h"

namespace vbar::fsw::gnss {

/// Errors of ranges beside the noise that the receiver states, 1 sigma.
struct RangeErrors {
  double broadcast_sigma_m = 1.5;   ///< orbits and clocks as broadcast
  double ionosphere_sigma_m = 4.0;  ///< above the receiver, with one frequency
};

struct SinglePoint {
  Vector3 position_eci = Vector3::Zero();  ///< of the antenna at reception
  double clock_m = 0.0;                    ///< c times the receiver clock's advance over GPS time
  double sigma_m = 0.0;                    ///< 1 sigma of a position component, from the geometry and the residuals
  /// Covariance of the position, m^2, ECI: the inverse normal matrix of position, clock and offsets of the
  /// constellations.
  Matrix3 covariance_m2 = Matrix3::Zero();
  std::size_t used = 0;  ///< satellites
};

/// From at least five satellites (one more than the unknowns of a single constellation, for redundancy; each
/// further constellation adds an unknown). GPS on two frequencies ionosphere-free, all others
/// uncorrected, with a corresponding weight. Satellites whose residuals do not fit are removed, the worst first, up to
/// a quarter of them.
/// kNotReady: too few satellites with an ephemeris; kSingular: geometry; kDidNotConverge: residuals that do not fit, or
/// a position outside low orbits.
Result<SinglePoint> single_point(const gnss::ObservationEpoch& epoch, const EphemerisStore& ephemerides,
                                 const EarthFrame& frame, const RangeErrors& errors = {});

}  // namespace vbar::fsw::gnss
