// Sensitivities of the rows against differences of the geometry; hostile keypoints; the weight of seen views.

#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "fsw/measurements/calibrated_camera.h"
#include "fsw/measurements/keypoints/resolution.h"
#include "fsw/vision/target_tracking/bearing.h"
#include "tests/unit/fsw/measurements/angles_only_scene.h"
#include "tests/unit/fsw/measurements/keypoint_flight.h"

namespace vbar::fsw::measurements {

namespace {

using namespace measurements::test;
using filter::kAt;

class KeypointRows : public testing::Test {
 protected:
  KeypointRows() {
    filter::FilterSettings blocks;
    blocks.earth = scene_earth();
    filter->configure(blocks);
    filter->advance_to(scene_start(), {});
    filter->set_states(scene_servicer(), scene_target(scene_servicer(), roe));
    filter->initialize_relative(roe, 1e-20 * Matrix6::Identity(), filter::SolutionStatus::kEstimated);
    filter::AttitudeState attitude;
    attitude.q_eci_body = Eigen::Quaterniond(0.5, -0.1, 0.7, 0.4).normalized();
    filter->initialize_attitude(attitude, 1e-10 * Matrix6::Identity());
    filter::initialize_block<KeypointOrigin>(filter->estimate(), {.sigma = 0.01});
    filter::initialize_block<CameraMounts>(filter->estimate(), {.sigma = 1e-4});
    q_eci_body = attitude.q_eci_body;

    const Vector3 z = (scene_target(scene_servicer(), roe).position_eci - scene_servicer().position_eci).normalized();
    const Vector3 x = z.cross(scene_servicer().position_eci).normalized();
    camera.R_camera_eci << x.transpose(), z.cross(x).transpose(), z.transpose();
    camera.origin_eci = {0.2, -0.1, 0.3};
    model.camera = 1;
    model.optics = {{1450.0, 1440.0}, {480.0, 300.0}, {-0.2, 0.5, -7e-4, -2e-4, -0.1}};
    for (std::size_t k = 0; k < model.shape.size(); ++k) {
      const double angle = 0.7 * static_cast<double>(k);
      model.shape[k] = {0.5 * std::cos(angle), 0.4 * std::sin(angle), 0.3 * std::cos(2.0 * angle)};
      keypoints[k].is_usable = true;
      keypoints[k].covariance_px2 << 4.0, 1.0, 1.0, 2.0;
      keypoints[k].pixel = seen(k, Vector6::Zero(), Vector3::Zero(), Vector3::Zero(), Vector2::Zero());
    }
  }

  /// The pixel of keypoint k from geometry alone; the boresight bias rotates its direction.
  Vector2 seen(std::size_t k, const Vector6& roe_change, const Vector3& turn, const Vector3& origin,
               const Vector2& boresight) const {
    const orbit::CartesianState servicer = scene_servicer();
    const Vector3 sight =
        scene_target(servicer, roe + roe_change).position_eci - servicer.position_eci - camera.origin_eci;
    const double angle = turn.norm();
    const Matrix3 by = angle > 0.0 ? Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() : Matrix3::Identity();
    const Vector3 point_eci = sight + q_eci_body.toRotationMatrix() * by * (model.shape[k] + origin);
    const Vector3 direction =
        point_eci.normalized() +
        target_tracking::bearing_axes(sight.normalized(), servicer).topRows<2>().transpose() * boresight;
    return imaging::pixel_of(model.optics, camera.R_camera_eci * direction).value();
  }

