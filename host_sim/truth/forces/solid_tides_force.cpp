#include "host_sim/truth/forces/solid_tides_force.h"

#include <stdexcept>
#include <utility>

#include <erfa.h>

#include "host_sim/truth/forces/third_body_force.h"

namespace vbar::truth {

SolidTidesForce::SolidTidesForce(double gm, double radius, TideSystem tide_system, fsw::GpsTime epoch,
                                 std::shared_ptr<const EarthOrientationSeries> orientation)
    : gm_(gm), radius_(radius), tide_system_(tide_system), epoch_(epoch), orientation_(std::move(orientation)) {
  if (!orientation_) throw std::invalid_argument("the solid tides need Earth orientation data");
}

LowDegreeCoefficients SolidTidesForce::coefficients(const ForceInput& input) {
  const EarthOrientation orientation = orientation_->at(epoch_, input.seconds);
  const JulianDate tt = tt_of(epoch_, input.seconds);
  const JulianDate ut1 = ut1_of(tai_of(epoch_, input.seconds), orientation.ut1_minus_tai_s);

  LowDegreeCoefficients change;
  add_love_number_response({kMoonGm / gm_, input.R_itrf_gcrf * input.moon_eci}, radius_, change);
  add_love_number_response({kSunGm / gm_, input.R_itrf_gcrf * input.sun_eci}, radius_, change);
  frequency_dependent_.add(tt, eraGmst06(ut1.day, ut1.fraction, tt.day, tt.fraction), change);
  add_pole_tides(orientation.pole_x, orientation.pole_y, tt, change);
  if (tide_system_ == TideSystem::kZeroTide) change.c[2][0] -= permanent_tide_c20();
  return change;
}

fsw::Vector3 SolidTidesForce::acceleration_eci(const ForceInput& input) {
  return input.R_itrf_gcrf.transpose() * acceleration_itrf(coefficients(input), gm_, radius_, input.position_itrf);
}

}  // namespace vbar::truth
