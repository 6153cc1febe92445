#include "host_sim/truth/forces/drag_force.h"

#include <cmath>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/truth/earth/time_scales.h"

namespace vbar::truth {
namespace {

constexpr double kEarthRotationRate = 7.292115146706979e-5;  // rad/s, of the Earth rotation angle (IERS 2010, eq. 5.15)
constexpr double kDegreesPerRadian = 180.0 / 3.14159265358979323846;
constexpr double kSecondsPerHour = 3600.0;
constexpr double kDegreesPerHour = 15.0;

// Dates as seconds from the epoch are rounded: an instant this close before a jump counts as the jump.
constexpr fsw::Duration kSameInstant{1000};

double positive(double value, std::string_view what) {
  if (!(value > 0.0 && std::isfinite(value))) {
    throw std::invalid_argument(fmt::format("drag: {} is {}; accepted is a number above 0", what, value));
  }
  return value;
}

}  // namespace

DragForce::DragForce(const SurfaceProperties& spacecraft, std::shared_ptr<const Nrlmsise00Tables> tables,
                     std::shared_ptr<const SpaceWeather> space_weather, GeomagneticIndex geomagnetic_index,
                     fsw::GpsTime epoch)
    : area_to_mass_(positive(spacecraft.drag_coefficient, "the drag coefficient") *
                    positive(spacecraft.drag_area_m2, "the drag area in m^2") /
                    positive(spacecraft.mass_kg, "the mass in kg")),
      atmosphere_(std::move(tables)),
      space_weather_(std::move(space_weather)),
      geomagnetic_index_(geomagnetic_index),
      epoch_(epoch) {
  if (!space_weather_) throw std::invalid_argument("drag needs space weather");
  enter_interval(0.0);
}

fsw::Vector3 DragForce::acceleration_eci(const ForceInput& input) {
  const fsw::Vector3 rotation_eci = kEarthRotationRate * input.R_itrf_gcrf.row(2).transpose();
  const fsw::Vector3 air_velocity_eci = input.velocity_eci - rotation_eci.cross(input.position_eci);
  const double density = atmosphere_at(input).drag_density;
  return -0.5 * area_to_mass_ * density * air_velocity_eci.norm() * air_velocity_eci;
}

AtmosphereState DragForce::atmosphere_at(const ForceInput& input) {
  const GeodeticPosition place = geodetic_from_itrf(input.position_itrf);
  AtmosphereInput air;
  air.day_of_year = day_of_year_;
  air.ut_s = input.seconds - midnight_s_;
  air.altitude_km = 1e-3 * place.altitude;
  air.latitude_deg = kDegreesPerRadian * place.latitude;
  air.longitude_deg = kDegreesPerRadian * place.longitude;
  air.local_solar_time_h = air.ut_s / kSecondsPerHour + air.longitude_deg / kDegreesPerHour;
  air.indices = indices_;
  return atmosphere_.at(air);
}

fsw::GpsTime DragForce::instant(double seconds) const {
  return epoch_ + fsw::nearest_duration(seconds) + kSameInstant;
}

double DragForce::next_jump_after(double seconds) const {
  return fsw::seconds(SpaceWeather::next_change_after(instant(seconds), geomagnetic_index_) - epoch_);
}

void DragForce::enter_interval(double seconds) {
  const fsw::GpsTime time = instant(seconds);
  indices_ = space_weather_->indices_at(time, geomagnetic_index_);
  const int mjd = mjd_utc_of(time);
  day_of_year_ = day_of_year(mjd);
  midnight_s_ = fsw::seconds(midnight_utc(mjd) - epoch_);
}

}  // namespace vbar::truth
