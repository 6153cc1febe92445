#include "fsw/measurements/keypoints/pose_initialiser.h"

#include <cmath>

#include <gtest/gtest.h>

#include "fsw/filter/propagation.h"
#include "tests/unit/fsw/measurements/angles_only_scene.h"

namespace vbar::fsw::measurements {
namespace {

using namespace test;

/// A target 10 m behind that spins about a principal axis, and single images of it every 5 s.
class PoseStarts : public testing::Test {
 protected:
  PoseStarts() {
    start.configure({}, filter::inertia_of(Vector3(2.0, 3.0, 4.0).asDiagonal()).value());
    servicer = scene_servicer();
    roe = roe_of_metres(-0.5, -10.0, 0.0, 2.0, 0.0, 1.0);
    target = scene_target(servicer, roe);
  }

  PoseSample sample() {
    PoseSample seen;
    seen.time = now;
    seen.servicer = servicer;
    seen.relative_eci =
        target.position_eci - servicer.position_eci + 0.01 * Vector3(noise.normal(), noise.normal(), 0.0);
    seen.covariance_eci = 1e-4 * Matrix3::Identity();
    seen.q_eci_body = first * Eigen::Quaterniond(Eigen::AngleAxisd(kSpin * elapsed, Vector3::UnitZ()));
    seen.attitude_sigma = 0.01;
    return seen;
  }
  void move() {
    const filter::Propagation propagation(now, scene_earth(), scene_sun());
    servicer = propagation.coast(servicer, 5.0);
    target = propagation.coast(target, 5.0);
    now = now + duration_of_seconds(5);
    elapsed += 5.0;
  }

  static constexpr double kSpin = 0.02;
  const Eigen::Quaterniond first{Eigen::AngleAxisd(2.0, Vector3(1.0, 2.0, -1.0).normalized())};
  PoseInitialiser start;
  GpsTime now = scene_start();
  double elapsed = 0.0;
  orbit::CartesianState servicer, target;
  Vector6 roe;
  Noise noise{5};
};

TEST_F(PoseStarts, ThreeImagesAreEnough) {
  start.add(sample());
  EXPECT_EQ(start.attitude().status(), Status::kNotReady);
  EXPECT_EQ(start.orbit().status(), Status::kNotReady);
  move();
  start.add(sample());
  move();
  start.add(sample());
  const auto attitude = start.attitude();
  ASSERT_TRUE(attitude.ok());
  EXPECT_LT(attitude.value().attitude.q_eci_body.angularDistance(sample().q_eci_body), 1e-9);
  EXPECT_LT((attitude.value().attitude.rate_body - Vector3(0.0, 0.0, kSpin)).norm(), 1e-9);
  ASSERT_TRUE(start.orbit().ok());
}

TEST_F(PoseStarts, HalfTurnsAndWildPositionsAreOutvoted) {
  for (int k = 0; k < 9; ++k, move()) {
    PoseSample seen = sample();
    if (k % 4 == 1) seen.q_eci_body = seen.q_eci_body * Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
    if (k == 5) seen.relative_eci += Vector3(3.0, 0.0, -2.0);
    start.add(seen);
  }
  const auto attitude = start.attitude();
  ASSERT_TRUE(attitude.ok());
  EXPECT_EQ(attitude.value().agreeing, 7);
  EXPECT_LT((attitude.value().attitude.rate_body - Vector3(0.0, 0.0, kSpin)).norm(), 1e-6);
  const auto orbit = start.orbit();
  ASSERT_TRUE(orbit.ok());
  EXPECT_EQ(orbit.value().used, 8);
  // Against the very state of both, a * ROE within 4 sigma.
  const filter::Propagation back(now, scene_earth(), scene_sun());
  const Vector6 truth = roe_of_target(back.coast(servicer, -5.0), back.coast(target, -5.0)).value();
  for (int k = 0; k < 6; ++k) {
    EXPECT_LT(std::abs(orbit.value().roe(k) - truth(k)), 4.0 * std::sqrt(orbit.value().covariance(k, k))) << k;
  }
}

TEST_F(PoseStarts, AttitudesWithoutAMotionInThemAreNone) {
  for (int k = 0; k < 8; ++k, move()) {
    PoseSample seen = sample();
    seen.q_eci_body.coeffs() << noise.normal(), noise.normal(), noise.normal(), noise.normal();
    seen.q_eci_body.normalize();
    start.add(seen);
  }
  EXPECT_EQ(start.attitude().status(), Status::kDidNotConverge);
}

TEST_F(PoseStarts, WhatIsOldOrFromBeforeABurnCountsNoMore) {
  for (int k = 0; k < 4; ++k, move()) start.add(sample());
  start.interrupt_orbit();
  start.add(sample());
  EXPECT_EQ(start.orbit().status(), Status::kNotReady);
  EXPECT_TRUE(start.attitude().ok());
  for (int k = 0; k < 18; ++k) move();
  start.add(sample());
  EXPECT_EQ(start.size(), 1u);
}

}  // namespace
}  // namespace vbar::fsw::measurements