  const Vector6 roe = roe_of_metres(0.0, -8.5, 1.0, 0.0, 1.0, 0.5);
  std::unique_ptr<filter::RelativeNavigationFilter> filter = std::make_unique<filter::RelativeNavigationFilter>();
  filter::MeasurementBatch& batch = filter->workspace();
  Eigen::Quaterniond q_eci_body;
  CameraPose camera;
  KeypointModel model;
  pose::Keypoints keypoints{};
};

TEST_F(KeypointRows, SensitivitiesAreThoseOfTheGeometry) {
  ASSERT_EQ(keypoint_rows(*filter, keypoints, camera, model, batch), Status::kOk);
  ASSERT_EQ(batch.used(), 22);
  // The mean of the sigma points differs from the central one by the curvature over 1e-5 rad: far below 1e-4 px.
  EXPECT_LT(batch.residual.norm(), 1e-4);
  const auto expect_column = [&](int index, double step, const auto& pixel_at) {
    for (std::size_t k = 0; k < keypoints.size(); ++k) {
      const Vector2 slope = (pixel_at(k, step) - pixel_at(k, -step)) / (2.0 * step);
      for (int axis = 0; axis < 2; ++axis) {
        const double sensitivity = batch.sensitivity(index, 2 * static_cast<int>(k) + axis);
        EXPECT_NEAR(sensitivity, slope(axis), 1e-3 * slope.norm() + 1e-6) << index << ' ' << k;
      }
    }
  };
  const Vector3 none = Vector3::Zero();
  const Vector2 flat = Vector2::Zero();
  for (int i = 0; i < 6; ++i) {
    expect_column(i, 1e-9, [&](std::size_t k, double d) { return seen(k, d * Vector6::Unit(i), none, none, flat); });
  }
  for (int i = 0; i < 3; ++i) {
    expect_column(kAt<filter::AttitudeError> + i, 1e-4,
                  [&](std::size_t k, double d) { return seen(k, Vector6::Zero(), d * Vector3::Unit(i), none, flat); });
    expect_column(kAt<KeypointCommon> + KeypointCommon::kLastingTurn + i, 1e-4,
                  [&](std::size_t k, double d) { return seen(k, Vector6::Zero(), d * Vector3::Unit(i), none, flat); });
    expect_column(kAt<KeypointOrigin> + i, 1e-4,
                  [&](std::size_t k, double d) { return seen(k, Vector6::Zero(), none, d * Vector3::Unit(i), flat); });
  }
  for (int i = 0; i < 2; ++i) {
    expect_column(mount_at(1) + i, 1e-5,
                  [&](std::size_t k, double d) { return seen(k, Vector6::Zero(), none, none, d * Vector2::Unit(i)); });
  }
}

/// A lasting error of the apparent size is that of one camera, larger for a small image.
TEST_F(KeypointRows, EachCameraHasItsOwnLastingStretch) {
  model.lasting_stretch_scale = 3.0;
  ASSERT_EQ(keypoint_rows(*filter, keypoints, camera, model, batch), Status::kOk);
  constexpr int kLasting = kAt<KeypointCommon> + KeypointCommon::kLastingStretch;
  for (int row = 0; row < batch.count(); ++row) {
    EXPECT_EQ(batch.sensitivity(kLasting, row), 0.0) << "of the other camera";
    // That of the stretch of one view is the distance from the centre.
    const double from_centre = batch.sensitivity(kAt<KeypointCommon> + 2, row);
    EXPECT_NE(from_centre, 0.0);
    EXPECT_DOUBLE_EQ(batch.sensitivity(kLasting + 1, row), 3.0 * from_centre);
  }
}

/// The noise and the variance of the error states add up to the covariance of the network.
TEST_F(KeypointRows, CorrelatedAndWhiteErrorsAddUpToTheCovariance) {
  ASSERT_EQ(keypoint_rows(*filter, keypoints, camera, model, batch), Status::kOk);
  for (int k = 0; k < pose::kKeypoints; ++k) {
    Matrix2 root;
    for (int axis = 0; axis < 2; ++axis) {
      root.row(axis) = batch.sensitivity.col(2 * k + axis).segment<2>(kAt<KeypointErrors> + 2 * k).transpose();
    }
    const Matrix2 sum = root * root.transpose() + batch.noise.block<2, 2>(2 * k, 2 * k);
    EXPECT_LT((sum - keypoints[static_cast<std::size_t>(k)].covariance_px2).norm(), 1e-6) << k;
  }
}

TEST_F(KeypointRows, InvalidKeypointsAreNotInUse) {
  keypoints[0].pixel.x() = std::numeric_limits<double>::quiet_NaN();
  keypoints[1].covariance_px2.setZero();
  keypoints[2].covariance_px2 << 1.0, 2.0, 2.0, 1.0;
  keypoints[3].is_usable = false;
  keypoints[4].covariance_px2.setConstant(std::numeric_limits<double>::infinity());
  ASSERT_EQ(keypoint_rows(*filter, keypoints, camera, model, batch), Status::kOk);
  EXPECT_EQ(batch.used(), 12);
  camera.R_camera_eci = -camera.R_camera_eci;  // all behind the camera
  const Status status = keypoint_rows(*filter, keypoints, camera, model, batch);
  EXPECT_TRUE(status != Status::kOk || batch.used() == 0);
  filter->deactivate_attitude();
  EXPECT_EQ(keypoint_rows(*filter, keypoints, camera, model, batch), Status::kNotReady);
}

View view_of(double angle, double range_m = 10.0) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vector3::UnitX())), std::log(range_m)};
}

