#include "fsw/sources/carrier_pair/difference_rows.h"

#include <cmath>

#include <gtest/gtest.h>

#include "fsw/estimation/unscented.h"
#include "fsw/orbit/roe.h"
#include "tests/support/accuracy.h"
#include "tests/unit/fsw/sources/carrier_pair/trunk_pair.h"

namespace vbar::fsw::sources {
namespace {

/// Position at reception in extended precision is not available; that of a first-order map of the inertial state is,
/// where the differences of positions of seven thousand kilometres are metres.
struct Case {
  orbit::CartesianState servicer = navigation::test::servicer_start();
  orbit::QnsElements chief = orbit::qns_from_cartesian(servicer).value();
  Vector6 roe = Vector6(-0.5, 9.0, 3.0, -4.0, 2.0, 1.0) / chief.a;
};

// The Jacobian against that of a step 30 times as large, extrapolated (Richardson): agreement to 1e-9 of a range.
TEST(DifferenceRows, JacobianOfThePositionIsExactTo1e8) {
  const Case c;
  constexpr double kClock_m = 1.5e6;  // 5 ms
  const auto map = reception_map(c.servicer, c.roe, Matrix6::Zero(), kClock_m);
  ASSERT_TRUE(map.ok());
  const auto position = [&](const Vector6& roe) {
    return position_at_reception(orbit::target_from_roe(c.chief, roe).value(), kClock_m);
  };
  for (int k = 0; k < 6; ++k) {
    const auto slope = [&](double step) -> Vector3 {
      return (position(c.roe + step * Vector6::Unit(k)) - position(c.roe - step * Vector6::Unit(k))) / (2.0 * step);
    };
    const Vector3 reference = (4.0 * slope(1.5e-5) - slope(3e-5)) / 3.0;
    EXPECT_LT((map.value().jacobian.col(k) - reference).norm(), 1e-8 * reference.norm()) << k;
  }
}

// A regression over sigma points of a tenth of a millimetre loses digits, which is why it is not used there.
TEST(DifferenceRows, ARegressionOverMillimetresIsLessAccurate) {
  const Case c;
  using Transform = estimation::UnscentedTransform<6>;
  const auto exact = reception_map(c.servicer, c.roe, Matrix6::Zero(), 0.0);
  ASSERT_TRUE(exact.ok());
  for (const double sigma_m : {1e-4, 1e-3, 1e-2, 1.0, 100.0}) {
    Transform transform;
    const double sigma = sigma_m / c.chief.a;
    ASSERT_EQ(transform.start(c.roe, sigma * sigma * Matrix6::Identity()), Status::kOk);
    std::array<Vector3, Transform::kPoints> positions;
    for (std::size_t k = 0; k < Transform::kPoints; ++k) {
      positions[k] = orbit::target_from_roe(c.chief, transform.point(k)).value().position_eci;
    }
    const auto regression = transform.regress<3>(positions);
    const double error = (regression.jacobian - exact.value().jacobian).norm() / exact.value().jacobian.norm();
    if (sigma_m >= 1.0) {
      EXPECT_LT(error, 1e-6) << sigma_m;
    }
    if (sigma_m <= 1e-4) {
      EXPECT_GT(error, 1e-6) << sigma_m;
    }
  }
}

// Beyond 35 m the map is sampled: mean and nonlinearity are those of a second-order expansion. A mean longitude of
// sigma s displaces the target by a s^2 / 2 towards the Earth, and half of its square is that variance's.
TEST(DifferenceRows, AnUncertainOrbitIsSampled) {
  const Case c;
  Matrix6 covariance = 1e-16 * Matrix6::Identity();
  constexpr double kSigma = 1e-4;  // 700 m
  covariance(1, 1) = kSigma * kSigma;
  const auto map = reception_map(c.servicer, c.roe, covariance, 0.0);
  ASSERT_TRUE(map.ok());
  const Vector3 radial = c.servicer.position_eci.normalized();
  const double drop = 0.5 * c.servicer.position_eci.norm() * kSigma * kSigma;
  const Vector3 point = orbit::target_from_roe(c.chief, c.roe).value().position_eci;
  EXPECT_NEAR((map.value().position_eci - point).dot(radial), -drop, 0.02 * drop);
  // E[x^4] - E[x^2]^2 = 2 s^4.
  EXPECT_NEAR(radial.dot(map.value().nonlinearity * radial), 2.0 * drop * drop, 0.1 * drop * drop);
}

TEST(DifferenceRows, ResidualsAndSensitivitiesAreDerivatives) {
  test::FilterPair pair(21);
  pair.fly_trunk(6);
  const gnss::ObservationEpoch ours = pair.servicer.observe(pair.estimator->epoch(), pair.satellites, test::kEarth);
  const gnss::ObservationEpoch theirs = pair.target.observe(pair.estimator->epoch(), pair.satellites, test::kEarth);
  const auto frame = navigation::EarthFrame::at(pair.estimator->epoch(), test::kEarth);
  navigation::DifferentialEpoch epoch;
  navigation::form_differences(ours, theirs, pair.store, frame, epoch);
  const AntennaPlatform servicer{pair.servicer.R_eci_body_at(epoch.time), pair.nominal_antenna_m, 9e4};
  const AntennaPlatform target{pair.target.R_eci_body_at(epoch.time), pair.nominal_antenna_m, -1.35e5};
  DifferenceRows rows, moved;
  ASSERT_EQ(rows.form(epoch, servicer, target, *pair.estimator), Status::kOk);
  ASSERT_GT(epoch.count, 10U);
  using filter::kAt;
  const std::array<int, 11> components = {0,
                                          1,
                                          4,
                                          kAt<ServicerAntenna> + 1,
                                          kAt<TargetAntenna> + 2,
                                          kAt<PhaseCentreJitter>,
                                          kAt<ClockDifference>,
                                          kAt<Ambiguities> + 3,
                                          kAt<CodeBiases>,
                                          kAt<Ionosphere>,
                                          kAt<Ionosphere> + 1};
  for (const int i : components) {
    const double step = i < 6 ? 1.0 / 7e6 : 1.0;
    for (const std::size_t n : {std::size_t{0}, std::size_t{1}, epoch.count - 1}) {
      const auto& o = epoch.observations[n];
      const auto values = [&](const DifferenceRows& of) {
        return std::pair(of.code_residual(n, o, pair.estimator->estimate()),
                         of.phase_residual(n, 3, o, pair.estimator->estimate()));
      };
      const auto before = values(rows);
      pair.estimator->estimate().shift(i, step);
      const auto linear = values(rows);
      ASSERT_EQ(moved.form(epoch, servicer, target, *pair.estimator), Status::kOk);
      const auto exact = values(moved);
      pair.estimator->estimate().shift(i, -step);
      // The residual falls by the sensitivity; the model formed anew differs by curvature: (1 m)^2 / a.
      EXPECT_NEAR(linear.first - before.first, -step * rows.code_sensitivity(n, o.signal)(i), 1e-8) << i;
      EXPECT_NEAR(linear.second - before.second, -step * rows.phase_sensitivity(n, 3, o.signal)(i), 1e-8) << i;
      EXPECT_NEAR(exact.first, linear.first, 3e-7) << i;
      EXPECT_NEAR(exact.second, linear.second, 3e-7) << i;
    }
  }
}

// The ionosphere delays codes and advances phases, by the square of the wavelength: 1.647 as much at L2 as at L1. Of a
// target at the place of the servicer there is hardly a difference.
TEST(DifferenceRows, IonosphereDelaysCodesAndAdvancesPhases) {
  test::FilterPair pair(21);
  pair.fly_trunk(6);
  const gnss::ObservationEpoch ours = pair.servicer.observe(pair.estimator->epoch(), pair.satellites, test::kEarth);
  const gnss::ObservationEpoch theirs = pair.target.observe(pair.estimator->epoch(), pair.satellites, test::kEarth);
  const auto frame = navigation::EarthFrame::at(pair.estimator->epoch(), test::kEarth);
  navigation::DifferentialEpoch epoch;
  navigation::form_differences(ours, theirs, pair.store, frame, epoch);
  const AntennaPlatform platform{pair.servicer.R_eci_body_at(epoch.time), pair.nominal_antenna_m, 0.0};
  constexpr int kVertical = filter::kAt<Ionosphere>;
  const auto chief = orbit::qns_from_cartesian(pair.estimator->servicer()).value();
  filter::RelativeNavigationFilter& filter = *pair.estimator;
  DifferenceRows rows;
  for (const double distance_m : {0.0, 1000.0}) {
    const Vector6 roe = -distance_m / chief.a * Vector6::Unit(1);
    filter.initialize_relative(roe, 1e-20 * Matrix6::Identity(), filter::SolutionStatus::kEstimated);
    ASSERT_EQ(rows.form(epoch, platform, platform, filter), Status::kOk);
    accuracy::Largest largest;
    for (std::size_t n = 0; n < epoch.count; ++n) {
      const double l1 = rows.code_sensitivity(n, gnss::Signal::kGpsL1)(kVertical);
      largest.add(std::abs(l1));
      EXPECT_NEAR(rows.code_sensitivity(n, gnss::Signal::kGpsL2)(kVertical), 1.6469444 * l1, 1e-6 * std::abs(l1));
      EXPECT_EQ(rows.phase_sensitivity(n, 0, gnss::Signal::kGpsL1)(kVertical), -l1);
    }
    // The two signals leave a satellite up to a millisecond apart, which is 2e-7 rad of its path. A kilometre is 1.4e-4
    // rad of the direction of the zenith, and the slant factor rises by up to 30 per radian.
    if (distance_m == 0.0) {
      EXPECT_LT(largest, 1e-5);
    } else {
      EXPECT_GT(largest, 3e-5);
      EXPECT_LT(largest, 5e-3);
    }
  }
}

}  // namespace
}  // namespace vbar::fsw::sources
