// Burns that last in the filter: against the closed form of a constant acceleration in the rotating frame (Clohessy and
// Wiltshire 1960), and by what the parts of a burn between measurements must sum to.

#include "fsw/orbit/finite_burn.h"

#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/filter/relative_navigation_filter.h"
#include "fsw/orbit/rtn.h"
#include "tests/support/figures.h"
#include "tests/unit/fsw/measurements/angles_only_scene.h"

namespace vbar::fsw::filter {
namespace {

using namespace measurements::test;

constexpr double kDuration_s = 360.0;
constexpr double kBegin_s = 100.0;
const Vector3 kDv_rtn(0.05, 0.2, -0.1);
const Vector6 kRoe = roe_of_metres(-87.0, -20000.0, 30.0, 600.0, -20.0, 600.0);

GpsTime at(double s) {
  return scene_start() + nearest_duration(s);
}

Burn burn() {
  return {.time = at(kBegin_s + 0.5 * kDuration_s), .dv_rtn = kDv_rtn, .duration = nearest_duration(kDuration_s)};
}

FilterSettings quiet(double sigma, double sigma_relative) {
  FilterSettings settings;
  settings.earth = scene_earth();
  settings.burn_sigma = sigma;
  settings.burn_sigma_relative = sigma_relative;
  settings.absolute_orbit.acceleration_psd = 0.0;
  settings.relative_orbit.acceleration = {.psd = 1e-30, .psd_min = 1e-30, .psd_max = 1e-30};
  settings.relative_orbit.drag.sigma = 1e-15;
  settings.relative_orbit.from_sun.sigma = 1e-15;
  return settings;
}

std::unique_ptr<RelativeNavigationFilter> filter_with(const FilterSettings& settings) {
  auto filter = std::make_unique<RelativeNavigationFilter>();
  filter->configure(settings);
  filter->advance_to(scene_start(), {});
  filter->set_states(scene_servicer(), scene_target(scene_servicer(), kRoe));
  return filter;
}

/// Advances as if a measurement came every `period_s`.
std::unique_ptr<RelativeNavigationFilter> flown(const FilterSettings& settings, double until_s, double period_s,
                                                const std::vector<Burn>& burns) {
  auto filter = filter_with(settings);
  for (double s = period_s; s < until_s; s += period_s) filter->advance_to(at(s), burns);
  filter->advance_to(at(until_s), burns);
  return filter;
}

/// Position from where it would be without the acceleration, in its rotating RTN, `t` s after the begin.
Vector3 closed_form(const Vector3& a, double n, double t) {
  const double c = std::cos(n * t), s = std::sin(n * t);
  return {a.x() / (n * n) * (1 - c) + 2 * a.y() / (n * n) * (n * t - s),
          -2 * a.x() / (n * n) * (n * t - s) + a.y() * (4 / (n * n) * (1 - c) - 1.5 * t * t),
          a.z() / (n * n) * (1 - c)};
}

TEST(FiniteBurn, FollowsTheClosedFormOfAConstantAcceleration) {
  const double n = orbit::mean_motion(kA);
  accuracy::Largest largest;
  for (const double t : {60.0, 0.5 * kDuration_s, kDuration_s}) {
    const auto with = flown(quiet(0, 0), kBegin_s + t, 45.0, {burn()});
    const auto without = flown(quiet(0, 0), kBegin_s + t, 45.0, {});
    const Vector3 moved = orbit::relative_state_rtn(without->servicer(), with->servicer()).position_rtn;
    const Vector3 expected = closed_form(kDv_rtn / kDuration_s, n, t);
    largest.add((moved - expected).norm() / expected.norm());
    // The target does not feel it.
    EXPECT_LT((with->target().value().position_eci - without->target().value().position_eci).norm(), 1e-3);
  }
  // An orbit with an eccentricity of 1.5e-3, and oblateness: some 3e-3 of the motion. As an impulse at its middle the
  // burn would be wrong by all of it until then.
  EXPECT_LT(largest, 5e-3);
}

TEST(FiniteBurn, IsTheSameHoweverMeasurementsDivideIt) {
  constexpr double kUntil_s = kBegin_s + kDuration_s + 200.0;
  const auto whole = flown(quiet(1e-5, 3e-3), kUntil_s, kUntil_s, {burn()});
  // By the burn alone: the truncation of the integration, centimetres, differs with the steps, which begin and end of
  // the burn divide once more.
  const auto moved = [&](const RelativeNavigationFilter& with, double period_s) {
    const auto without = flown(quiet(1e-5, 3e-3), kUntil_s, period_s, {});
    return Vector3(with.servicer().position_eci - without->servicer().position_eci);
  };
  const Vector3 expected = moved(*whole, kUntil_s);
  for (const double period_s : {7.0, 60.0, 110.0}) {
    const auto parts = flown(quiet(1e-5, 3e-3), kUntil_s, period_s, {burn()});
    EXPECT_LT((moved(*parts, period_s) - expected).norm(), 1e-3) << period_s;
    EXPECT_LT(kA * (parts->roe() - whole->roe()).norm(), 1e-3) << period_s;
    // The noise is mapped by Gamma of a near-circular orbit: twice the eccentricity of 1.5e-3, and rounding.
    for (int k = 0; k < 6; ++k) {
      EXPECT_NEAR(parts->roe_covariance()(k, k), whole->roe_covariance()(k, k), 4e-3 * whole->roe_covariance()(k, k));
    }
  }
}

/// sigma of the whole burn, per axis: a da changes by 2/n times the transverse one, a dix and a diy together by 1/n
/// times the normal one, and the velocity of the servicer by the same.
TEST(FiniteBurn, IsAsUncertainAsItsExecution) {
  constexpr double kUntil_s = kBegin_s + kDuration_s;
  const double sigma = 2e-5 + 3e-3 * kDv_rtn.norm();
  const auto with = flown(quiet(2e-5, 3e-3), kUntil_s, 60.0, {burn()});
  const auto without = flown(quiet(2e-5, 3e-3), kUntil_s, 60.0, {});
  const double n = orbit::mean_motion(kA);
  const Matrix6 added = kA * kA * (with->roe_covariance() - without->roe_covariance());
  EXPECT_NEAR(std::sqrt(added(0, 0)), 2.0 / n * sigma, 0.01 * 2.0 / n * sigma);
  EXPECT_NEAR(std::sqrt(added(4, 4) + added(5, 5)), sigma / n, 0.01 * sigma / n);
  const Matrix6 of_servicer = with->absolute_orbit().covariance() - without->absolute_orbit().covariance();
  // Gravity gradients change it by (n t)^2 / 3 at most: 4 % of the variance.
  EXPECT_NEAR(of_servicer.diagonal().tail<3>().sum(), 3.0 * sigma * sigma, 0.05 * 3.0 * sigma * sigma);
}

TEST(FiniteBurn, HalfWayThroughHasHalfItsVariance) {
  const double sigma = 3e-3 * kDv_rtn.norm();
  const auto with = flown(quiet(0.0, 3e-3), kBegin_s + 0.5 * kDuration_s, 60.0, {burn()});
  const auto without = flown(quiet(0.0, 3e-3), kBegin_s + 0.5 * kDuration_s, 60.0, {});
  const double n = orbit::mean_motion(kA);
  const double added = kA * kA * (with->roe_covariance()(0, 0) - without->roe_covariance()(0, 0));
  EXPECT_NEAR(added, 0.5 * 4.0 / (n * n) * sigma * sigma, 0.01 * 4.0 / (n * n) * sigma * sigma);
}

/// Sources that begin with a batch of bearings, or track an object from image to image, count on these.
TEST(FiniteBurn, IsNotedAsImpulsesThatSumToIt) {
  const auto filter = flown(quiet(0, 0), 600.0, 60.0, {burn()});
  Vector3 sum = Vector3::Zero();
  for (const Impulse& impulse : filter->impulses()) {
    sum += impulse.dv_rtn;
    EXPECT_GT(impulse.time, at(kBegin_s));
    EXPECT_LT(impulse.time, at(kBegin_s + kDuration_s));
    EXPECT_NEAR(impulse.dv_eci.norm(), impulse.dv_rtn.norm(), 1e-3 * impulse.dv_rtn.norm());
  }
  EXPECT_EQ(filter->impulses().size(), 7u);
  EXPECT_LT((sum - kDv_rtn).norm(), 1e-12);
}

/// An impulse is in the RTN before it, a burn in that which its own change of velocity turns: by dv/v at its end, half
/// of it in the mean. That share of 0.23 m/s is 3.5 um/s, 1.1 mm after 320 s, and 2/n of it in the elements.
TEST(FiniteBurn, IsAnImpulseInTheLimit) {
  Burn impulse = burn();
  impulse.duration = {};
  Burn shortest = burn();
  shortest.duration = Duration{1000};
  const auto a = flown(quiet(1e-5, 3e-3), 600.0, 45.0, {impulse});
  const auto b = flown(quiet(1e-5, 3e-3), 600.0, 45.0, {shortest});
  const double turned = 0.5 * kDv_rtn.squaredNorm() / a->servicer().velocity_eci.norm();
  EXPECT_LT((a->servicer().position_eci - b->servicer().position_eci).norm(), 320.0 * turned);
  EXPECT_LT(kA * (a->roe() - b->roe()).norm(), 2.0 / orbit::mean_motion(kA) * turned);
  for (int k = 0; k < 6; ++k) {
    EXPECT_NEAR(a->roe_covariance()(k, k), b->roe_covariance()(k, k), 5e-3 * a->roe_covariance()(k, k));
  }
}

/// 40 % flown as commanded, the rest such that the sum is what the report says.
TEST(FiniteBurn, AReportChangesWhatIsLeft) {
  Burn reported = burn();
  reported.dv_rtn *= 0.98;
  const GpsTime epoch = at(kBegin_s + 0.4 * kDuration_s);
  const Burn rest = as_reported(burn(), reported, epoch);
  EXPECT_LT((0.4 * kDv_rtn + 0.6 * rest.dv_rtn - reported.dv_rtn).norm(), 1e-12);
  EXPECT_EQ(rest.time, reported.time);
  EXPECT_EQ(as_reported(burn(), reported, at(kBegin_s)).dv_rtn, reported.dv_rtn);
}

TEST(FiniteBurn, LastsItsDeltaVOverTheAcceleration) {
  EXPECT_EQ(orbit::burn_duration(0.2, 0.02 / 30.0).ns, nearest_duration(300.0).ns);
  EXPECT_EQ(orbit::burn_duration(0.2, 0.0).ns, 0);
  EXPECT_EQ(orbit::burn_duration(1e300, 1e-7).ns, nearest_duration(orbit::kLongestBurn_s).ns);
}

}  // namespace
}  // namespace vbar::fsw::filter
