#pragma once
// The gravity model of NRLMSISE-00: surface value and effective radius for the decrease with altitude, by latitude
// (Lambert's formula, as in the U.S. Standard Atmosphere 1976).

namespace vbar::truth {

struct LatitudeGravity {
  double surface = 0.0;    ///< cm/s^2
  double radius_km = 0.0;  ///< effective radius of the Earth

  explicit LatitudeGravity(double sin_latitude) {
    const double c = 1.0 - 2.0 * sin_latitude * sin_latitude;  // cosine of twice the latitude
    surface = 980.616 * (1.0 - 0.0026373 * c);
    radius_km = 2.0 * surface / (3.085462e-6 + 2.27e-9 * c) * 1e-5;
  }

  /// Returns gravity, cm/s^2.
  double at(double altitude_km) const {
    const double ratio = 1.0 + altitude_km / radius_km;
    return surface / (ratio * ratio);
  }

  /// Returns the geopotential altitude above `reference_km`, in km of gravity at the reference.
  double geopotential_km(double altitude_km, double reference_km) const {
    return (altitude_km - reference_km) * (radius_km + reference_km) / (radius_km + altitude_km);
  }
};

/// Gas constant of the model, in g cm^2 s^-2 mol^-1 K^-1 with heights in km.
inline constexpr double kModelGasConstant = 831.4;

}  // namespace vbar::truth
