// Slopes, their rates and covariances, against finite differences and true orbits.

#include "fsw/tracking/prediction.h"

#include <limits>

#include <gtest/gtest.h>

#include "fsw/math/math.h"
#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/propagate.h"
#include "fsw/tracking/servicer_view.h"
#include "tests/support/figures.h"
#include "tests/unit/fsw/orbit/mission.h"

namespace {

using namespace vbar::fsw;
using namespace vbar::fsw::tracking;
namespace mission = vbar::fsw::orbit::mission;

orbit::RelativeState some_state() {
  return {Vector3(-350.0, -4800.0, 220.0), Vector3(0.31, -0.52, 0.17)};
}

Vector2 slopes_at(const orbit::RelativeState& state, double t) {
  const Vector3 p = state.position_rtn + t * state.velocity_rtn;
  return Vector2(p.x() / p.y(), p.z() / p.y());
}

Vector5 slopes_and_rates(const orbit::RelativeState& state) {
  constexpr double kStep = 1.0;  // s: third-order error 1e-12
  const auto log_distance = [&state](double t) {
    return math::log(math::abs(state.position_rtn.y() + t * state.velocity_rtn.y()));
  };
  Vector5 all;
  all << slopes_at(state, 0.0), (slopes_at(state, kStep) - slopes_at(state, -kStep)) / (2.0 * kStep),
      (log_distance(kStep) - log_distance(-kStep)) / (2.0 * kStep);
  return all;
}

TEST(Prediction, HasTheSlopesOfTheStateAndTheirRates) {
  const Prediction prediction = prediction_of(some_state(), Matrix6::Identity()).value();
  EXPECT_LT(vbar::accuracy::largest_entry(prediction.slopes - slopes_and_rates(some_state())), 1e-11);
  EXPECT_EQ(prediction.along_track_m, -4800.0);
  EXPECT_EQ(prediction.along_track_rate, -0.52);
  EXPECT_NEAR(prediction.along_track_sigma_fraction, 1.0 / 4800.0, 1e-15);
}

TEST(Prediction, HasTheCovarianceOfNumericalDerivatives) {
  Matrix6 root = Matrix6::Zero();
  for (int k = 0; k < 6; ++k) {
    for (int c = 0; c <= k; ++c) root(k, c) = (k == c ? 1.0 : 0.3 / (1 + k + c)) * (k < 3 ? 10.0 : 0.01);
  }
  const Matrix6 covariance = root * root.transpose();
  Eigen::Matrix<double, 5, 6> jacobian;
  for (int k = 0; k < 6; ++k) {
    orbit::RelativeState plus = some_state();
    orbit::RelativeState minus = some_state();
    const double step = k < 3 ? 0.1 : 1e-3;
    (k < 3 ? plus.position_rtn[k] : plus.velocity_rtn[k - 3]) += step;
    (k < 3 ? minus.position_rtn[k] : minus.velocity_rtn[k - 3]) -= step;
    jacobian.col(k) = (slopes_and_rates(plus) - slopes_and_rates(minus)) / (2.0 * step);
  }
  const Matrix5 expected = jacobian * covariance * jacobian.transpose();
  const Matrix5 got = prediction_of(some_state(), covariance).value().covariance;
  for (int r = 0; r < 5; ++r) {
    // Differences of differences: seven digits remain.
    for (int c = 0; c < 5; ++c) {
      EXPECT_NEAR(got(r, c), expected(r, c), 1e-6 * math::sqrt(expected(r, r) * expected(c, c))) << r << c;
    }
  }
}

TEST(Prediction, OfABearingHasItsAnglesAndNoRates) {
  constexpr double kSigma = 1e-3;
  const Prediction prediction =
      prediction_of(Vector3(0.03, -1.0, -0.02).normalized(), Matrix2::Identity() * kSigma * kSigma, -75e3).value();
  EXPECT_NEAR(prediction.slopes[0], -0.03, 1e-15);
  EXPECT_NEAR(prediction.slopes[1], 0.02, 1e-15);
  EXPECT_NEAR(prediction.covariance(0, 0), kSigma * kSigma, 3e-9);
  EXPECT_GT(prediction.covariance(2, 2), 1e-5);
}

TEST(Prediction, RefusesWhatIsNotInFrontOrBehind) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(prediction_of({Vector3(100.0, 10.0, 0.0), Vector3::Zero()}, Matrix6::Identity()).status(),
            Status::kOutOfRange);
  EXPECT_EQ(prediction_of({Vector3(nan, 10.0, 0.0), Vector3::Zero()}, Matrix6::Identity()).status(),
            Status::kNotFinite);
  EXPECT_EQ(prediction_of({Vector3(0.0, 10.0, 0.0), Vector3(0.0, nan, 0.0)}, Matrix6::Identity()).status(),
            Status::kNotFinite);
  EXPECT_EQ(prediction_of(some_state(), -Matrix6::Identity()).status(), Status::kOutOfRange);
  EXPECT_EQ(prediction_of(Vector3::UnitX(), Matrix2::Identity(), 0.0).status(), Status::kOutOfRange);
  EXPECT_EQ(slopes_of(Vector3::Zero()).status(), Status::kOutOfRange);
}

