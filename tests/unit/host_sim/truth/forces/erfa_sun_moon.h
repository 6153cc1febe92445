#pragma once
// Geocentric Sun and Moon straight from ERFA, for tests of forces that depend on them.

#include <erfa.h>
#include <erfam.h>

#include "fsw/core/types.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::truth::test {

/// Geocentric, GCRF, m. eraEpv00 is good to some 10 km, eraMoon98 to some 10" (20 km).
struct SunMoon {
  fsw::Vector3 sun, moon;
};

inline SunMoon erfa_sun_moon(JulianDate tdb) {
  double heliocentric[2][3], barycentric[2][3], moon[2][3];
  eraEpv00(tdb.day, tdb.fraction, heliocentric, barycentric);
  eraMoon98(tdb.day, tdb.fraction, moon);
  return {-ERFA_DAU * fsw::Vector3(heliocentric[0][0], heliocentric[0][1], heliocentric[0][2]),
          ERFA_DAU * fsw::Vector3(moon[0][0], moon[0][1], moon[0][2])};
}

}  // namespace vbar::truth::test
