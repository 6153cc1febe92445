#pragma once
// Earth orientation parameters: how the real Earth deviates from the models of rotation and precession-nutation.
// Daily values (IERS C04, finals2000A), interpolated by Lagrange polynomials through four days (as IERS recommends);
// UT1-TAI is interpolated, since UT1-UTC jumps at leap seconds. The daily and half-daily ocean tides (below 1 mas, 0.1
// ms) are neglected.

#include <filesystem>
#include <optional>
#include <vector>

#include "fsw/core/gps_time.h"

namespace vbar::truth {

/// Earth orientation of one instant.
struct EarthOrientation {
  double ut1_minus_tai_s = 0.0;
  double pole_x = 0.0;  ///< polar motion, rad
  double pole_y = 0.0;
  double cip_dx = 0.0;  ///< offsets of the celestial intermediate pole from IAU 2006/2000A, rad
  double cip_dy = 0.0;
};

/// A series of Earth orientation. Immutable once made, so it may be shared between threads.
class EarthOrientationSeries {
 public:
  /// One day's row, at 0h UTC.
  struct Day {
    int mjd_utc = 0;
    EarthOrientation orientation;
    bool is_predicted = false;  ///< by the publication, not observed
  };

  /// Reads a file in any of orientation_formats.h, days without gaps.
  /// Throws std::runtime_error naming file, line and what is accepted.
  static EarthOrientationSeries load(const std::filesystem::path& file);

  /// Makes a series of `days`: in order, without gaps, at least four of them. Throws std::invalid_argument for other
  /// days.
  explicit EarthOrientationSeries(std::vector<Day> days);

  /// Makes a series with UT1 = UTC as at `time`, a pole at the origin: what is known without data, for all of GPS time.
  /// A leap second after `time` changes nothing.
  static EarthOrientationSeries unknown(fsw::GpsTime time);

  /// Returns the first instant whose value depends on a prediction; none if all days are observed.
  [[nodiscard]] std::optional<fsw::GpsTime> predicted_from() const { return predicted_from_; }

  /// Returns the orientation `seconds` after `epoch`. Throws std::out_of_range outside the series, naming the date and
  /// the range.
  EarthOrientation at(fsw::GpsTime epoch, double seconds = 0.0) const;

 private:
  struct Node {
    double tai_s;  ///< s after 0h UTC of the first day
    EarthOrientation orientation;
  };

  EarthOrientationSeries() = default;

  fsw::GpsTime first_;
  std::vector<Node> nodes_;
  std::optional<fsw::GpsTime> predicted_from_;
  bool is_constant_ = false;  ///< at the first node
};

}  // namespace vbar::truth