// J2 does not depend on time, so that a target may be where the servicer was a moment ago: 1 km behind. It is seen
// along the path, bent by half its distance over the radius.
TEST(ServicerView, ThePathIsWhereATargetOnTheSameOrbitIsSeen) {
  for (int k = 0; k < 24; ++k) {
    orbit::QnsElements elements = mission::kServicerOsculating;
    elements.u += k * math::kPi / 12.0;
    const orbit::CartesianState servicer = orbit::cartesian_from_qns(elements).value();
    const Vector3 target =
        orbit::relative_state_rtn(servicer, orbit::propagate_j2(servicer, -1000.0 / 7500.0).value()).position_rtn;
    const ServicerView view = servicer_view(servicer).value();
    const double bend = -0.5 * target.y() / view.semi_major_axis;
    // The bend is 7e-5, and its radius of curvature is the semi-major axis to twice the eccentricity, 0.3 %.
    EXPECT_NEAR(target.x() / target.y(), view.path_slope + bend, 3e-7) << k;
    EXPECT_NEAR(target.z() / target.y(), 0.0, 3e-7) << k;
  }
}

// The distance to a follower on the same orbit changes as the speed does along the orbit.
TEST(ServicerView, ThePathStretchesTheDistanceOfATargetOnTheSameOrbit) {
  for (int k = 0; k < 24; ++k) {
    orbit::QnsElements elements = mission::kServicerOsculating;
    elements.u += k * math::kPi / 12.0;
    const orbit::CartesianState servicer = orbit::cartesian_from_qns(elements).value();
    const orbit::RelativeState target =
        orbit::relative_state_rtn(servicer, orbit::propagate_j2(servicer, -1000.0 / 7500.0).value());
    // The rate is up to 2e-6 1/s; over half a kilometre it changes by the part 1e-4 of it.
    EXPECT_NEAR(target.velocity_rtn.y() / target.position_rtn.y(), servicer_view(servicer).value().path_stretch_rate,
                1e-9)
        << k;
  }
}

// The mean orbit of the mission drifts by 1.58571e-3 m/s per metre (docs of the algorithms, two orbits propagated with
// their secular rates), at any place of the orbit.
TEST(ServicerView, TheDriftIsThatOfTheMeanOrbit) {
  const orbit::QnsElements mean = orbit::mean_from_osculating(mission::kServicerOsculating).value();
  for (int k = 0; k < 12; ++k) {
    orbit::QnsElements elements = mean;
    elements.u += k * math::kPi / 6.0;
    const orbit::CartesianState servicer =
        orbit::cartesian_from_qns(orbit::osculating_from_mean(elements).value()).value();
    EXPECT_NEAR(servicer_view(servicer).value().drift_rate, 1.58571e-3, 1e-8) << k;
  }
}

TEST(ServicerView, RatesAreThoseOfTheMotion) {
  const orbit::CartesianState servicer = orbit::cartesian_from_qns(mission::kServicerOsculating).value();
  constexpr double kStep = 2.0;
  const ServicerView now = servicer_view(servicer).value();
  const ServicerView before = servicer_view(orbit::propagate_j2(servicer, -kStep).value()).value();
  const ServicerView after = servicer_view(orbit::propagate_j2(servicer, kStep).value()).value();
  // A parabola's error: third derivatives of the order n^3, times step^2 / 6.
  EXPECT_NEAR(now.path_slope_rate, (after.path_slope - before.path_slope) / (2.0 * kStep), 1e-10);
  // The node turns as well, by some 1e-6 of the rate.
  EXPECT_NEAR(now.latitude_rate, (after.latitude - before.latitude) / (2.0 * kStep), 1e-8);
  EXPECT_EQ(servicer_view({}).ok(), false);
}

}  // namespace