GpsTime after(int seconds) {
  return scene_start() + duration_of_seconds(seconds);
}

/// m = 1 + gain sum_j c_j exp(-d_j / angle), counts decaying with 2000 s.
TEST(ViewNovelty, TheWeightIsThatOfTheFormula) {
  ViewNovelty seen;
  seen.configure({});
  seen.add(view_of(0.0), after(0));
  seen.add(view_of(0.05), after(5));  // merged
  seen.add(view_of(1.0), after(10));
  EXPECT_EQ(seen.scale(view_of(0.0), after(20)), 1.0);  // of the last minute
  seen.add(view_of(2.0), after(500));
  const double both = std::exp(-500.0 / 2000.0) + std::exp(-495.0 / 2000.0);
  const double third = std::exp(-490.0 / 2000.0) * std::exp(-0.8 / 0.25);
  EXPECT_NEAR(seen.scale(view_of(0.2), after(500)), 1.0 + 0.8 * (both * std::exp(-0.2 / 0.25) + third), 1e-6);
  // A factor of e^0.25 in range counts as 0.25 rad.
  EXPECT_NEAR(seen.scale(view_of(0.0, 10.0 * std::exp(0.25)), after(500)),
              1.0 + 0.8 * (both * std::exp(-1.0) + std::exp(-490.0 / 2000.0) * std::exp(-std::hypot(1.0, 0.25) / 0.25)),
              1e-6);
}

TEST(ViewNovelty, ItsMemoryIsBounded) {
  ViewNovelty seen;
  seen.configure({});
  for (int k = 0; k < 5000; ++k) seen.add(view_of(0.37 * k, 5.0 + k % 50), after(5 * k));
  const double scale = seen.scale(view_of(0.0), after(25000));
  EXPECT_GT(scale, 1.0);
  EXPECT_LT(scale, 1.0 + 0.8 * 2000.0 / 5.0);  // of all images of the memory
  seen.add({Eigen::Quaterniond(NAN, 0.0, 0.0, 0.0), 1.0}, after(25001));
  EXPECT_LT(seen.scale(view_of(0.0), after(25002)), 1.0 + 0.8 * 2000.0 / 5.0);
  EXPECT_EQ(seen.scale({Eigen::Quaterniond(NAN, 0.0, 0.0, 0.0), 1.0}, after(25002)), 1.0);
}

}  // namespace

// Which camera resolves the target from which range on: the figures of the two cameras of missions/full_range.toml.

