#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/measurements/cdgnss/cdgnss_source.h"
#include "fsw/measurements/keypoints/keypoint_settings.h"
#include "tests/unit/fsw/messaging/configurations.h"

namespace vbar::fsw::measurements {

namespace {

using gnc::test::carrier;
using gnc::test::receiver;

TEST(CarrierSettings, AreThoseOfTheMessages) {
  const auto settings = carrier_settings(carrier(), receiver());
  ASSERT_TRUE(settings.ok());
  EXPECT_EQ(settings.value().filter.antenna_offset_sigma_m, 3.2e-3);
  EXPECT_EQ(settings.value().filter.phase_centre_jitter_m, 1e-3);
  EXPECT_EQ(settings.value().ambiguities.min_ratio, 3.0);
  EXPECT_EQ(settings.value().servicer_antenna_body_m.y(), -0.3);
  EXPECT_EQ(settings.value().target_antenna_body_m.z(), 0.1);
  const estimation::GaussMarkov wander = phase_wander_of(carrier());
  EXPECT_DOUBLE_EQ(wander.sigma, std::sqrt(2.0) * 0.5e-3);  // of a difference of two channels
  EXPECT_EQ(wander.time_s, 60.0);
}

TEST(CarrierSettings, WithoutWanderItsTimeMayBeZero) {
  carrier_configuration c = carrier();
  c.phase_wander_sigma_m = c.phase_wander_time_s = 0.0;
  EXPECT_TRUE(carrier_settings(c, receiver()).ok());
  EXPECT_EQ(phase_wander_of(c).sigma, 0.0);
  EXPECT_GT(phase_wander_of(c).time_s, 0.0);
}

TEST(CarrierSettings, InvalidFieldsAreRefused) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  using Spoil = std::function<void(carrier_configuration&)>;
  const std::vector<std::pair<const char*, Spoil>> spoils = {
      {"a ratio below one", [](auto& c) { c.min_ratio = 0.5; }},
      {"no wait", [](auto& c) { c.pair_wait_ns = 0; }},
      {"no jitter", [](auto& c) { c.phase_centre_jitter_m = 0.0; }},
      {"an antenna 200 m out", [](auto& c) { c.target_antenna_body_m[0] = 200.0; }},
      {"a negative wander", [](auto& c) { c.phase_wander_sigma_m = -1e-3; }},
      {"a wander of metres", [](auto& c) { c.phase_wander_sigma_m = 2.0; }},
      {"a wander that is not a number", [](auto& c) { c.phase_wander_sigma_m = kNan; }},
      {"a wander without a time", [](auto& c) { c.phase_wander_time_s = 0.0; }},
      {"a negative time", [](auto& c) { c.phase_wander_time_s = -60.0; }},
      {"an infinite time", [](auto& c) { c.phase_wander_time_s = kInfinity; }},
      {"a time that is not a number", [](auto& c) { c.phase_wander_time_s = kNan; }},
      {"a time that is not a number, without wander",
       [](auto& c) {
         c.phase_wander_sigma_m = 0.0;
         c.phase_wander_time_s = kNan;
       }},
  };
  for (const auto& [what, spoil] : spoils) {
    carrier_configuration c = carrier();
    spoil(c);
    EXPECT_EQ(carrier_settings(c, receiver()).status(), Status::kOutOfRange) << what;
  }
  receiver_configuration far = receiver();
  far.antenna_body_m[2] = 200.0;
  EXPECT_EQ(carrier_settings(carrier(), far).status(), Status::kOutOfRange);
}

}  // namespace

