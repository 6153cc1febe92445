#pragma once
// Attraction of the Sun or the Moon, in the frame that falls with the Earth.

#include "host_sim/truth/forces/force.h"

namespace vbar::truth {

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

}  // namespace vbar::truth
