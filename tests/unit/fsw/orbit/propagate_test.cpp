// The on-board coast against a slow reference integration.

#include "fsw/orbit/propagate.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "fsw/orbit/constants.h"
#include "tests/unit/fsw/orbit/mission.h"
#include "tests/unit/fsw/orbit/reference_orbit.h"

namespace vbar::fsw::orbit {
namespace {

TEST(ReferenceOrbit, AgreesWithAnIndependentProgram) {
  // J2-only truth of the mission orbit after six hours, printed to 1e-4 m and 1e-6 m/s.
  const CartesianState end = reference::fly(cartesian_from_qns(mission::kServicerOsculating).value(), 21600.0, 1.0);
  EXPECT_NEAR(end.position_eci.x(), 750773.9627, 1e-3);  // the program's own integration error is of this order
  EXPECT_NEAR(end.position_eci.y(), 4583790.1554, 1e-3);
  EXPECT_NEAR(end.position_eci.z(), -5352715.4900, 1e-3);
  EXPECT_NEAR(end.velocity_eci.x(), 712.735141, 1e-6);
  EXPECT_NEAR(end.velocity_eci.y(), -5721.338951, 1e-6);
  EXPECT_NEAR(end.velocity_eci.z(), -4787.387539, 1e-6);
}

TEST(Propagate, KeepsItsStatedAccuracy) {
  // From several places in the orbit, forwards and backwards.
  for (int k = 0; k < 12; ++k) {
    QnsElements q = mission::kServicerOsculating;
    q.u = k * 30.0 * mission::kDegree;
    const CartesianState start = cartesian_from_qns(q).value();
    for (double sign : {1.0, -1.0}) {
      const CartesianState ten_minutes = propagate_j2(start, sign * 600.0).value();
      const CartesianState truth = reference::fly(start, sign * 600.0);
      EXPECT_LT((ten_minutes.position_eci - truth.position_eci).norm(), 2e-3);
      EXPECT_LT((ten_minutes.velocity_eci - truth.velocity_eci).norm(), 2e-6);
    }
    const CartesianState two_hours = propagate_j2(start, 7200.0).value();
    EXPECT_LT((two_hours.position_eci - reference::fly(start, 7200.0).position_eci).norm(), 0.3);
  }
}

TEST(Propagate, ErrorFallsWithTheFourthPowerOfTheStep) {
  const CartesianState start = cartesian_from_qns(mission::kServicerOsculating).value();
  // 10 s in one step, and in two by hand: the local error is of fifth order, so two half steps have a sixteenth of it.
  const Vector3 truth = reference::fly(start, 10.0, 0.1).position_eci;
  const double one = (propagate_j2(start, 10.0).value().position_eci - truth).norm();
  const CartesianState half = propagate_j2(start, 5.0).value();
  const double two = (propagate_j2(half, 5.0).value().position_eci - truth).norm();
  EXPECT_NEAR(one / two, 16.0, 2.0);
}

TEST(Propagate, AccelerationIsTheGradientOfThePotential) {
  const auto potential = [](const Vector3& r) {
    const double radius = r.norm();
    const double s = r.z() / radius;
    return kMu / radius * (1.0 - kJ2 * std::pow(kEarthRadius / radius, 2) * (1.5 * s * s - 0.5));
  };
  const Vector3 r(3.1e6, -4.2e6, 4.9e6);
  const double h = 100.0;  // m
  for (int k = 0; k < 3; ++k) {
    const Vector3 step = h * Vector3::Unit(k);
    const double slope = (potential(r + step) - potential(r - step)) / (2.0 * h);
    // Central difference: (h/r)^2 = 2e-10 of 8 m/s^2, and rounding of 6e7 J/kg by 200 m.
    EXPECT_NEAR(acceleration_j2(r)(k), slope, 1e-8);
  }
}

TEST(Propagate, RefusesWhatItCannotCoast) {
  const CartesianState start = cartesian_from_qns(mission::kServicerOsculating).value();
  EXPECT_EQ(propagate_j2(start, 7201.0).status(), Status::kOutOfRange);
  EXPECT_EQ(propagate_j2(start, -7201.0).status(), Status::kOutOfRange);
  EXPECT_EQ(propagate_j2(start, std::numeric_limits<double>::quiet_NaN()).status(), Status::kNotFinite);
  EXPECT_EQ(propagate_j2(start, std::numeric_limits<double>::infinity()).status(), Status::kNotFinite);
  CartesianState bad = start;
  bad.position_eci *= 0.5;
  EXPECT_EQ(propagate_j2(bad, 10.0).status(), Status::kOutOfRange);
  bad = start;
  bad.velocity_eci.z() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(propagate_j2(bad, 10.0).status(), Status::kNotFinite);
  const CartesianState same = propagate_j2(start, 0.0).value();
  EXPECT_EQ(same.position_eci, start.position_eci);
}

}  // namespace
}  // namespace vbar::fsw::orbit
