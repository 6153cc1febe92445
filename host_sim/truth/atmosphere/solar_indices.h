#pragma once
// The drivers of the upper atmosphere: solar radio flux and geomagnetic indices at one instant.

#include <array>

namespace vbar::truth {

/// Ap that the atmosphere model receives: the day's mean, or the last 57 hours in steps of three.
enum class GeomagneticIndex { kDaily, kThreeHourly };

struct SolarIndices {
  double f107 = 0.0;          ///< 10.7 cm flux of the day before, observed, 1e-22 W/m^2/Hz
  double f107_average = 0.0;  ///< its mean over 81 days centred on the day
  GeomagneticIndex geomagnetic_index = GeomagneticIndex::kDaily;
  double ap_daily = 0.0;  ///< daily mean ap; the only index that kDaily uses
  /// Used by kThreeHourly: ap of the current three hours and of 3, 6, 9 hours before; the mean of the eight from 12
  /// to 33 hours before; that of the eight from 36 to 57 hours before.
  std::array<double, 6> ap_history{};

  bool operator==(const SolarIndices&) const = default;
};

}  // namespace vbar::truth
