#include "host_sim/truth/forces/radiation_pressure.h"

#include <cmath>
#include <random>
#include <stdexcept>
#include <tuple>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "host_sim/truth/earth/sun_moon.h"
#include "host_sim/truth/integration/dopri5.h"
#include "host_sim/truth/integration/event_location.h"
#include "tests/support/accuracy.h"

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

namespace {

constexpr double kDegree = M_PI / 180.0;

/// Circular orbit in the x-y plane.
Vector3 on_circle(double radius, double angle) {
  return {radius * std::cos(angle), radius * std::sin(angle), 0.0};
}

/// How long (s) `edge(angle)` is negative on a circular orbit, around the angle pi where it is lowest.
template <class Edge>
double negative_for(double radius, const Edge& edge) {
  const double rate = std::sqrt(kGm / radius) / radius;
  const auto at = [&](double seconds) { return edge(M_PI + rate * seconds); };
  const double half_turn = M_PI / rate;
  if (!(at(0.0) < 0.0)) return 0.0;
  return first_sign_change(at, 0.0, half_turn, 10, 1e-9).value() -
         first_sign_change(at, 0.0, -half_turn, 10, 1e-9).value();
}

TEST(CylindricalShadow, LastsAsLongAsGeometrySays) {
  // Sphere, parallel light at angle beta from the orbital plane: half the shadow's arc has the cosine
  // sqrt(r^2 - R^2) / (r cos beta) (e.g. Vallado 2013, section 5.3). Located to 1e-9 s; 1e-6 s for sines' roundings,
  // which the shallow crossings of a high beta magnify.
  for (double radius : {6.7e6, 7.0873e6, 2.6e7, 4.2164e7}) {
    const double highest = std::asin(kSphere.equatorial_radius / radius);
    for (double part : {0.0, 0.2, 0.5, 0.9, 0.999}) {
      const double beta = part * highest;
      const Vector3 sun = kAstronomicalUnit * Vector3(std::cos(beta), 0.0, std::sin(beta));
      const double tangent = std::sqrt(radius * radius - kSphere.equatorial_radius * kSphere.equatorial_radius);
      const double arc = 2.0 * std::acos(tangent / (radius * std::cos(beta)));
      const auto edge = [&](double angle) { return cylindrical_shadow_edge(on_circle(radius, angle), sun, kSphere); };
      EXPECT_NEAR(negative_for(radius, edge), arc / std::sqrt(kGm / radius) * radius, 1e-6) << radius << " " << beta;
    }
    const Vector3 too_high = kAstronomicalUnit * Vector3(std::cos(1.001 * highest), 0.0, std::sin(1.001 * highest));
    EXPECT_GT(cylindrical_shadow_edge(on_circle(radius, M_PI), too_high, kSphere), 0.0);
  }
}

TEST(CylindricalShadow, HasNoEdgeOnTheSunnySide) {
  const Vector3 sun(kAstronomicalUnit, 0.0, 0.0);
  for (double angle = -89.0; angle <= 89.0; angle += 1.0) {
    EXPECT_GT(cylindrical_shadow_edge(on_circle(6.5e6, angle * kDegree), sun, kSphere), 0.0);
  }
}

TEST(CylindricalShadow, IsThatOfTheEllipsoid) {
  // The ray towards the Sun meets the ellipsoid x^2 + y^2 + z^2 / (1-f)^2 = R^2 or not: a quadratic equation.
  const EarthFigure earth;
  const double squeeze = 1.0 / ((1.0 - earth.flattening) * (1.0 - earth.flattening));
  const auto product = [&](const Vector3& a, const Vector3& b) {
    return a.x() * b.x() + a.y() * b.y() + a.z() * b.z() * squeeze;
  };
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> height(1e5, 4e6);
  int in_shadow = 0, sphere_differs = 0;
  for (int i = 0; i < 100000; ++i) {
    const Vector3 direction = Vector3(normal(random), normal(random), normal(random)).normalized();
    const Vector3 position = (earth.equatorial_radius + height(random)) * direction;
    const Vector3 sun = kAstronomicalUnit * Vector3(normal(random), normal(random), 0.4 * normal(random)).normalized();
    const double b = product(position, sun), a = product(sun, sun);
    const double c = product(position, position) - earth.equatorial_radius * earth.equatorial_radius;
    const bool hidden = b < 0.0 && b * b > a * c;
    EXPECT_EQ(cylindrical_shadow_edge(position, sun, earth) < 0.0, hidden);
    in_shadow += hidden ? 1 : 0;
    sphere_differs += hidden != (cylindrical_shadow_edge(position, sun, kSphere) < 0.0) ? 1 : 0;
  }
  EXPECT_GT(in_shadow, 1000);
  EXPECT_GT(sphere_differs, 10);
}

TEST(Shadow, OfTheGeostationarySeason) {
  // At the equinox a geostationary spacecraft is eclipsed longest, 72 minutes with the penumbra (Soop 1994,
  // section 5.3: 70 minutes without the Sun's disk). By the sidereal turn here, 0.3 per cent short of the solar day's.
  constexpr double kRadius = 4.2164e7;
  const Vector3 sun(kAstronomicalUnit, 0.0, 0.0);
  const EarthFigure earth;
  const auto disks = [&](double angle) { return sky_disks(on_circle(kRadius, angle), sun, earth); };
  const double cylinder = negative_for(
      kRadius, [&](double angle) { return cylindrical_shadow_edge(on_circle(kRadius, angle), sun, earth); });
  const double penumbra = negative_for(kRadius, [&](double angle) { return penumbra_outer_edge(disks(angle)); });
  const double umbra = negative_for(kRadius, [&](double angle) { return penumbra_inner_edge(disks(angle)); });
  EXPECT_NEAR(cylinder / 60.0, 69.5, 0.5);
  EXPECT_NEAR(penumbra / 60.0, 71.5, 0.5);
  // The Sun's diameter, 32 arcmin, takes 2.1 minutes to set.
  EXPECT_NEAR((penumbra - umbra) / 2.0 / 60.0, 2.13, 0.05);
}

/// The Sun's hidden part by rings about its centre: of a ring of angular radius rho the Earth's cap hides the arc where
/// cos(earth) < cos(rho) cos(separation) + sin(rho) sin(separation) cos(azimuth). Midpoint rule over the rings.
double hidden_by_rings(const SkyDisks& disks) {
  constexpr int kRings = 200000;
  double hidden = 0.0, all = 0.0;
  for (int i = 0; i < kRings; ++i) {
    const double rho = disks.sun_radius * (i + 0.5) / kRings;
    const double weight = std::sin(rho);
    const double cosine = (std::cos(disks.earth_radius) - std::cos(rho) * std::cos(disks.separation)) /
                          (std::sin(rho) * std::sin(disks.separation));
    hidden += weight * std::acos(std::clamp(cosine, -1.0, 1.0)) / M_PI;
    all += weight;
  }
  return hidden / all;
}

TEST(Penumbra, IsTheOverlapOfTwoDisksOnTheSky) {
  // From a low orbit (the Earth 64 degrees in radius) to beyond the umbra's apex (smaller than the Sun). The
  // projection's scale varies by 2e-5 over the Sun's disk; the rings' sums are good to 1e-6.
  const double sun = 0.00465;
  accuracy::Largest largest;
  for (double earth : {64.0 * kDegree, 30.0 * kDegree, 8.7 * kDegree, 1.0 * kDegree, 0.3 * kDegree, 0.2 * kDegree}) {
    for (double part : {0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.98}) {
      const double inner = std::abs(earth - sun), outer = earth + sun;
      const SkyDisks disks{sun, earth, inner + part * (outer - inner)};
      largest.add(std::abs(1.0 - penumbra_sunlit_fraction(disks) - hidden_by_rings(disks)));
    }
  }
  accuracy::expect_below("sunlit fraction in the penumbra", "integration over the Sun's disk, 42 geometries", largest,
                         2e-5, "of full sunlight");
}

TEST(Penumbra, HalfTheSunIsHiddenByAGreatCircle) {
  // A limb that is a great circle (the Earth a hemisphere) through the Sun's centre.
  const SkyDisks disks{0.00465, M_PI_2 - 1e-9, M_PI_2 - 1e-9};
  EXPECT_NEAR(penumbra_sunlit_fraction(disks), 0.5, 1e-6);
}

TEST(Penumbra, IsContinuousAtItsRims) {
  const double sun = 0.00465;
  for (double earth : {64.0 * kDegree, 8.7 * kDegree, 0.3 * kDegree, 0.2 * kDegree}) {
    const double inner = std::abs(earth - sun), outer = earth + sun;
    // Near a rim the covered part changes with the power 3/2 of the way, in units of the disk: (1e-11 / 5e-3)^1.5 is
    // 1e-13, and the roundings of angles near 1 rad over the Sun's size 1e-13.
    EXPECT_NEAR(penumbra_sunlit_fraction({sun, earth, outer - 1e-11}), 1.0, 1e-12);
    EXPECT_EQ(penumbra_sunlit_fraction({sun, earth, outer + 1e-11}), 1.0);
    const SkyDisks inside{sun, earth, inner - 1e-11}, outside{sun, earth, inner + 1e-11};
    EXPECT_NEAR(penumbra_sunlit_fraction(outside), inner_sunlit_fraction(outside), 1e-12);
    EXPECT_EQ(penumbra_sunlit_fraction(inside), inner_sunlit_fraction(inside));
  }
}

TEST(Penumbra, RimsAreWhereTheDisksTouch) {
  // Beyond the umbra's apex the Earth is the smaller disk.
  const EarthFigure earth;
  const Vector3 sun(kAstronomicalUnit, 0.0, 0.0);
  const SkyDisks near = sky_disks({-7e6, 0.0, 0.0}, sun, earth), far = sky_disks({-1.5e9, 0.0, 0.0}, sun, earth);
  EXPECT_EQ(inner_sunlit_fraction(near), 0.0);
  EXPECT_LT(penumbra_inner_edge(near), 0.0);
  EXPECT_LT(penumbra_inner_edge(far), 0.0);
  // Angular radii by definition: 6378.137 / 1.5e6 and 695700 / (149597870.7 + 1.5e6), their sines.
  const double ratio = (6378.137 / 1.5e6) / (695700.0 / 151097870.7);
  EXPECT_NEAR(inner_sunlit_fraction(far), 1.0 - ratio * ratio, 2e-5);  // plane angles for sines: the radius squared
  // The apex: where both look the same, R d / (Rs - R) from the centre, 1.385 million km.
  const double apex = 6378137.0 * kAstronomicalUnit / (kSunRadius - 6378137.0);
  const SkyDisks there = sky_disks({-apex, 0.0, 0.0}, sun, earth);
  EXPECT_NEAR(there.earth_radius, there.sun_radius, 1e-12);
}

}  // namespace

}  // namespace vbar::truth
