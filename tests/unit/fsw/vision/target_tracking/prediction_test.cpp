// Slopes, their rates and covariances, against finite differences and true orbits.

#include "fsw/vision/target_tracking/prediction.h"

#include <limits>

#include <gtest/gtest.h>

#include "fsw/math/math.h"
#include "fsw/orbit/mean_osculating.h"
#include "fsw/orbit/propagate.h"
#include "fsw/vision/target_tracking/relative_motion.h"
#include "tests/support/figures.h"
#include "tests/unit/fsw/orbit/mission.h"
#include "tests/unit/fsw/vision/target_tracking/scene.h"

namespace {

using namespace vbar::fsw;
using namespace vbar::fsw::target_tracking;
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

// The hypotheses' equations of motion against true motion (20x20 gravity), not against themselves.

namespace {

using namespace vbar::testing;

constexpr double kArcsec = math::kDegree / 3600.0;

Vector6 six(double a, double b, double c, double d, double e, double f) {
  Vector6 v;
  v << a, b, c, d, e, f;
  return v;
}

SceneSettings exact_scene(const Vector6& a_roe_m) {
  SceneSettings settings;
  settings.target_a_roe_m = a_roe_m;
  settings.sigma_a_roe_m = 1e-6 * a_roe_m.cwiseAbs().array() + 1e-3;
  settings.noise_arcsec = 1e-3;
  settings.jitter_arcsec = 0.0;
  settings.false_detections = 0.0;
  settings.hot_pixels = 0;
  settings.detection_probability = 1.0;
  return settings;
}

/// A filter that is fed with a scene's bearings.
struct Follower {
  explicit Follower(const SceneSettings& of) : maker(of), motion(unknown_motion(settings)) {}

  /// One image on; uses the bearing only if told to.
  void step(bool sees) {
    const GpsTime before = scene.time;
    scene = maker.next();
    view = servicer_view(scene.servicer).value();
    GpsTime now = before;
    if (!is_first) {
      for (const OwnBurn& burn : scene.burns) {
        ASSERT_TRUE(propagate(motion, view, seconds(burn.time - now), settings));
        apply_burn(motion, burn, view.latitude - view.latitude_rate * seconds(scene.time - burn.time), view,
                   scene.prediction, settings);
        now = burn.time;
      }
      ASSERT_TRUE(propagate(motion, view, seconds(scene.time - now), settings));
    }
    is_first = false;
    bend = -0.5 * scene.target.position_rtn.y() / view.semi_major_axis;
    bend_rate = -0.5 * scene.target.velocity_rtn.y() / view.semi_major_axis;
    if (!sees) return;
    const Candidate& target = scene.candidates.at(static_cast<std::size_t>(scene.target_index()));
    const SlopeMeasurement measurement = slope_measurement(target.direction_rtn, target.sigma, settings).value();
    update(motion, innovation_of(motion, view, bend, measurement));
  }

  /// Expected minus true slopes and rates.
  Vector5 error() const {
    return slope_state(motion, view, bend, bend_rate).slopes -
           prediction_of(scene.target, Matrix6::Zero()).value().slopes;
  }

  /// Of it, in sigmas: chi-square with 5 degrees of freedom.
  double distance() const {
    return slope_distance(error(), slope_state(motion, view, bend, bend_rate).covariance, {1e-7, 1e-9}).square;
  }

  MotionSettings settings;
  SceneMaker maker;
  RelativeMotion motion;
  Scene scene;
  ServicerView view;
  double bend = 0.0;
  double bend_rate = 0.0;
  bool is_first = true;
};

struct Motion {
  Vector6 a_roe_m;
  double coast_arcsec;  ///< allowed after 34 minutes
  double rate_arcsec;   ///< a second, allowed
};

class Ranges : public ::testing::TestWithParam<Motion> {};

// Bearings without noise leave the equations' own errors: terms of the order of the eccentricity, 1e-3, of the angles.
TEST_P(Ranges, FollowsTrueMotionAndCoastsThroughAnEclipse) {
  Follower follower(exact_scene(GetParam().a_roe_m));
  for (int k = 0; k < 100; ++k) follower.step(true);
  EXPECT_LT(vbar::accuracy::largest_entry(follower.error().head<2>()), 5.0 * kArcsec);
  EXPECT_LT(vbar::accuracy::largest_entry(follower.error().tail<3>()), GetParam().rate_arcsec * kArcsec);
  for (int k = 0; k < 34; ++k) follower.step(false);
  EXPECT_LT(vbar::accuracy::largest_entry(follower.error().head<2>()), GetParam().coast_arcsec * kArcsec);
  EXPECT_LT(follower.distance(), 20.5);  // 99.9 % of chi-square, 5 degrees of freedom
}

INSTANTIATE_TEST_SUITE_P(Mission, Ranges,
                         ::testing::Values(Motion{six(-2000.0, -75000.0, 0.0, 0.0, 0.0, 0.0), 20.0, 0.04},
                                           Motion{six(-87.0, -50000.0, 0.0, 1000.0, 0.0, 1000.0), 20.0, 0.04},
                                           // The angles are ten times as large here.
                                           Motion{six(-17.0, -5000.0, 0.0, 500.0, 0.0, 500.0), 100.0, 0.08},
                                           Motion{six(0.0, -1000.0, 0.0, 30.0, 0.0, 30.0), 20.0, 0.04},
                                           Motion{six(0.0, -100.0, 0.0, 3.0, 0.0, 3.0), 20.0, 0.04}));

// 0.6 m/s turn the bearing by a degree in half an hour.
TEST(RelativeMotion, KnowsWhatABurnDoes) {
  SceneSettings scene = exact_scene(six(-87.0, -50000.0, 0.0, 1000.0, 0.0, 1000.0));
  scene.burn_error = 0.0;
  const auto error_after = [](const SceneSettings& settings) {
    Follower follower(settings);
    for (int k = 0; k < 100; ++k) follower.step(true);
    for (int k = 0; k < 30; ++k) follower.step(false);
    return follower.error().head<2>().norm();
  };
  scene.burns = {{5970.0, Vector3(0.2, -0.5, 0.3)}};
  EXPECT_LT(error_after(scene), 40.0 * kArcsec);  // 1 % of what it does: the eccentricity, and the current distance
}

}  // namespace
