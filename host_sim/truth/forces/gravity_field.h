#pragma once
// Acceleration of a spherical-harmonic gravity field, fast and without singularity at the poles.
//
// Each Cartesian component of the gradient of a harmonic function is harmonic itself (Cunningham 1970), so the field is
// converted, once, into three ordinary harmonic series of one degree more, one for each component. An
// evaluation is then a three-term recursion shared by the three and six multiply-adds a term. The Legendre functions
// are divided by cos^m(latitude) (Pines 1973) and by their leading coefficient, so that the recursion p_k = z p_(k-1) -
// c_k p_(k-2) has one coefficient and no square root; the factors removed are in the series' coefficients. Four orders
// m run side by side.

#include "fsw/core/types.h"
#include "host_sim/truth/forces/gravity_coefficients.h"
#include "host_sim/truth/forces/harmonic_sum.h"

namespace vbar::truth {

/// Field of a gravity model. Immutable once made; may be shared between threads.
class GravityField {
 public:
  /// Makes the field up to `degree` and `order` (0 <= order <= degree <= that of the coefficients). Throws
  /// std::invalid_argument for other degrees. `sum` chooses the build of the inner loop; all give the same bits.
  GravityField(const GravityCoefficients& coefficients, int degree, int order,
               HarmonicSummation sum = fastest_harmonic_summation());

  double gm() const { return gm_; }          ///< m^3/s^2
  double radius() const { return radius_; }  ///< reference radius, m
  int degree() const { return degree_; }
  int order() const { return order_; }

  /// Returns the acceleration without that of the point mass, m/s^2, in ITRF, at a position (m, not the centre) in
  /// ITRF.
  fsw::Vector3 perturbation_itrf(const fsw::Vector3& position_itrf) const;

  /// Returns the whole gravitational acceleration, m/s^2, in ITRF.
  fsw::Vector3 acceleration_itrf(const fsw::Vector3& position_itrf) const;

 private:
  double gm_ = 0.0;
  double radius_ = 0.0;
  int degree_ = 0;
  int order_ = 0;
  HarmonicSeries series_;
  HarmonicSummation sum_;
};

}  // namespace vbar::truth
