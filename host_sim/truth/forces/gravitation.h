#pragma once
// Acceleration of a spherical-harmonic gravity field, fast and without singularity at the poles.
//
// Each Cartesian component of the gradient of a harmonic function is harmonic itself (Cunningham 1970), so the field is
// converted, once, into three ordinary harmonic series of one degree more, one for each component. An
// evaluation is then a three-term recursion shared by the three and six multiply-adds a term. The Legendre functions
// are divided by cos^m(latitude) (Pines 1973) and by their leading coefficient, so that the recursion p_k = z p_(k-1) -
// c_k p_(k-2) has one coefficient and no square root; the factors removed are in the series' coefficients. Four orders
// m run side by side.

#include <memory>

#include "fsw/core/types.h"
#include "host_sim/truth/forces/force.h"
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

// The Earth's gravity beyond the point mass, as a force.

class GravityForce final : public Force {
 public:
  /// Makes the force; `field` is shared between spacecraft and must not be null.
  explicit GravityForce(std::shared_ptr<const GravityField> field);

  std::string_view name() const override { return "gravity"; }
  fsw::Vector3 acceleration_eci(const ForceInput& input) override;

 private:
  std::shared_ptr<const GravityField> field_;
};

// Attraction of the Sun or the Moon, in the frame that falls with the Earth.

/// Gravitational parameters of JPL DE421 (Folkner, Williams, Boggs 2009), m^3/s^2; the Sun's is that of the IERS
/// Conventions 2010, table 1.1, as well.
inline constexpr double kSunGm = 1.32712440041e20;
inline constexpr double kMoonGm = 4.902800076e12;

/// Returns the attraction of a distant point mass on a body at `position` less that on the origin, m/s^2; both
/// positions (m) from the same origin and along the same axes. By Battin (1999), section 8.4: no difference of nearly
/// equal vectors is formed, so the result is accurate to rounding however small the position is. Not defined where the
/// two coincide or the third body is at the origin.
fsw::Vector3 third_body_acceleration(const fsw::Vector3& position, const fsw::Vector3& third_body, double gm);

class ThirdBodyForce final : public Force {
 public:
  enum class Body { kSun, kMoon };

  explicit ThirdBodyForce(Body body) : body_(body) {}

  std::string_view name() const override { return body_ == Body::kSun ? "sun" : "moon"; }
  bool needs_sun_and_moon() const override { return true; }
  fsw::Vector3 acceleration_eci(const ForceInput& input) override;

 private:
  Body body_;
};

// General relativity's corrections to a satellite's motion (IERS Conventions 2010, eq. 10.12, with the parameters beta
// = gamma = 1 of Einstein's theory). In a low orbit:
//   Schwarzschild   the Earth's mass curves space and time     2e-8 m/s^2
//   Lense-Thirring  the Earth's rotation drags space along     2e-10 m/s^2
//   de Sitter       the Earth's fall around the Sun turns it   4e-11 m/s^2

class RelativityForce final : public Force {
 public:
  /// Makes the force; `gm` is the Earth's, m^3/s^2.
  explicit RelativityForce(double gm) : gm_(gm) {}

  std::string_view name() const override { return "relativity"; }
  bool needs_sun_and_moon() const override { return true; }
  fsw::Vector3 acceleration_eci(const ForceInput& input) override;

 private:
  double gm_;
};

/// Return the three parts, m/s^2 in ECI, at a position (m) and velocity (m/s) in ECI.
fsw::Vector3 schwarzschild_acceleration(double gm, const fsw::Vector3& position_eci, const fsw::Vector3& velocity_eci);

/// `spin_axis_eci` is the unit vector to the Earth's north pole.
fsw::Vector3 lense_thirring_acceleration(double gm, const fsw::Vector3& spin_axis_eci, const fsw::Vector3& position_eci,
                                         const fsw::Vector3& velocity_eci);

/// `sun_distance` is that from the Earth, m.
fsw::Vector3 de_sitter_acceleration(double sun_distance, const fsw::Vector3& velocity_eci);

}  // namespace vbar::truth
