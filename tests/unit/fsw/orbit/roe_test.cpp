// Relative orbital elements and their linear map to RTN.

#include "fsw/orbit/roe.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/figures.h"
#include "tests/unit/fsw/orbit/mission.h"

namespace vbar::fsw::orbit {
namespace {

constexpr double kDegree = mission::kDegree;

QnsElements from_keplerian(double a, double e, double i_deg, double raan_deg, double w_deg, double m_deg) {
  const double w = w_deg * kDegree;
  return {.a = a,
          .ex = e * std::cos(w),
          .ey = e * std::sin(w),
          .i = i_deg * kDegree,
          .raan = raan_deg * kDegree,
          .u = w + m_deg * kDegree};
}

TEST(Roe, MatchBrahe) {
  // brahe, src/relative_motion/oe_roe.rs, its unit test.
  const QnsElements chief = from_keplerian(6378136.3 + 700e3, 0.001, 97.8, 15.0, 30.0, 45.0);
  const QnsElements deputy = from_keplerian(6378136.3 + 701e3, 0.0015, 97.85, 15.05, 30.05, 45.05);
  const Vector6 roe = roe_from_qns(chief, deputy);
  // A difference of angles of 1 rad carries a rounding of 2e-16.
  EXPECT_NEAR(roe(0), 1.412801276516814e-4, 1e-18);
  EXPECT_NEAR(roe(1), 9.321422137829084e-2 * kDegree, 1e-15);
  EXPECT_NEAR(roe(2), 4.323577088687794e-4, 1e-17);
  EXPECT_NEAR(roe(3), 2.511333388799496e-4, 1e-17);
  EXPECT_NEAR(roe(4), 5e-2 * kDegree, 1e-15);
  EXPECT_NEAR(roe(5), 4.95373920235754e-2 * kDegree, 1e-15);
}

TEST(Roe, AreInvertedExactly) {
  std::mt19937_64 generator(2);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int k = 0; k < 1000; ++k) {
    const QnsElements chief{.a = 7e6 + 3e5 * unit(generator),
                            .ex = 0.1 * unit(generator),
                            .ey = 0.1 * unit(generator),
                            .i = 1.5 + unit(generator),
                            .raan = 3.0 * unit(generator),
                            .u = 100.0 * unit(generator)};
    Vector6 roe;
    for (int j = 0; j < 6; ++j) roe(j) = 0.02 * unit(generator);
    const Vector6 back = roe_from_qns(chief, qns_from_roe(chief, roe));
    ASSERT_LT(accuracy::largest_entry(back - roe), 4e-14);  // rounding of u up to 100 rad
  }
}

TEST(Roe, DoNotJumpWhereAnglesWrap) {
  const QnsElements chief{.a = 7e6, .ex = 0.0, .ey = 0.0, .i = 1.0, .raan = 3.14, .u = -3.14};
  QnsElements deputy = chief;
  deputy.raan = -3.14;  // 0.0032 rad ahead
  deputy.u = 3.14;      // 0.0032 rad behind
  const double gap = math::kTwoPi - 6.28;
  const Vector6 roe = roe_from_qns(chief, deputy);
  EXPECT_NEAR(roe(5), gap * std::sin(1.0), 1e-15);
  EXPECT_NEAR(roe(1), gap * (std::cos(1.0) - 1.0), 1e-15);
  // Small negative values stay small and negative.
  EXPECT_LT(roe(1), 0.0);
}

TEST(LinearMap, DrawsTheSafetyEllipseOfDAmico) {
  // D'Amico 2010, table 2.1: a dey = 400 m, a diy = 200 m.
  QnsElements chief{.a = 7e6, .ex = 0.0, .ey = 0.0, .i = 1.7, .raan = 0.0, .u = 0.0};
  Vector6 roe = Vector6::Zero();
  roe(3) = 400.0 / chief.a;
  roe(5) = 200.0 / chief.a;
  Vector6 rtn = rtn_from_roe_linear(chief, roe);
  EXPECT_NEAR(rtn(0), 0.0, 1e-12);
  EXPECT_NEAR(rtn(1), -800.0, 1e-12);
  EXPECT_NEAR(rtn(2), -200.0, 1e-12);
  chief.u = 90.0 * kDegree;
  rtn = rtn_from_roe_linear(chief, roe);
  EXPECT_NEAR(rtn(0), -400.0, 1e-12);
  EXPECT_NEAR(rtn(1), 0.0, 1e-12);  // cos of a double nearest to 90 deg: 6e-17
  EXPECT_NEAR(rtn(2), 0.0, 1e-12);
}

TEST(LinearMap, OfTheWaypoints) {
  // Linear R, T, N in m at the mission's waypoints, u from the independent program (printed to 1e-3 deg: 1e-5 rad of 1
  // km).
  struct Row {
    std::size_t waypoint;
    double u_deg, r, t, n;
  };
  for (const Row& row : {Row{0, -0.689, -2000.0, -75000.0, 0.0}, Row{1, -130.179, 677.03, -48709.63, 645.18},
                         Row{4, -158.652, 10.921, -944.117, 27.942}, Row{8, -122.379, 1.18906, -7.85795, 0.53551},
                         Row{9, 96.040, 0.10522, -5.01110, 1.98890}, Row{10, 9.062, -0.98752, -8.18498, 0.15751}}) {
    QnsElements chief = mission::kServicerMean;
    chief.u = row.u_deg * kDegree;
    const mission::Waypoint& waypoint = mission::kWaypoints[row.waypoint];
    const Vector6 rtn = rtn_from_roe_linear(chief, waypoint.roe());
    const double size =
        std::hypot(waypoint.a_roe_m[2], waypoint.a_roe_m[3]) + std::hypot(waypoint.a_roe_m[4], waypoint.a_roe_m[5]);
    const double tolerance = 2.0 * 0.5e-3 * kDegree * size + 5e-3 * (row.waypoint < 8 ? 1.0 : 1e-3);
    EXPECT_NEAR(rtn(0), row.r, tolerance) << "waypoint " << row.waypoint;
    EXPECT_NEAR(rtn(1), row.t, tolerance) << "waypoint " << row.waypoint;
    EXPECT_NEAR(rtn(2), row.n, tolerance) << "waypoint " << row.waypoint;
  }
}

TEST(LinearMap, VelocityIsTheRateOfThePosition) {
  QnsElements chief = mission::kServicerMean;
  Vector6 roe;
  roe << 1e-5, -2e-4, 3e-5, -4e-5, 5e-5, 6e-5;
  const double n = mean_motion(chief.a);
  const double h = 1.0;  // s
  const auto at = [&](double t) {
    QnsElements c = chief;
    c.u += n * t;
    Vector6 drifted = roe;
    drifted(1) -= 1.5 * n * t * roe(0);
    return rtn_from_roe_linear(c, drifted);
  };
  const Vector6 rate = (at(h) - at(-h)) / (2.0 * h);
  // Central difference: (n h)^2/6 = 2e-7 of velocities up to 2 m/s.
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(rate(k), at(0.0)(k + 3), 5e-7);
}

TEST(LinearMap, IsInvertedExactly) {
  QnsElements chief = mission::kServicerMean;
  Vector6 roe;
  roe << 1e-5, -2e-4, 3e-5, -4e-5, 5e-5, 6e-5;
  for (double u = -3.0; u < 3.1; u += 0.37) {
    chief.u = u;
    const Vector6 back = roe_from_rtn_linear(chief, rtn_from_roe_linear(chief, roe));
    EXPECT_LT(accuracy::largest_entry(back - roe), 1e-18);  // rounding of 2e-4 and a few of 1e-5 times 4
  }
}

}  // namespace
}  // namespace vbar::fsw::orbit
