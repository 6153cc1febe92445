#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "host_sim/truth/dopri5.h"
#include "host_sim/truth/event_location.h"
#include "host_sim/truth/forces/radiation_pressure_force.h"

namespace vbar::truth {
namespace {

using fsw::Vector3;
using fsw::Vector6;

constexpr double kGm = 3.986004415e14;
constexpr EarthFigure kSphere{6378136.3, 0.0};

SurfaceProperties surface() {
  SurfaceProperties properties;
  properties.mass_kg = 100.0;
  properties.radiation_area_m2 = 2.0;
  properties.radiation_coefficient = 1.5;
  return properties;
}

ForceInput input_at(const Vector3& position, const Vector3& sun) {
  ForceInput input;
  input.position_eci = position;
  input.sun_eci = sun;
  return input;
}

TEST(RadiationPressure, PushesAwayFromTheSunWithTheSquareOfTheDistance) {
  RadiationPressureForce force(surface(), Shadow::kNone);
  // 1361 W/m^2 over the speed of light: 4.5398e-6 N/m^2 (to its five digits), times C_R A / m = 0.03 m^2/kg.
  const Vector3 at_1_au = force.acceleration_eci(input_at(Vector3::Zero(), {kAstronomicalUnit, 0.0, 0.0}));
  EXPECT_NEAR(at_1_au.x(), -4.5398e-6 * 0.03, 5e-11 * 0.03);
  EXPECT_EQ(at_1_au.y(), 0.0);
  const Vector3 at_2_au = force.acceleration_eci(input_at(Vector3::Zero(), {2.0 * kAstronomicalUnit, 0.0, 0.0}));
  EXPECT_NEAR(at_2_au.x() / at_1_au.x(), 0.25, 1e-15);
  // Measured from the spacecraft, not from the Earth.
  const Vector3 nearer =
      force.acceleration_eci(input_at({0.01 * kAstronomicalUnit, 0.0, 0.0}, {kAstronomicalUnit, 0.0, 0.0}));
  EXPECT_NEAR(nearer.x() / at_1_au.x(), 1.0 / (0.99 * 0.99), 1e-14);
}

TEST(RadiationPressure, ActsAsOnTheSideItWasTold) {
  const Vector3 sun(kAstronomicalUnit, 0.0, 0.0);
  const ForceInput day = input_at({7e6, 0.0, 0.0}, sun), night = input_at({-7e6, 0.0, 0.0}, sun);
  for (Shadow shadow : {Shadow::kCylindrical, Shadow::kConical}) {
    RadiationPressureForce force(surface(), shadow);
    for (int edge = 0; edge < force.edge_count(); ++edge) {
      EXPECT_GT(force.edge(edge, day), 0.0);
      EXPECT_LT(force.edge(edge, night), 0.0);
      force.set_side(edge, true);
    }
    EXPECT_EQ(force.sunlit_fraction(night), 1.0);
    for (int edge = 0; edge < force.edge_count(); ++edge) force.set_side(edge, false);
    EXPECT_EQ(force.sunlit_fraction(night), 0.0);
    EXPECT_EQ(force.acceleration_eci(night), Vector3::Zero());
  }
  RadiationPressureForce cylinder(surface(), Shadow::kCylindrical);
  cylinder.set_side(0, false);
  EXPECT_EQ(cylinder.sunlit_fraction(day), 0.0);
  EXPECT_EQ(RadiationPressureForce(surface(), Shadow::kNone).edge_count(), 0);
  EXPECT_EQ(RadiationPressureForce(surface(), Shadow::kNone).sunlit_fraction(night), 1.0);
}

TEST(RadiationPressure, IsConservativeInTheLight) {
  // With the Sun at rest the force is the gradient of a potential, k / distance from the Sun, so the energy with it is
  // constant. A light balloon (1 m^2/kg) is pushed by 1e-5 of its orbital energy; the integration holds 1e-13 of it.
  SurfaceProperties balloon = surface();
  balloon.mass_kg = 3.0;
  RadiationPressureForce force(balloon, Shadow::kNone);
  const Vector3 sun = kAstronomicalUnit * Vector3(0.6, 0.64, 0.48);
  const auto rates = [&](double, const Vector6& y) {
    Vector6 rate;
    const double r = y.head<3>().norm();
    rate << y.tail<3>(), -kGm / (r * r * r) * y.head<3>() + force.acceleration_eci(input_at(y.head<3>(), sun));
    return rate;
  };
  const auto energy = [&](const Vector6& y, bool with_light) {
    const double k = kSolarPressure * kAstronomicalUnit * kAstronomicalUnit;
    // Less its value at the Earth's centre, without the difference of two large numbers.
    const double distance = (y.head<3>() - sun).norm(), d0 = sun.norm();
    const double light = k * (2.0 * sun - y.head<3>()).dot(y.head<3>()) / (distance * d0 * (distance + d0));
    return 0.5 * y.tail<3>().squaredNorm() - kGm / y.head<3>().norm() + (with_light ? light : 0.0);
  };
  Dopri5<6, decltype(rates)>::Tolerance tolerance;
  tolerance.relative.setConstant(1e-13);
  tolerance.absolute.setConstant(1e-7);
  Dopri5<6, decltype(rates)> integrator(rates, tolerance);
  Vector6 start;
  start << 4.2e7, 0.0, 0.0, 0.0, 2500.0, 1800.0;
  integrator.start(0.0, start);
  integrator.integrate_to(30000.0);
  const double drift = std::abs(energy(integrator.state(), true) - energy(start, true)) / std::abs(energy(start, true));
  const double without =
      std::abs(energy(integrator.state(), false) - energy(start, false)) / std::abs(energy(start, true));
  EXPECT_LT(drift, 1e-11);   // 1e-13 a step, some tens of steps
  EXPECT_GT(without, 1e-6);  // so the light did something
}

TEST(RadiationPressure, DoesNoWorkOnACircularOrbit) {
  // Kozai (1961): where a circular orbit leaves the cylinder and where it enters it are equally far along the sunlight,
  // so a constant force along it does no work in between, and the semi-major axis does not drift. The work over the
  // lit arc by Simpson's rule, over the force times the radius: 1e-9, of the rule and of the force's not being quite
  // constant (r / 1 au = 5e-5 of it, odd about the light's direction, does no work either).
  constexpr double kRadius = 7.0873e6;
  for (double beta : {0.0, 0.3, 0.8}) {
    const Vector3 sun = kAstronomicalUnit * Vector3(std::cos(beta), 0.0, std::sin(beta));
    RadiationPressureForce force(surface(), Shadow::kCylindrical, kSphere);
    const auto place = [&](double angle) {
      return input_at(kRadius * Vector3(std::cos(angle), std::sin(angle), 0.0), sun);
    };
    const auto edge = [&](double angle) { return force.edge(0, place(angle)); };
    const double enter = first_sign_change(edge, 0.0, M_PI, 20, 1e-12).value();
    const double leave = first_sign_change(edge, 0.0, -M_PI, 20, 1e-12).value();
    const auto power = [&](double angle) {
      return force.acceleration_eci(place(angle)).dot(kRadius * Vector3(-std::sin(angle), std::cos(angle), 0.0));
    };
    constexpr int kIntervals = 1000;
    const double h = (enter - leave) / kIntervals;
    double work = power(leave) + power(enter);
    for (int i = 1; i < kIntervals; ++i) work += (i % 2 == 1 ? 4.0 : 2.0) * power(leave + h * i);
    work *= h / 3.0;
    EXPECT_LT(std::abs(work), 1e-9 * kSolarPressure * 0.03 * kRadius) << beta;
    EXPECT_LT(enter, M_PI - 0.1);  // there is a shadow
  }
}

TEST(RadiationPressure, RefusesNonsense) {
  SurfaceProperties bad = surface();
  bad.mass_kg = 0.0;
  EXPECT_THROW(RadiationPressureForce(bad, Shadow::kNone), std::invalid_argument);
  bad = surface();
  bad.radiation_area_m2 = -1.0;
  EXPECT_THROW(RadiationPressureForce(bad, Shadow::kNone), std::invalid_argument);
  bad = surface();
  bad.radiation_coefficient = std::nan("");
  EXPECT_THROW(RadiationPressureForce(bad, Shadow::kNone), std::invalid_argument);
}

}  // namespace
}  // namespace vbar::truth
