#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/gnc/camera_configuration.h"
#include "tests/unit/fsw/gnc/configurations.h"

namespace vbar::fsw::gnc {
namespace {

TEST(PoseConfiguration, SettingsAreTheMessages) {
  pose_configuration p = test::pose();
  p.apriori_epoch_ns = 7;
  for (int k = 0; k < 6; ++k) {
    p.apriori_a_roe_m[k] = k - 2.0;
    p.apriori_sigma_a_roe_m[k] = 0.1 * (k + 1);
  }
  const auto camera = pose_camera_settings(test::camera(), p);
  ASSERT_TRUE(camera.ok());
  EXPECT_EQ(camera.value().dark_level_dn, 64.0);
  EXPECT_EQ(camera.value().shape[10], ::vbar::test::tango_shape()[10]);
  const auto settings = keypoint_settings(test::camera(), p);
  ASSERT_TRUE(settings.ok());
  EXPECT_EQ(settings.value().blocks.relative_orbit.acceleration.psd_max, 1e-11);
  EXPECT_EQ(settings.value().blocks.attitude.inertia.tensor(1, 1), 2.5);
  EXPECT_EQ(settings.value().keypoints.aiding.inertia.tensor(2, 2), 3.1);
  EXPECT_EQ(settings.value().keypoints.aiding.start.min_images, 3);
  EXPECT_EQ(settings.value().keypoints.sigma_floor_px, 0.2);
  ASSERT_TRUE(settings.value().apriori.has_value());
  EXPECT_EQ(settings.value().apriori->kind, trunk::TargetApriori::Kind::kMeanRoe);
  EXPECT_EQ(settings.value().apriori->time.ns, 7);
  EXPECT_EQ(settings.value().apriori->mean_a_roe_m(5), 3.0);
  EXPECT_EQ(settings.value().apriori->sigma_a_roe_m(0), 0.1);
}

TEST(PoseConfiguration, NothingHandedOver) {
  const auto settings = keypoint_settings(test::camera(), test::pose());
  ASSERT_TRUE(settings.ok());
  EXPECT_FALSE(settings.value().apriori.has_value());
}

TEST(PoseConfiguration, WhatMakesNoSenseIsRefused) {
  using Spoil = std::function<void(pose_configuration&)>;
  const std::vector<std::pair<const char*, Spoil>> spoils = {
      {"a body of no inertia", [](auto& p) { p.inertia_kgm2[0] = 0.0; }},
      {"a moment larger than the two others", [](auto& p) { p.inertia_kgm2[2] = 6.0; }},
      {"keypoints in one place",
       [](auto& p) {
         for (double& x : p.keypoints_body_m) x = 1.0;
       }},
      {"a keypoint 200 m out", [](auto& p) { p.keypoints_body_m[4] = 200.0; }},
      {"no scale", [](auto& p) { p.keypoint_sigma_scale = 0.0; }},
      {"a floor below nothing", [](auto& p) { p.keypoint_floor_px = -0.1; }},
      {"a start above its limits", [](auto& p) { p.acceleration_psd = 1e-10; }},
      {"limits the wrong way round", [](auto& p) { p.acceleration_psd_least = 1e-12; }},
      {"no angular noise", [](auto& p) { p.angular_acceleration_psd = 0.0; }},
      {"burns off by twice their size", [](auto& p) { p.maneuver_sigma_relative = 2.0; }},
      {"no images for a start", [](auto& p) { p.start_images = 0; }},
      {"more images than are kept", [](auto& p) { p.start_images = 13; }},
      {"a formation known without doubt", [](auto& p) { p.start_sigma_a_roe_m[3] = 0.0; }},
      {"half an a-priori", [](auto& p) { p.apriori_sigma_a_roe_m[2] = 0.3; }},
      {"an a-priori before the origin of time",
       [](auto& p) {
         for (double& sigma : p.apriori_sigma_a_roe_m) sigma = 1.0;
         p.apriori_epoch_ns = std::numeric_limits<std::int64_t>::min();
       }},
      {"an a-priori a million metres out",
       [](auto& p) {
         for (double& sigma : p.apriori_sigma_a_roe_m) sigma = 1.0;
         p.apriori_a_roe_m[1] = 1e7;
       }},
  };
  for (const auto& [what, spoil] : spoils) {
    pose_configuration p = test::pose();
    spoil(p);
    EXPECT_EQ(keypoint_settings(test::camera(), p).status(), Status::kOutOfRange) << what;
  }
  camera_configuration bent = test::camera();
  bent.focal_length_px[0] = 0.0;
  EXPECT_EQ(keypoint_settings(bent, test::pose()).status(), Status::kOutOfRange);
  EXPECT_EQ(pose_camera_settings(bent, test::pose()).status(), Status::kOutOfRange);
}

}  // namespace
}  // namespace vbar::fsw::gnc
