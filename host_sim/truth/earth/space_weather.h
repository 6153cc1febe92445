#pragma once
// The drivers of the upper atmosphere: solar radio flux and geomagnetic indices at one instant.

#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "fsw/core/gps_time.h"

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

// The Sun's radio flux and the geomagnetic indices as observed, day by day, and the indices that an atmosphere
// model needs at an instant. They are piecewise constant: the force that uses them states where they jump (force.h).

/// A series of days, or constant indices. Immutable once made, so it may be shared between threads.
class SpaceWeather {
 public:
  enum class Kind {
    kObserved,
    kPredictedDaily,
    kPredictedMonthly,  ///< fluxes between predictions of months, geomagnetic index assumed
    kMissing,           ///< the row lacks a value
  };

  /// Geomagnetic index where none is known: moderately disturbed.
  static constexpr double kAssumedAp = 15.0;

  /// One UTC day's row.
  struct Day {
    int mjd_utc = 0;
    Kind kind = Kind::kObserved;
    int line = 0;                ///< line in the file
    std::array<double, 8> ap{};  ///< three-hourly, from 00-03 to 21-24 UTC
    double ap_daily = 0.0;
    double f107 = 0.0;          ///< observed, 1e-22 W/m^2/Hz
    double f107_average = 0.0;  ///< over 81 days centred on the day
  };

  /// Reads a file in any of weather_formats.h, days without gaps.
  /// Throws std::runtime_error naming file, line and what is accepted.
  static SpaceWeather load(const std::filesystem::path& file);

  /// Makes a series of `days`: in order, without gaps, at least four of them. Throws std::invalid_argument for other
  /// days.
  explicit SpaceWeather(std::vector<Day> days);

  /// Makes a series with constant indices.
  static SpaceWeather constant(double f107, double ap);

  /// Returns the first day of a kind among the days whose values a flight between two instants uses; null if there is
  /// none.
  [[nodiscard]] const Day* find_first(Kind kind, fsw::GpsTime begin, fsw::GpsTime end) const;

  /// Returns the indices that hold at `time`. F10.7 is the day before's. Throws std::out_of_range, naming date and
  /// range, where the series lacks the day itself, the day before or, three-hourly, the 57 hours before.
  SolarIndices indices_at(fsw::GpsTime time, GeomagneticIndex geomagnetic_index) const;

  /// Returns the first instant after `time` at which indices change: 0h UTC, and three-hourly 3h, 6h, ... UTC too.
  static fsw::GpsTime next_change_after(fsw::GpsTime time, GeomagneticIndex geomagnetic_index);

 private:
  double ap_before(int slot, int three_hours) const { return ap_[static_cast<std::size_t>(slot - three_hours)]; }
  double mean_of_eight_before(int slot, int latest) const;
  SpaceWeather() = default;
  [[noreturn]] void refuse(fsw::GpsTime time, GeomagneticIndex geomagnetic_index) const;

  std::vector<Day> days_;
  std::vector<double> ap_;  // three-hourly, of all days
  std::optional<SolarIndices> constant_;
};

}  // namespace vbar::truth
