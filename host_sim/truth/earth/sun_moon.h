#pragma once
// Geocentric positions of the Sun and the Moon.
//
// Sources, both through ERFA: the Sun as minus the heliocentric Earth of eraEpv00 (Bretagnon's VSOP2000, shortened; 4
// km root mean square, 13 km at most, against JPL DE405 by its notes), the Moon by eraMoon98 (Meeus 1998, chapter 47,
// after ELP 2000; by its notes 6 km root mean square, 32 km at most, against ELP/MPP02).
//
// Positions are geometric: no light time, no aberration. These are required for gravitation. Sunlight arrives from 20.5
// arcsec (1e-4 rad) further back along the Sun's yearly path, which rotates the shadow by the same angle: edges come up
// to 0.1 s earlier or later in a low orbit, both the same way. The Earth's velocity that causes it is neglected in the
// radiation force for the same reason: 1e-4 of a force that is itself known to some per cent.
//
// eraEpv00 asks for TDB and is given TT: 1.7 ms at most, in which the Sun moves 50 m.

#include <cstdint>
#include <map>

#include "fsw/core/types.h"
#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::truth {

/// Geocentric positions, m, along the axes of GCRF.
struct SunMoon {
  fsw::Vector3 sun_eci = fsw::Vector3::Zero();
  fsw::Vector3 moon_eci = fsw::Vector3::Zero();
};

inline constexpr double kAstronomicalUnit = 149597870700.0;  ///< m, by definition (IAU 2012 B2)

/// Computes the full series, some 50 us a call. Made for 1900 to 2100, which is ERFA's range for the Earth.
SunMoon sun_moon_series(JulianDate tt);

/// Interpolates sun_moon_series() between nodes: error below 1 m for the Moon and 0.1 m for the Sun (held by its test).
/// Nodes lie at fixed instants, so the result depends on the date only, never on earlier calls. Not thread-safe (nodes
/// are cached): one object per thread.
class SunMoonInterpolator {
 public:
  SunMoon at(JulianDate tt);

 private:
  void enter_interval(std::int64_t interval);
  const SunMoon& node(std::int64_t index);

  std::map<std::int64_t, SunMoon> nodes_;
  bool ready_ = false;
  std::int64_t interval_ = 0;
  double sun_[3][kNodePoints] = {};  // polynomials in the fraction of the interval, a row each axis
  double moon_[3][kNodePoints] = {};
};

// Velocity of the Earth, for the aberration of stars.

/// Returns the barycentric velocity, m/s, along the axes of GCRF, by eraEpv00. The series asks for TDB; TT differs by
/// less than 2 ms, in which the velocity rotates by 4e-10.
fsw::Vector3 earth_velocity_bcrs(JulianDate tt);

}  // namespace vbar::truth
