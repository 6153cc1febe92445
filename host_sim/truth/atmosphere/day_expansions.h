#pragma once
// The geomagnetic activity that a quantity of NRLMSISE-00 responds to: ap above its quiet value of 4, with the
// saturation of the model, from the daily mean or from an exponentially weighted mean of the last 57 hours.

#include <array>
#include <memory>
#include <utility>

#include "host_sim/truth/atmosphere/horizontal_expansion.h"
#include "host_sim/truth/atmosphere/nrlmsise00_tables.h"
#include "host_sim/truth/earth/space_weather.h"

namespace vbar::truth {

class EffectiveAp {
 public:
  EffectiveAp() = default;

  /// Evaluates the coupling to ap; `p` are the coefficients of the quantity.
  EffectiveAp(const Nrlmsise00Tables::Upper& p, const SolarIndices& indices);

  /// Returns the effective ap at a latitude: the decay depends on the distance of the latitude from 45 deg.
  double at(double latitude_deg) const;

 private:
  bool remembers_ = false;
  double daily_ = 0.0;
  std::array<double, 6> history_{};  // saturated
  double fading_ = 0.0;              // over three hours: exp(-fading_) at 45 deg
  double latitude_slope_ = 0.0;
};

// All series of NRLMSISE-00 for one day and one level of solar activity, to be summed at a place and time of day.

/// Relative variations (dimensionless, about 0) of the thermosphere's quantities: temperatures and gradient as factors
/// 1 + v, densities at 120 km as factors exp(v).
struct UpperVariations {
  double exospheric_temperature, gradient, boundary_temperature;
  double he, o, n2, o2, ar, h, n, anomalous_o;
};

/// Variations v, as factors 1/(1 - v) of temperature and 1 + v of gradient.
struct LowerThermosphereVariations {
  std::array<double, 4> temperature;  ///< at 110, 100, 90, 72.5 km
  double bottom_gradient;             ///< at 72.5 km
};

/// Variations below 72.5 km, in the order of the published array pma without its ninth row (the bottom gradient above).
struct LowerAtmosphereVariations {
  std::array<double, 3> stratosphere;  ///< at 55, 45, 32.5 km
  std::array<double, 4> troposphere;   ///< at 20, 15, 10, 0 km
  double surface_gradient;             ///< at 0 km
  double joint_gradient;               ///< at 32.5 km
};

/// Series of one day. Computing them costs some 50 evaluations, so it is done only when day or indices change.
class DayExpansions {
 public:
  explicit DayExpansions(std::shared_ptr<const Nrlmsise00Tables> tables) : tables_(std::move(tables)) {}

  void set_day(int day_of_year, const SolarIndices& indices);

  /// Returns the annual wave that displaces the turbopause, with opposite signs in the two hemispheres: -1 to 1.
  double turbopause_season() const { return turbopause_season_; }

  UpperVariations upper(const HorizontalSeries& functions, double latitude_deg) const;
  LowerThermosphereVariations lower_thermosphere(const HorizontalSeries& functions, double latitude_deg) const;
  LowerAtmosphereVariations lower_atmosphere(const HorizontalSeries& functions);

 private:
  static constexpr int kUpperCount = 11;
  static constexpr int kLowerThermosphereCount = 5;
  static constexpr int kLowerAtmosphereCount = 9;

  void work_out();

  std::shared_ptr<const Nrlmsise00Tables> tables_;
  int day_of_year_ = 0;  // none yet
  SolarIndices indices_;
  double turbopause_season_ = 0.0;
  bool remembers_ = false;  // effective ap depends on latitude: the magnetic series are kept apart
  std::array<EffectiveAp, kUpperCount> effective_ap_;
  SeriesTable<kUpperCount, kHorizontalSize> upper_;
  SeriesTable<kUpperCount, kHorizontalSize> upper_magnetic_;
  SeriesTable<kLowerThermosphereCount, kLowerSize> lower_thermosphere_;
  SeriesTable<kLowerThermosphereCount, kLowerSize> lower_thermosphere_magnetic_;
  SeriesTable<kLowerAtmosphereCount, kLowerSize> lower_atmosphere_;
  bool lower_atmosphere_ready_ = false;
};

}  // namespace vbar::truth
