#include "fsw/navigation/angles_only_navigation.h"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/orbit/rtn.h"
#include "tests/unit/fsw/navigation/angles_only_scene.h"

namespace vbar::fsw::navigation {
namespace {

using namespace test;

constexpr double kSigma = 12.0 * kArcsec;

/// A pair under the on-board gravity, and navigation that watches.
class Watched : public testing::Test {
 protected:
  Watched() {
    AnglesOnlySettings settings;
    settings.earth = scene_earth();
    settings.batch.bearings = 30;
    navigation = std::make_unique<AnglesOnlyNavigation>(settings);
    servicer = scene_servicer();
    target = scene_target(servicer, roe_of_metres(-300.0, -20000.0, 0.0, 500.0, 0.0, 500.0));
    TargetApriori apriori;
    apriori.time = now;
    apriori.target = scene_target(servicer, roe_of_metres(-310.0, -20300.0, 80.0, 400.0, -60.0, 450.0));
    apriori.sigma_a_roe_m << 30.0, 500.0, 100.0, 100.0, 100.0, 100.0;
    navigation->set_apriori(apriori);
  }

  /// A minute on, through the burns within.
  void move() {
    const GpsTime next = now + duration_of_seconds(60);
    target = Propagation(now, scene_earth(), scene_sun()).coast(target, 60.0);
    for (const Burn& burn : burns) {
      if (burn.time < now || burn.time >= next) continue;
      servicer = Propagation(now, scene_earth(), scene_sun()).coast(servicer, seconds(burn.time - now));
      servicer = orbit::apply_impulse_rtn(servicer, burn.dv_rtn);
      now = burn.time;
    }
    servicer = Propagation(now, scene_earth(), scene_sun()).coast(servicer, seconds(next - now));
    now = next;
  }

  AnglesOnlyEpoch epoch(bool has_bearing = true, bool has_gnss = true) {
    AnglesOnlyEpoch result;
    result.time = now;
    result.sun_eci = scene_sun();
    if (has_gnss) {
      result.servicer_gnss = servicer;
      for (int axis = 0; axis < 3; ++axis) result.servicer_gnss->position_eci(axis) += noise.normal();
    }
    if (has_bearing) result.bearing = bearing_of(now, servicer, target, kSigma, kSigma * noise.normal2());
    return result;
  }

  void watch(int minutes, bool has_bearing = true) {
    for (int k = 0; k < minutes; ++k) {
      navigation->update(epoch(has_bearing), burns);
      move();
    }
  }

  double error() const {
    const auto estimated = orbit::relative_state_rtn(navigation->servicer(), navigation->target().value());
    // The truth has moved on by a minute since the last epoch.
    const Propagation back(now, scene_earth(), scene_sun());
    const auto truth = orbit::relative_state_rtn(back.coast(servicer, -60.0), back.coast(target, -60.0));
    return (estimated.position_rtn - truth.position_rtn).norm();
  }
  double sigma() const {
    const Matrix6 covariance = navigation->covariance_rtn();
    return std::sqrt(covariance.topLeftCorner<3, 3>().trace());
  }

