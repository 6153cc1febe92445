#include <cmath>
#include <exception>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host_sim/truth/earth/sun_moon.h"
#include "host_sim/truth/forces/gravitation.h"
#include "host_sim/truth/orbital_motion.h"
#include "host_sim/truth/spacecraft_dynamics.h"
#include "tests/support/figures.h"
#include "tests/unit/host_sim/truth/truth_fixtures.h"

namespace vbar::truth {

namespace {

using fsw::Vector3;
using fsw::Vector6;
using fsw::orbit::CartesianState;
using fsw::orbit::QnsElements;
using test::kGm;

std::vector<QnsElements> orbits(int count, double largest_eccentricity) {
  std::mt19937_64 random(18);
  std::uniform_real_distribution<double> unit(0.0, 1.0), angle(-3.1, 3.1);
  std::vector<QnsElements> result;
  for (int i = 0; i < count; ++i) {
    const double e = largest_eccentricity * unit(random), w = angle(random);
    result.push_back({6.6e6 + 3.6e7 * unit(random), e * std::cos(w), e * std::sin(w), 0.02 + 3.1 * unit(random),
                      angle(random), angle(random)});
  }
  return result;
}

TEST(OrbitGeometry, MissionStateOfTheTable) {
  // Printed to 1e-7 m and 1e-10 m/s by another program from the same elements; one unit in the last place, and rounding
  // of 7e6 m.
  const CartesianState state = test::servicer_state();
  EXPECT_LT(accuracy::largest_entry(state.position_eci - Vector3(12161.8456633, -7076153.584868, -84606.5539942)),
            1e-6);
  EXPECT_LT(accuracy::largest_entry(state.velocity_eci - Vector3(-1068.5690877908, -90.5830005301, 7433.7358593127)),
            2e-10);
}

TEST(OrbitGeometry, ElementsAndStatesThereAndBack) {
  for (const QnsElements& q : orbits(500, 0.9)) {
    const QnsElements back = elements_from_cartesian(orbit_geometry(q, kGm).state, kGm);
    // Rounding, 2e-16, grown by 1/(1-e)^2 near the perigee of an eccentric orbit: at most 1e2.
    EXPECT_NEAR(back.a / q.a, 1.0, 1e-13);
    EXPECT_NEAR(back.ex, q.ex, 1e-13);
    EXPECT_NEAR(back.ey, q.ey, 1e-13);
    EXPECT_NEAR(back.i, q.i, 1e-14);
    EXPECT_NEAR(std::remainder(back.raan - q.raan, 2.0 * M_PI), 0.0, 1e-13);
    EXPECT_NEAR(std::remainder(back.u - q.u, 2.0 * M_PI), 0.0, 1e-12);
  }
}

TEST(OrbitGeometry, IsConsistentInItself) {
  for (const QnsElements& q : orbits(200, 0.8)) {
    const OrbitGeometry g = orbit_geometry(q, kGm);
    const Vector3 h = g.state.position_eci.cross(g.state.velocity_eci);
    EXPECT_NEAR(g.r / g.state.position_eci.norm(), 1.0, 1e-14);
    EXPECT_NEAR(g.h / h.norm(), 1.0, 1e-14);
    EXPECT_LT((g.R_rtn_eci * g.state.position_eci - Vector3(g.r, 0.0, 0.0)).norm(), 1e-14 * g.r);
    EXPECT_LT((g.R_rtn_eci * h - Vector3(0.0, 0.0, g.h)).norm(), 1e-14 * g.h);
    EXPECT_NEAR(g.R_rtn_eci.determinant(), 1.0, 1e-14);
    EXPECT_NEAR(g.r * (1.0 + q.ex * g.cos_theta + q.ey * g.sin_theta) / g.p, 1.0, 1e-13);  // the conic's equation
  }
}

TEST(OrbitGeometry, AgreesWithTheFlightSoftwaresConversions) {
  // Written independently, on another mathematics library.
  for (const QnsElements& q : orbits(200, 0.3)) {
    const CartesianState host = orbit_geometry(q, kGm).state;
    const auto flight = fsw::orbit::cartesian_from_qns(q);
    ASSERT_TRUE(flight.ok());
    EXPECT_LT((flight.value().position_eci - host.position_eci).norm(), 1e-14 * host.position_eci.norm());
    EXPECT_LT((flight.value().velocity_eci - host.velocity_eci).norm(), 1e-14 * host.velocity_eci.norm());
  }
}

TEST(OrbitGeometry, RefusesWhatIsNoEllipse) {
  EXPECT_THROW(orbit_geometry({7e6, 0.8, 0.7, 1.0, 0.0, 0.0}, kGm), std::domain_error);
  EXPECT_THROW(orbit_geometry({-7e6, 0.0, 0.0, 1.0, 0.0, 0.0}, kGm), std::domain_error);
  EXPECT_THROW(orbit_geometry({7e6, std::nan(""), 0.0, 1.0, 0.0, 0.0}, kGm), std::domain_error);
  const Vector3 r(7e6, 0.0, 0.0);
  EXPECT_THROW(elements_from_cartesian({r, Vector3(0.0, 9000.0, 7000.0)}, kGm), std::domain_error);  // hyperbolic
  EXPECT_THROW(elements_from_cartesian({r, Vector3(0.0, 7500.0, 0.0)}, kGm), std::domain_error);     // equatorial
  EXPECT_THROW(elements_from_cartesian({r, Vector3(10.0, 0.0, 0.0)}, kGm), std::domain_error);       // rectilinear
  EXPECT_THROW(elements_from_cartesian({r, Vector3(std::nan(""), 1.0, 1.0)}, kGm), std::domain_error);
  EXPECT_THROW(elements_from_cartesian({Vector3::Zero(), Vector3(0.0, 1.0, 1.0)}, kGm), std::domain_error);
}

TEST(Gve, WithoutForceOnlyTheMeanLongitudeMoves) {
  for (const QnsElements& q : orbits(50, 0.8)) {
    const Vector6 rates = gve_rates(q, orbit_geometry(q, kGm), Vector3::Zero());
    EXPECT_EQ(rates.head<5>(), (Eigen::Matrix<double, 5, 1>::Zero()));
    EXPECT_DOUBLE_EQ(rates[5], std::sqrt(kGm / (q.a * q.a * q.a)));
  }
}

TEST(Gve, AreTheDerivativesOfTheElementsByVelocity) {
  // A perturbation changes the velocity and nothing else at once: the rates beside the mean motion are the derivative
  // of the elements along it, here by central differences through the conversion from position and velocity.
  std::mt19937_64 random(3);
  std::normal_distribution<double> component;
  for (const QnsElements& q : orbits(300, 0.7)) {
    const OrbitGeometry g = orbit_geometry(q, kGm);
    const Vector3 f_rtn(component(random), component(random), component(random));
    const Vector6 rates = gve_rates(q, g, f_rtn);

    const double step = 1e-6 * g.state.velocity_eci.norm();
    CartesianState ahead = g.state, behind = g.state;
    ahead.velocity_eci += step * (g.R_rtn_eci.transpose() * f_rtn);
    behind.velocity_eci -= step * (g.R_rtn_eci.transpose() * f_rtn);
    Vector6 expected = vector_from_elements(elements_from_cartesian(ahead, kGm)) -
                       vector_from_elements(elements_from_cartesian(behind, kGm));
    expected[4] = std::remainder(expected[4], 2.0 * M_PI);
    expected[5] = std::remainder(expected[5], 2.0 * M_PI);
    expected /= 2.0 * step;
    expected[5] += g.n;
    // Differences: relative truncation 1e-12 times third derivatives, rounding 1e-16/1e-6, both grown by 1/sin i (up to
    // 50) and 1/(1-e)^2 (up to 11). Each rate against the largest an acceleration of this size can cause.
    const double scale = f_rtn.norm() * g.r / g.h / g.sin_i;
    EXPECT_NEAR(rates[0] / q.a, expected[0] / q.a, 1e-7 * scale);
    for (int i = 1; i < 6; ++i) EXPECT_NEAR(rates[i], expected[i], 1e-7 * scale) << i;
  }
}

TEST(Gve, VectorsAndElementsAreTheSameThing) {
  const QnsElements q{1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
  const Vector6 v = vector_from_elements(q);
  EXPECT_EQ(v, (Vector6() << 1.0, 2.0, 3.0, 4.0, 5.0, 6.0).finished());
  const QnsElements back = elements_from_vector(v);
  EXPECT_EQ(vector_from_elements(back), v);
}

}  // namespace

namespace {

using test::dynamics_with;
using test::fly;
using test::InertialJ2;
using test::list;
using test::servicer_state;
using test::sunlight;

template <class Call>
std::string error_of(const Call& call) {
  try {
    call();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

TEST(Dynamics, SharesAddUpAndLeaveTheRegime) {
  const auto dynamics = dynamics_with(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kCylindrical),
                                           std::make_unique<ThirdBodyForce>(ThirdBodyForce::Body::kSun)));
  dynamics->enter_regime_of(0.0, servicer_state());
  ASSERT_EQ(dynamics->edge_count(), 1);
  const auto side = dynamics->regime().sides;
  // Behind the Earth: there the light's share is nothing, whatever the integrator was told.
  CartesianState behind = servicer_state();
  behind.position_eci = -7e6 * sun_moon_series(tt_of(test::mission_epoch())).sun_eci.normalized();
  const auto shares = dynamics->accelerations(0.0, behind);
  ASSERT_EQ(shares.size(), 3u);
  EXPECT_EQ(shares[0].force, "inertial J2");
  EXPECT_EQ(shares[1].force, "radiation_pressure");
  EXPECT_EQ(shares[1].acceleration_eci, Vector3::Zero());
  EXPECT_EQ(shares[2].force, "sun");
  EXPECT_EQ(dynamics->regime().sides, side);

  Vector3 sum = Vector3::Zero();
  for (const auto& share : dynamics->accelerations(0.0, servicer_state())) sum += share.acceleration_eci;
  EXPECT_EQ(sum, dynamics->perturbation_eci(0.0, servicer_state()));
}

TEST(Dynamics, MeasuresTimeOnlyWhenAsked) {
  const auto dynamics = dynamics_with(list(std::make_unique<InertialJ2>(), sunlight(Shadow::kCylindrical)));
  const auto total = [&] {
    double sum = 0.0;
    for (const auto& time : dynamics->times()) sum += time.wall_s;
    return sum;
  };
  const Vector3 untimed = dynamics->perturbation_eci(0.0, servicer_state());
  EXPECT_EQ(total(), 0.0);
  dynamics->measure_time(true);
  EXPECT_EQ(dynamics->perturbation_eci(0.0, servicer_state()), untimed);
  EXPECT_GT(total(), 0.0);
  ASSERT_EQ(dynamics->times().size(), 3u);
  EXPECT_EQ(dynamics->times()[0].force, "frames");
  EXPECT_EQ(dynamics->times()[2].force, "radiation_pressure");
}

/// A thrust along the velocity, m/s^2: forwards it leaves the ellipse, backwards it falls.
class Thrust final : public Force {
 public:
  explicit Thrust(double along_velocity) : along_velocity_(along_velocity) {}
  std::string_view name() const override { return "thrust"; }
  Vector3 acceleration_eci(const ForceInput& input) override {
    return along_velocity_ * input.velocity_eci.normalized();
  }