namespace {

/// Of a target of 0.75 m radius: 13.5 samples of the network per metre at a scale of 1.
KeypointCameraSettings camera_of(double focal_length_px, int width, int height) {
  KeypointCameraSettings camera;
  camera.network.model.focal_length_px = {focal_length_px, focal_length_px};
  camera.network.frame = {.width = width, .height = height};
  camera.network.shape[3] = {0.0, 0.75, 0.0};
  return camera;
}
const KeypointCameraSettings kFar = camera_of(5972.7, 500, 800);    // 35 mm
const KeypointCameraSettings kClose = camera_of(1450.5, 800, 500);  // 17 mm, binned

class ResolutionTest : public testing::Test {
 protected:
  /// `lateral_m` across the line of sight and `along_m` along it, 1 sigma.
  void place(double range_m, double lateral_m = 0.01, double along_m = 0.1) {
    const Vector6 roe = roe_of_metres(0.0, -range_m, 0.0, 0.0, 0.0, 0.0);
    filter_ = std::make_unique<filter::RelativeNavigationFilter>();
    filter::FilterSettings blocks;
    blocks.earth = scene_earth();
    filter_->configure(blocks);
    filter_->advance_to(scene_start(), {});
    filter_->set_states(scene_servicer(), scene_target(scene_servicer(), roe));
    Matrix6 covariance = 1e-20 * Matrix6::Identity();
    const double a = scene_servicer().position_eci.norm();
    covariance(1, 1) = along_m * along_m / (a * a);
    covariance(4, 4) = covariance(5, 5) = lateral_m * lateral_m / (a * a);
    filter_->initialize_relative(roe, covariance, filter::SolutionStatus::kEstimated);
  }
  Resolution far(Resolution before) { return resolution_of(kFar, *filter_, before); }
  std::unique_ptr<filter::RelativeNavigationFilter> filter_ = std::make_unique<filter::RelativeNavigationFilter>();
};

// 2.3 * 0.75 m * 5972.7 px / 128 = 80.5 m.
TEST_F(ResolutionTest, ScaleIsPixelsPerSample) {
  EXPECT_NEAR(image_scale(kFar, 80.5), 1.0, 1e-3);
  EXPECT_NEAR(image_scale(kClose, 19.55), 1.0, 1e-3);
}

TEST_F(ResolutionTest, WithoutARangeAnImageMayShowAnything) {
  EXPECT_EQ(far(Resolution::kResolved), Resolution::kUnknown);
  place(60.0, 0.01, 15.0);
  EXPECT_EQ(far(Resolution::kResolved), Resolution::kUnknown) << "known to a quarter";
}

TEST_F(ResolutionTest, BeginsAndEndsAtDifferentRanges) {
  place(150.0);
  EXPECT_EQ(far(Resolution::kUnknown), Resolution::kTooSmall);
  EXPECT_EQ(far(Resolution::kResolved), Resolution::kResolved);
  place(130.0);
  EXPECT_EQ(far(Resolution::kTooSmall), Resolution::kResolved);
  place(185.0);
  EXPECT_EQ(far(Resolution::kResolved), Resolution::kTooSmall);
}

TEST_F(ResolutionTest, EndsWhereTheTargetFillsTheImage) {
  place(18.5);
  EXPECT_EQ(far(Resolution::kResolved), Resolution::kResolved);
  place(17.5);
  EXPECT_EQ(far(Resolution::kResolved), Resolution::kTooLarge) << "1.5 m are 512 px of 500";
  EXPECT_EQ(resolution_of(kClose, *filter_, Resolution::kTooSmall), Resolution::kResolved);
  place(18.5);
  EXPECT_EQ(far(Resolution::kTooLarge), Resolution::kResolved);
}

TEST_F(ResolutionTest, BearingsGoOnUntilThePlaceIsKnown) {
  place(100.0, 0.15);
  EXPECT_EQ(far(Resolution::kTooSmall), Resolution::kTooSmall);
}

TEST_F(ResolutionTest, TheSizeOfASmallImageIsLessCertain) {
  EXPECT_EQ(lasting_stretch_scale(3.0), 1.0);
  EXPECT_NEAR(lasting_stretch_scale(1.1), 4.0, 1e-12);
}

TEST(ExposureScheduler, EveryOtherImageIsForBearingsWhileKeypointsDoNotAid) {
  ExposureScheduler scheduler;
  EXPECT_FALSE(scheduler.is_bearing_due());
  for (int pair = 0; pair < 3; ++pair) {
    scheduler.take_keypoints(0.7, false);
    EXPECT_TRUE(scheduler.is_bearing_due());
    scheduler.take_bearing();
    EXPECT_FALSE(scheduler.is_bearing_due());
  }
  scheduler.take_keypoints(0.7, true);
  EXPECT_FALSE(scheduler.is_bearing_due());
  scheduler.take_keypoints(1.2, false);
  EXPECT_FALSE(scheduler.is_bearing_due()) << "too close for stars";
  scheduler.take_keypoints(std::nullopt, false);
  EXPECT_FALSE(scheduler.is_bearing_due()) << "at an unknown range";
}

TEST(TwoExposures, TheExposureStatesTheUse) {
  angles_only_configuration bearings{};
  pose_configuration keypoints{};
  EXPECT_FALSE(two_exposures(bearings, keypoints).ok());
  bearings.exposure_s = 0.2;
  keypoints.exposure_s = 0.1;
  EXPECT_FALSE(two_exposures(bearings, keypoints).ok()) << "too similar";
  keypoints.exposure_s = 1e-5;
  const auto both = two_exposures(bearings, keypoints);
  ASSERT_TRUE(both.ok());
  EXPECT_FALSE(both.value().is_for_keypoints(0.2));
  EXPECT_TRUE(both.value().is_for_keypoints(static_cast<double>(1e-5F)));
  EXPECT_TRUE(both.value().is_for_keypoints(1e-3)) << "nearer to the shorter, as ratios go";
  EXPECT_FALSE(both.value().is_for_keypoints(2e-3));
}

}  // namespace

}  // namespace vbar::fsw::measurements
