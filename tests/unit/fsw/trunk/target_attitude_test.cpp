#include "fsw/trunk/target_attitude.h"

#include <memory>

#include <gtest/gtest.h>

#include "fsw/trunk/trunk.h"
#include "tests/unit/fsw/navigation/angles_only_scene.h"

namespace vbar::fsw::filter {
namespace {

using namespace navigation::test;

constexpr double kTurnSigma = 1e-3;
constexpr double kRateSigma = 1e-5;

/// A filter at the start of the scene with a target that does not rotate; its inertia is a sphere's: no torque.
std::unique_ptr<RelativeNavigationFilter> filter_with(const FilterSettings& settings) {
  auto filter = std::make_unique<RelativeNavigationFilter>();
  filter->configure(settings);
  filter->advance_to(scene_start(), {});
  const Vector6 roe = roe_of_metres(0.0, -10.0, 0.0, 0.0, 0.0, 0.0);
  filter->set_states(scene_servicer(), scene_target(scene_servicer(), roe));
  Vector6 variance;
  variance.head<3>().setConstant(kTurnSigma * kTurnSigma);
  variance.tail<3>().setConstant(kRateSigma * kRateSigma);
  filter->initialize_attitude({}, variance.asDiagonal());
  return filter;
}

/// Double integrator with white angular acceleration: rate variance q t, rotation variance q t^3 / 3.
void expect_growth(const FilterSettings& settings, double psd) {
  const auto filter = filter_with(settings);
  constexpr double kCoast_s = 600.0;
  filter->advance_to(scene_start() + duration_of_seconds(static_cast<std::int64_t>(kCoast_s)), {});
  const Matrix6 covariance = attitude_covariance(filter->estimate());
  const double rate = kRateSigma * kRateSigma + psd * kCoast_s;
  const double turn = kTurnSigma * kTurnSigma + kRateSigma * kRateSigma * kCoast_s * kCoast_s +
                      psd * kCoast_s * kCoast_s * kCoast_s / 3.0;
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(covariance(3 + axis, 3 + axis) / rate, 1.0, 0.01) << psd;
    EXPECT_NEAR(covariance(axis, axis) / turn, 1.0, 0.01) << psd;
  }
}

TEST(TargetAttitude, ProcessNoiseIsThatOfTheSettings) {
  FilterSettings settings;
  expect_growth(settings, 1e-11);  // as by default
  settings.attitude.angular_acceleration = {.psd = 3e-12, .psd_min = 1e-12, .psd_max = 1e-11};
  expect_growth(settings, 3e-12);
}

TEST(TargetAttitude, SettingsOfOtherBlocksKeepTheAdaptedNoise) {
  FilterSettings settings;
  const auto filter = filter_with(settings);
  navigation::AdaptiveNoise& noise = filter->attitude().noise();
  for (int k = 0; k <= navigation::AdaptiveNoise::kWindow; ++k) noise.add(Vector2::Constant(k % 2 == 0 ? 1.0 : -1.0));
  const double adapted = noise.psd();
  EXPECT_LT(adapted, settings.attitude.angular_acceleration.psd);
  settings.burn_sigma *= 2.0;
  filter->configure(settings);
  EXPECT_EQ(filter->attitude().noise().psd(), adapted);
}

}  // namespace
}  // namespace vbar::fsw::filter