  GpsTime now = scene_start();
  orbit::CartesianState servicer, target;
  std::vector<Burn> burns;
  Noise noise{11};
  std::unique_ptr<AnglesOnlyNavigation> navigation;
};

TEST_F(Watched, FirstPointsByWhatWasKnownThenByTheBatchThenByTheFilter) {
  EXPECT_FALSE(navigation->has_target());
  EXPECT_EQ(navigation->predict(now, Vector3::Zero(), scene_sun(), {}).status(), Status::kNotReady);
  EXPECT_EQ(navigation->update(epoch(false), burns), BearingEditStatus::kNone);
  EXPECT_TRUE(navigation->has_target());
  EXPECT_FALSE(navigation->valid());
  const auto prediction = navigation->predict(now, Vector3::Zero(), scene_sun(), {});
  ASSERT_TRUE(prediction.ok());
  // 100 m at 20 km.
  EXPECT_NEAR(std::sqrt(prediction.value().covariance(1, 1)), 100.0 / 20300.0, 0.3 * 100.0 / 20300.0);
  move();
  for (int k = 0; k < 29; ++k, move()) EXPECT_EQ(navigation->update(epoch(), burns), BearingEditStatus::kBatch);
  EXPECT_FALSE(navigation->valid());
  EXPECT_EQ(navigation->update(epoch(), burns), BearingEditStatus::kBatch);
  EXPECT_TRUE(navigation->valid());
  move();
  EXPECT_EQ(navigation->update(epoch(), burns), BearingEditStatus::kFilter);
  EXPECT_EQ(navigation->last_bearing(), now);
  EXPECT_NEAR(navigation->counters().bearings_used, 31, 1);
  move();
  EXPECT_LT(error(), 4.0 * sigma());
}

TEST_F(Watched, ABurnTellsTheRange) {
  watch(100);
  const double before = sigma();
  burns.push_back({now + duration_of_seconds(20), {0.0, 0.1, 0.1}});
  watch(100);
  EXPECT_LT(sigma(), 0.25 * before);
  EXPECT_LT(error(), 4.0 * sigma());
}

TEST_F(Watched, LooksAheadThroughABurnThatItWillFly) {
  watch(60);
  const GpsTime epoch_time = navigation->epoch();
  burns.push_back({now + duration_of_seconds(30), {0.0, 0.2, -0.1}});
  const GpsTime then = epoch_time + duration_of_seconds(600);
  const auto prediction = navigation->predict(then, Vector3::Zero(), scene_sun(), burns);
  ASSERT_TRUE(prediction.ok());
  EXPECT_EQ(navigation->epoch(), epoch_time);  // looking ahead moves nothing
  while (now < then) move();
  const Vector3 seen = (target.position_eci - servicer.position_eci).normalized();
  const Vector2 miss = bearing_axes(prediction.value().direction_eci, servicer).topRows<2>() * seen;
  for (int axis = 0; axis < 2; ++axis) {
    EXPECT_LT(std::abs(miss(axis)), 4.0 * std::sqrt(prediction.value().covariance(axis, axis)));
  }
  EXPECT_LT(miss.norm(), 1e-3);  // the burn turns it by five times that: 90 m at 20 km
  EXPECT_EQ(navigation->predict(epoch_time - duration_of_seconds(1), Vector3::Zero(), scene_sun(), {}).status(),
            Status::kOutOfRange);
}

TEST_F(Watched, CoastsThroughAnEclipseAndAReceiverThatIsSilent) {
  watch(90);
  for (int k = 0; k < 35; ++k, move()) navigation->update(epoch(false, false), burns);
  EXPECT_TRUE(navigation->valid());
  EXPECT_LT(error(), 4.0 * sigma());
  watch(30);
  EXPECT_EQ(navigation->counters().bearings_refused, 0);
  EXPECT_LT(error(), 4.0 * sigma());
}

TEST_F(Watched, ABurnNobodyToldOfIsRefusedThenBelieved) {
  watch(120);
  servicer = orbit::apply_impulse_rtn(servicer, {0.02, -0.05, 0.05});
  watch(240);
  const AnglesOnlyCounters& counters = navigation->counters();
  EXPECT_GT(counters.bearings_refused, 0);
  EXPECT_GT(counters.inflations + counters.restarts, 0);
  EXPECT_TRUE(navigation->valid());
  // Right again by its own account, and on the target: a bearing is worth 1.2 m here.
  EXPECT_LT(error(), 4.0 * sigma());
  EXPECT_EQ(navigation->update(epoch(), burns), BearingEditStatus::kFilter);
}

TEST_F(Watched, WhatComesLateIsIgnored) {
  watch(60);
  const Vector6 roe = navigation->filter().roe();
  AnglesOnlyEpoch late = epoch();
  late.time = navigation->epoch() - duration_of_seconds(1);
  late.bearing->time = late.time;
  EXPECT_EQ(navigation->update(late, burns), BearingEditStatus::kNone);
  EXPECT_EQ(navigation->filter().roe(), roe);
}

TEST_F(Watched, StartsAnewWhenToldTo) {
  watch(60);
  TargetApriori apriori;
  apriori.time = now;
  apriori.target = target;
  apriori.sigma_a_roe_m << 30.0, 500.0, 100.0, 100.0, 100.0, 100.0;
  navigation->set_apriori(apriori);
  EXPECT_FALSE(navigation->valid());
  watch(40);
  EXPECT_TRUE(navigation->valid());
  EXPECT_LT(error(), 4.0 * sigma());
}

}  // namespace
}  // namespace vbar::fsw::navigation
