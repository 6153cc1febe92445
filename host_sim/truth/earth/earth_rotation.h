#pragma once
// Interpolation of a smooth quantity known at equally spaced nodes: the polynomial of degree five through the six nodes
// around an interval.

#include <cstdint>
#include <map>
#include <memory>

#include "fsw/core/types.h"
#include "host_sim/truth/earth/earth_orientation.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::truth {

inline constexpr int kNodePoints = 6;
inline constexpr int kFirstNode = -2;  ///< the interval is [0, 1]; its nodes lie at -2, -1, 0, 1, 2, 3

/// Computes the coefficients, lowest power first, of the polynomial in the fraction of the interval through the values
/// at the nodes.
void fit_node_polynomial(const double (&values)[kNodePoints], double (&coefficients)[kNodePoints]);

/// Returns the value of such a polynomial at `t`.
inline double node_polynomial(const double (&coefficients)[kNodePoints], double t) {
  double sum = coefficients[kNodePoints - 1];
  for (int power = kNodePoints - 2; power >= 0; --power) sum = sum * t + coefficients[power];
  return sum;
}

// GCRF to ITRF by the IAU 2006/2000A conventions (IERS Conventions 2010, chapter 5, CIO-based):
//   R_itrf_gcrf = W(xp, yp, s') R3(ERA) C(X, Y, s).
// The series for X, Y, s (several thousand terms) are computed by ERFA at nodes six hours apart and interpolated; the
// Earth rotation angle is exact at every call. "Exact" is ERFA's own number.

/// Celestial intermediate pole (x, y) and CIO locator s, rad.
struct CelestialPole {
  double x = 0.0;
  double y = 0.0;
  double s = 0.0;
};

/// Computes the full series of the IERS Conventions 2010 (tables 5.2a, b, d), some 0.1 ms a call. ERFA's other way to
/// the pole, through the precession-nutation matrix, agrees with it to a microarcsecond (5e-12 rad), as the Conventions
/// say.
CelestialPole celestial_pole_iau2006a(JulianDate tt);

/// Interpolates celestial_pole_iau2006a(): error below 1e-12 rad in x, y and s (held by its test), some 20 ns a call.
/// Nodes lie at fixed instants, so the result depends on the date only, never on earlier calls. Not thread-safe (nodes
/// are cached): one object per thread.
class CelestialPoleInterpolator {
 public:
  CelestialPole at(JulianDate tt);

 private:
  void enter_interval(std::int64_t interval);
  const CelestialPole& node(std::int64_t index);

  std::map<std::int64_t, CelestialPole> nodes_;
  bool ready_ = false;
  std::int64_t interval_ = 0;
  double x_[kNodePoints] = {};  // polynomials in the fraction of the interval, lowest power first
  double y_[kNodePoints] = {};
  double s_[kNodePoints] = {};
};

/// Returns the rotation to ITRF from GCRF out of its parts; era, pole_x, pole_y, sp (TIO locator s') in rad.
fsw::Matrix3 R_itrf_gcrf(const CelestialPole& pole, double era, double pole_x, double pole_y, double sp);

/// The real Earth's rotation about one epoch. Not thread-safe: one object per thread.
class EarthRotation {
 public:
  /// Makes the rotation; `orientation` must not be null.
  EarthRotation(std::shared_ptr<const EarthOrientationSeries> orientation, fsw::GpsTime epoch);

  /// Returns the rotation to ITRF from GCRF `seconds` after the epoch. Throws std::out_of_range outside the Earth
  /// orientation data.
  fsw::Matrix3 R_itrf_gcrf_at(double seconds);

  fsw::GpsTime epoch() const { return epoch_; }

 private:
  std::shared_ptr<const EarthOrientationSeries> orientation_;
  fsw::GpsTime epoch_;
  CelestialPoleInterpolator pole_;
};

// Geodetic coordinates on the WGS 84 ellipsoid.

struct GeodeticPosition {
  double latitude = 0.0;   ///< rad, -pi/2 to pi/2
  double longitude = 0.0;  ///< rad, -pi to pi; 0 on the axis
  double altitude = 0.0;   ///< m, above the ellipsoid
};

/// Returns geodetic coordinates from a position in ITRF, m, more than 100 km from the Earth's centre. Bowring's formula
/// (1976) applied twice: errors below 1e-14 rad and 1e-8 m from the ground to geostationary (held by its test). A
/// position that is not finite gives NaNs.
GeodeticPosition geodetic_from_itrf(const fsw::Vector3& position_itrf);

}  // namespace vbar::truth
