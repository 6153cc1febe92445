#include "host_sim/truth/forces/drag_force.h"

#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <stdexcept>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "host_sim/truth/earth/earth_rotation.h"
#include "host_sim/truth/earth/time_scales.h"
#include "tests/support/accuracy.h"
#include "tests/unit/host_sim/truth/truth_fixtures.h"

namespace vbar::truth {
namespace {

using fsw::Vector3;
using enum GeomagneticIndex;

constexpr double kEarthRate = 7.2921151467e-5;  // rad/s, IERS Conventions 2010, table 1.2 and eq. 5.15
constexpr SurfaceProperties kSpacecraft{.mass_kg = 180.0, .drag_area_m2 = 0.7, .drag_coefficient = 2.3};

std::shared_ptr<const Nrlmsise00Tables> tables() {
  static const auto shared = std::make_shared<const Nrlmsise00Tables>(
      load_nrlmsise00_tables(test::kDataDirectory / "atmosphere/nrlmsise00.csv"));
  return shared;
}

std::shared_ptr<const SpaceWeather> space_weather() {
  static const auto shared = std::make_shared<const SpaceWeather>(
      SpaceWeather::load(test::kDataDirectory / "earth/space_weather_2009_2013.csv"));
  return shared;
}

DragForce drag(GeomagneticIndex index = kDaily, fsw::GpsTime epoch = test::mission_epoch()) {
  return {kSpacecraft, tables(), space_weather(), index, epoch};
}

/// An Earth that stands with Greenwich on the x axis at `seconds` = 0 and turns about z.
ForceInput input_at(double seconds, const Vector3& position_eci, const Vector3& velocity_eci) {
  ForceInput input;
  input.seconds = seconds;
  input.position_eci = position_eci;
  input.velocity_eci = velocity_eci;
  input.R_itrf_gcrf = Eigen::AngleAxisd(-kEarthRate * seconds, Vector3::UnitZ()).toRotationMatrix();
  input.position_itrf = input.R_itrf_gcrf * position_eci;
  return input;
}

TEST(DragForce, AgreesWithAHandComputedPoint) {
  // 500 km above the equator at longitude 90 deg, 2011-07-18 1h UTC: day 199, 3600 s UT, local solar time 1 h + 6 h;
  // CelesTrak: F10.7 103.6 (the 17th), mean 96.3, Ap 6 (the 18th). Eastward at 7612 m/s, of which the air does w r.
  AtmosphereInput air;
  air.day_of_year = 199;
  air.ut_s = 3600.0;
  air.altitude_km = 500.0;
  air.longitude_deg = 90.0;
  air.local_solar_time_h = 7.0;
  air.indices.f107 = 103.6;
  air.indices.f107_average = 96.3;
  air.indices.ap_daily = 6.0;
  const double density = Nrlmsise00(tables()).at(air).drag_density;
  const double r = 6378137.0 + 500e3;
  const double air_speed = 7612.0 - 7.2921151467e-5 * r;
  const double expected = 0.5 * (2.3 * 0.7 / 180.0) * density * air_speed * air_speed;

  DragForce force = drag();
  const Vector3 found = force.acceleration_eci(input_at(0.0, {0.0, r, 0.0}, {-7612.0, 0.0, 0.0}));
  EXPECT_NEAR(found.x() / expected, 1.0, 1e-10);  // 1e-9 m of 60 km scale height, ten digits of w
  EXPECT_EQ(found.y(), 0.0);
  EXPECT_EQ(found.z(), 0.0);
}

TEST(DragForce, NothingDragsOnWhatTurnsWithTheEarth) {
  // A point fixed to the real Earth: its velocity is the derivative of the rotation matrix, polar motion, length of day
  // and precession included. What is left of the air's speed is the stated error.
  auto orientation = std::make_shared<const EarthOrientationSeries>(
      EarthOrientationSeries::load(test::kDataDirectory / "earth/eop_2009_2013.csv"));
  EarthRotation rotation(orientation, test::mission_epoch());
  DragForce force = drag();
  accuracy::Largest largest;
  for (const Vector3& r_itrf : {Vector3(6.9e6, 0.0, 0.0), Vector3(-4e6, 4e6, 4e6), Vector3(1e6, -2e6, -6.6e6)}) {
    for (int seconds = 100; seconds < 80000; seconds += 9000) {
      constexpr double kStep = 1.0;  // s: truncation w^3 r/6 = 4e-7 m/s
      ForceInput input;
      input.seconds = seconds;
      input.R_itrf_gcrf = rotation.R_itrf_gcrf_at(seconds);
      input.position_itrf = r_itrf;
      input.position_eci = input.R_itrf_gcrf.transpose() * r_itrf;
      input.velocity_eci = (rotation.R_itrf_gcrf_at(seconds + kStep).transpose() * r_itrf -
                            rotation.R_itrf_gcrf_at(seconds - kStep).transpose() * r_itrf) /
                           (2.0 * kStep);
      const double area_to_mass = kSpacecraft.drag_coefficient * kSpacecraft.drag_area_m2 / kSpacecraft.mass_kg;
      const double density = force.atmosphere_at(input).drag_density;
      largest.add(std::sqrt(2.0 * force.acceleration_eci(input).norm() / (area_to_mass * density)));
    }
  }
  // Polar motion of up to 0.5 arcsec times w r, 510 m/s: 1.2 mm/s.
  accuracy::expect_below("velocity of the air that turns with the Earth",
                         "derivative of the IAU 2006 rotation with Earth orientation data, 27 points", largest, 3e-3,
                         "m/s");
}

TEST(DragForce, ACircularOrbitDecaysAsTheFormulaSays) {
  // Gauss's equation for a circular orbit, a' = 2 f_T / n, over a revolution: da = -2 pi (C_D A / m) rho a^2 (Wertz,
  // Space Mission Analysis and Design, eq. 6-23); here with the density averaged around the orbit, and with the speed
  // through the air of an equatorial orbit, (1 - w/n) of the orbital one.
  const double gm = test::kGm;
  const double a = 6378137.0 + 400e3;
  const double n = std::sqrt(gm / (a * a * a));
  const double period = 2.0 * M_PI / n;
  DragForce force = drag();
  const auto circular = [&](double t) {
    const Vector3 radial(std::cos(n * t), std::sin(n * t), 0.0);
    const Vector3 along(-std::sin(n * t), std::cos(n * t), 0.0);
    return input_at(t, a * radial, a * n * along);
  };
  constexpr int kSteps = 400;
  double mean_density = 0.0;
  for (int i = 0; i < kSteps; ++i)
    mean_density += force.atmosphere_at(circular(period * i / kSteps)).drag_density / kSteps;
  const double area_to_mass = kSpacecraft.drag_coefficient * kSpacecraft.drag_area_m2 / kSpacecraft.mass_kg;
  const double air = 1.0 - kEarthRate / n;
  const double expected = -2.0 * M_PI * area_to_mass * mean_density * a * a * air * air;

  // Newton's equations by the classical Runge-Kutta rule.
  Vector3 r = circular(0.0).position_eci, v = circular(0.0).velocity_eci;
  const auto rate = [&](double t, const Vector3& position, const Vector3& velocity) -> Vector3 {
    const double distance = position.norm();
    return -gm / (distance * distance * distance) * position + force.acceleration_eci(input_at(t, position, velocity));
  };
  const double h = period / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const double t = h * i;
    const Vector3 k1 = rate(t, r, v);
    const Vector3 k2 = rate(t + 0.5 * h, r + 0.5 * h * v, v + 0.5 * h * k1);
    const Vector3 k3 = rate(t + 0.5 * h, r + 0.5 * h * v + 0.25 * h * h * k1, v + 0.5 * h * k2);
    const Vector3 k4 = rate(t + h, r + h * v + 0.5 * h * h * k2, v + h * k3);
    r += h * v + h * h / 6.0 * (k1 + k2 + k3);
    v += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  const double a_after = 1.0 / (2.0 / r.norm() - v.squaredNorm() / gm);
  // The orbit sinks by 40 m, 1e-3 of a scale height of density, while the formula holds it at its first altitude.
  accuracy::expect_below("decay of a circular orbit at 400 km in a revolution", "analytic: 2 pi (C_D A/m) rho a^2",
                         std::abs((a_after - a) / expected - 1.0), 2e-3, "relative");
}

TEST(DragForce, IndicesAreFrozenUntilTheNextIntervalIsEntered) {
  DragForce force = drag();
  EXPECT_EQ(force.next_jump_after(0.0), 23.0 * 3600.0);
  const Vector3 r(6878137.0, 0.0, 0.0), v(0.0, 7612.0, 0.0);
  const double midnight = force.next_jump_after(0.0);
  const double before = force.acceleration_eci(input_at(midnight, r, v)).norm();
  const double just_before = force.acceleration_eci(input_at(midnight - 1e-3, r, v)).norm();
  EXPECT_NEAR(just_before / before, 1.0, 1e-6);  // smooth: an orbit's change of density is 1e-3 a second
  force.enter_interval(midnight);
  const double after = force.acceleration_eci(input_at(midnight, r, v)).norm();
  EXPECT_GT(std::abs(after / before - 1.0), 1e-3);  // Ap 6 to 15, F10.7 103.6 to 102.0
  // The same as of a run that begins there.
  DragForce later = drag(kDaily, gps_from_utc("2011-07-19T00:00:00Z"));
  ForceInput input = input_at(midnight, r, v);
  input.seconds = 0.0;
  EXPECT_EQ(later.acceleration_eci(input).norm(), after);
}

TEST(DragForce, JumpsFollowOneAnother) {
  // Also from an epoch that is no whole second, over months, where seconds as doubles have lost nanoseconds.
  for (const GeomagneticIndex index : {kDaily, kThreeHourly}) {
    DragForce force = drag(index, gps_from_utc("2012-05-01T07:59:59.123456789Z"));
    double seconds = 0.0;
    int jumps = 0;
    while (seconds < 120.0 * 86400.0) {
      const double next = force.next_jump_after(seconds);
      ASSERT_GT(next, seconds);
      ASSERT_LE(next - seconds, index == kDaily ? 86401.0 : 10801.0);
      force.enter_interval(next);
      seconds = next;
      ++jumps;
    }
    EXPECT_EQ(jumps, index == kDaily ? 121 : 961);  // to the midnight or third hour that ends the 120th day
  }
}

TEST(DragForce, ThreeHourlyIndicesSeeTheStorm) {
  // 2012-03-09: ap up to 207 by CelesTrak; drag at 500 km is well above that of the daily index's morning before it.
  const fsw::GpsTime storm = gps_from_utc("2012-03-09T09:00:00Z");
  const Vector3 r(6878137.0, 0.0, 0.0), v(0.0, 7612.0, 0.0);
  DragForce force = drag(kThreeHourly, storm);
  DragForce quiet = drag(kThreeHourly, gps_from_utc("2012-03-06T09:00:00Z"));
  EXPECT_GT(force.acceleration_eci(input_at(0.0, r, v)).norm(),
            1.2 * quiet.acceleration_eci(input_at(0.0, r, v)).norm());
}

TEST(DragForce, RefusesWhatHasNoDrag) {
  const auto refuses = [](SurfaceProperties properties) {
    EXPECT_THROW(DragForce(properties, tables(), space_weather(), kDaily, test::mission_epoch()),
                 std::invalid_argument);
  };
  for (const double bad :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    SurfaceProperties properties = kSpacecraft;
    properties.mass_kg = bad;
    refuses(properties);
    properties = kSpacecraft;
    properties.drag_area_m2 = bad;
    refuses(properties);
    properties = kSpacecraft;
    properties.drag_coefficient = bad;
    refuses(properties);
  }
  EXPECT_THROW(DragForce(kSpacecraft, nullptr, space_weather(), kDaily, test::mission_epoch()), std::invalid_argument);
  EXPECT_THROW(DragForce(kSpacecraft, tables(), nullptr, kDaily, test::mission_epoch()), std::invalid_argument);
  EXPECT_THROW(drag(kDaily, gps_from_utc("2014-01-01T00:00:00Z")), std::out_of_range);
}

TEST(DragForce, HasNoAirBelowTheGroundAndSomeEverywhereAbove) {
  DragForce force = drag();
  const Vector3 v(0.0, 7612.0, 0.0);
  EXPECT_THROW(force.acceleration_eci(input_at(0.0, {6378136.0, 0.0, 0.0}, v)), std::domain_error);
  double before = std::numeric_limits<double>::infinity();
  for (int step = 0; step < 190; ++step) {
    const double distance = 6378138.0 * std::pow(1.01, step);  // to geostationary
    const double now =
        force.acceleration_eci(input_at(0.0, {distance, 0.0, 0.0}, {0.0, 7612.0 + kEarthRate * distance, 0.0})).norm();
    EXPECT_GT(now, 0.0);
    EXPECT_LT(now, before);
    before = now;
  }
  // Over the poles.
  EXPECT_GT(force.acceleration_eci(input_at(0.0, {0.0, 0.0, 6.9e6}, v)).norm(), 0.0);
  EXPECT_GT(force.acceleration_eci(input_at(0.0, {0.0, 0.0, -6.9e6}, v)).norm(), 0.0);
}

}  // namespace
}  // namespace vbar::truth