namespace {

using gnc::test::camera;
using gnc::test::pose;
using gnc::test::target_shape;

TEST(KeypointSettings, AreThoseOfTheMessages) {
  camera_configuration turned = camera();
  turned.q_camera_body[0] = 0.0;
  turned.q_camera_body[1] = 1.0;  // half a turn about x
  turned.position_body_m[2] = 0.41;
  const auto settings = keypoint_camera_settings(1, turned, target_shape(), pose());
  ASSERT_TRUE(settings.ok());
  EXPECT_EQ(settings.value().network.dark_level_dn, 64.0);
  EXPECT_EQ(settings.value().network.noise_dn, 0.5);
  EXPECT_EQ(settings.value().network.shape[10], ::vbar::test::tango_shape()[10]);
  EXPECT_EQ(settings.value().camera.model.camera, 1U);
  EXPECT_EQ(settings.value().camera.model.shape[10], ::vbar::test::tango_shape()[10]);
  EXPECT_EQ(settings.value().camera.position_camera_m, Vector3(0.0, 0.0, -0.41));
  EXPECT_EQ(settings.value().sigma_floor_px, 0.2);
  const auto aiding = keypoint_aiding_settings(target_shape(), pose());
  ASSERT_TRUE(aiding.ok());
  EXPECT_EQ(aiding.value().inertia.tensor(2, 2), 3.1);
  EXPECT_EQ(aiding.value().start.min_images, 3);
  EXPECT_EQ(aiding.value().start.sigma_a_roe_m(4), 5.0);
  const auto attitude = attitude_settings(target_shape());
  ASSERT_TRUE(attitude.ok());
  EXPECT_EQ(attitude.value().inertia.tensor(1, 1), 2.5);
  EXPECT_EQ(attitude.value().angular_acceleration.psd, 1e-11);
}

TEST(KeypointSettings, AModelThatIsNoBodyIsRefused) {
  using Spoil = std::function<void(target_model&)>;
  const std::vector<std::pair<const char*, Spoil>> spoils = {
      {"a body of no inertia", [](auto& t) { t.inertia_kgm2[0] = 0.0; }},
      {"a moment larger than the two others", [](auto& t) { t.inertia_kgm2[2] = 6.0; }},
      {"keypoints in one place",
       [](auto& t) {
         for (double& x : t.keypoints_body_m) x = 1.0;
       }},
      {"a keypoint 200 m out", [](auto& t) { t.keypoints_body_m[4] = 200.0; }},
      {"no angular noise", [](auto& t) { t.angular_acceleration_psd = 0.0; }},
  };
  for (const auto& [what, spoil] : spoils) {
    target_model t = target_shape();
    spoil(t);
    EXPECT_FALSE(is_valid(t)) << what;
  }
  EXPECT_TRUE(is_valid(target_shape()));
}

TEST(KeypointSettings, WhatMakesNoSenseIsRefused) {
  using Spoil = std::function<void(pose_configuration&)>;
  const std::vector<std::pair<const char*, Spoil>> spoils = {
      {"no scale", [](auto& p) { p.keypoint_sigma_scale = 0.0; }},
      {"a floor below nothing", [](auto& p) { p.keypoint_floor_px = -0.1; }},
      {"no images for a start", [](auto& p) { p.start_images = 0; }},
      {"more images than are kept", [](auto& p) { p.start_images = 13; }},
      {"a formation known without doubt", [](auto& p) { p.start_sigma_a_roe_m[3] = 0.0; }},
  };
  for (const auto& [what, spoil] : spoils) {
    pose_configuration p = pose();
    spoil(p);
    EXPECT_EQ(keypoint_camera_settings(0, camera(), target_shape(), p).status(), Status::kOutOfRange) << what;
    EXPECT_EQ(keypoint_aiding_settings(target_shape(), p).status(), Status::kOutOfRange) << what;
  }
  camera_configuration bent = camera();
  bent.focal_length_px[0] = 0.0;
  EXPECT_EQ(keypoint_camera_settings(0, bent, target_shape(), pose()).status(), Status::kOutOfRange);
  EXPECT_EQ(pose_camera_settings(bent, target_shape()).status(), Status::kOutOfRange);
}

// Pixels without light would be saturated.
TEST(KeypointSettings, ACameraIsDarkerWithoutLight) {
  camera_configuration bright = camera();
  bright.dark_level_dn = bright.saturation_dn;
  EXPECT_EQ(pose_camera_settings(bright, target_shape()).status(), Status::kOutOfRange);
}

}  // namespace

}  // namespace vbar::fsw::measurements