 private:
  double along_velocity_;
};

TEST(Propagator, SaysWhoLeavesItsOrbitAndWhen) {
  // The mission begins at 2011-07-18T01:00:00 UTC; both last under an hour.
  using testing::AllOf;
  using testing::HasSubstr;
  EXPECT_THAT(error_of([] { fly(list(std::make_unique<Thrust>(-0.5)), 1e-12, 20000.0); }),
              AllOf(HasSubstr("spacecraft \"test\": re-enters: "), HasSubstr(" km above the Earth at 2011-07-18T01:")));
  EXPECT_THAT(error_of([] { fly(list(std::make_unique<Thrust>(5.0)), 1e-12, 20000.0); }),
              AllOf(HasSubstr("spacecraft \"test\": the orbit is not an ellipse"), HasSubstr(", at 2011-07-18T01:")));
  const auto start_at = [](double scale_r, double scale_v) {
    CartesianState state = servicer_state();
    state.position_eci *= scale_r;
    state.velocity_eci *= scale_v;
    SpacecraftPropagator(dynamics_with({}), 1e-12, 0.0, state);
  };
  // 7076.7 km from the centre at the start: 79.9 and 80.1 km above 6378.1363 km.
  const double start = servicer_state().position_eci.norm();
  EXPECT_THAT(error_of([&] { start_at((test::kEarthRadius + 79.9e3) / start, 1.05); }),
              HasSubstr("spacecraft \"test\": re-enters: 79.9 km above the Earth at 2011-07-18T01:00:00"));
  EXPECT_EQ(error_of([&] { start_at((test::kEarthRadius + 80.1e3) / start, 1.05); }), "");
  EXPECT_THAT(error_of([&] { start_at(1.0, 1.5); }),
              HasSubstr("spacecraft \"test\": the orbit is not an ellipse: at distance"));
}

}  // namespace

}  // namespace vbar::truth
