// The hypotheses' equations of motion against true motion (20x20 gravity), not against themselves.

#include "fsw/tracking/relative_motion.h"

#include <gtest/gtest.h>

#include "fsw/math/math.h"
#include "tests/support/figures.h"
#include "tests/unit/fsw/tracking/scene.h"

namespace {

using namespace vbar::fsw;
using namespace vbar::fsw::tracking;
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
