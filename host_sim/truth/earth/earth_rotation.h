#pragma once
// GCRF to ITRF by the IAU 2006/2000A conventions (IERS Conventions 2010, chapter 5, CIO-based):
//   R_itrf_gcrf = W(xp, yp, s') R3(ERA) C(X, Y, s).
// The series for X, Y, s (several thousand terms) are computed by ERFA at nodes six hours apart and interpolated; the
// Earth rotation angle is exact at every call. "Exact" is ERFA's own number.

#include <cstdint>
#include <map>
#include <memory>

#include "fsw/core/types.h"
#include "host_sim/truth/earth/earth_orientation.h"
#include "host_sim/truth/earth/node_polynomial.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::truth {

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

}  // namespace vbar::truth
