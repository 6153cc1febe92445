#include "fsw/sources/keypoints/keypoint_settings.h"

#include <functional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/fsw/gnc/configurations.h"

namespace vbar::fsw::sources {
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
}  // namespace vbar::fsw::sources
