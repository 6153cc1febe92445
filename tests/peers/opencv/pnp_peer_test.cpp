// Poses from keypoints against OpenCV's: its SQPnP (Terzakis and Lourakis 2020) refined by Levenberg-Marquardt.

#include <gtest/gtest.h>

#ifdef VBAR_HAVE_OPENCV

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <opencv2/calib3d.hpp>

#include "fsw/vision/pose/pnp.h"
#include "tests/support/accuracy.h"
#include "tests/support/tango_view.h"

namespace vbar::fsw::pose {
namespace {

constexpr int kProblems = 1000;

/// Of 6 to 11 keypoints, which ones by chance.
void leave_out_some(Keypoints& keypoints, std::mt19937_64& random) {
  std::array<std::size_t, pose::kKeypoints> order{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
  std::shuffle(order.begin(), order.end(), random);
  const std::size_t left_out = random() % 6;
  for (std::size_t k = 0; k < left_out; ++k) keypoints[order[k]].is_usable = false;
}

TargetPose opencv_pose(const Keypoints& keypoints, bool is_refined) {
  const KeypointShape shape = test::tango_shape();
  const imaging::CameraModel camera = test::close_camera();
  std::vector<cv::Point3d> body;
  std::vector<cv::Point2d> pixels;
  for (std::size_t k = 0; k < shape.size(); ++k) {
    if (!keypoints[k].is_usable) continue;
    body.emplace_back(shape[k].x(), shape[k].y(), shape[k].z());
    pixels.emplace_back(keypoints[k].pixel.x(), keypoints[k].pixel.y());
  }
  const cv::Matx33d matrix(camera.focal_length_px.x(), 0.0, camera.principal_point_px.x(), 0.0,
                           camera.focal_length_px.y(), camera.principal_point_px.y(), 0.0, 0.0, 1.0);
  const std::vector<double> distortion(camera.distortion.begin(), camera.distortion.end());
  cv::Vec3d turn;
  cv::Vec3d position;
  cv::solvePnP(body, pixels, matrix, distortion, turn, position, false, cv::SOLVEPNP_SQPNP);
  if (is_refined) {
    const cv::TermCriteria until(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-12);
    cv::solvePnPRefineLM(body, pixels, matrix, distortion, turn, position, until);
  }
  cv::Matx33d R;
  cv::Rodrigues(turn, R);
  TargetPose pose;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) pose.R_camera_body(i, j) = R(i, j);
    pose.position_camera_m(i) = position(i);
  }
  return pose;
}

/// Half of the squares of the misses, px^2, those beyond 3 px by their length (Huber 1964), as OpenCV projects.
double cost_of(const Keypoints& keypoints, const TargetPose& pose) {
  const KeypointShape shape = test::tango_shape();
  double cost = 0.0;
  for (std::size_t k = 0; k < shape.size(); ++k) {
    if (!keypoints[k].is_usable) continue;
    const Vector3 point = pose.R_camera_body * shape[k] + pose.position_camera_m;
    const double miss = (imaging::pixel_of(test::close_camera(), point).value() - keypoints[k].pixel).norm();
    cost += miss > 3.0 ? 3.0 * (miss - 1.5) : 0.5 * miss * miss;
  }
  return cost;
}

TEST(PnpPeer, WithoutNoiseTheSamePoseAsOpenCv) {
  std::mt19937_64 random(1);
  accuracy::Largest largest_turn;
  accuracy::Largest largest_shift;
  accuracy::Largest largest_true;
  for (int n = 0; n < kProblems; ++n) {
    const TargetPose truth = test::random_pose(random, 4.0, 15.0);
    Keypoints keypoints = test::seen_keypoints(truth, 0.0, 1.0, random);
    leave_out_some(keypoints, random);
    const Result<PnpSolution> found = solve_pnp(keypoints, test::tango_shape(), test::close_camera(), {}, 1);
    ASSERT_TRUE(found.ok()) << n;
    const TargetPose& pose = found.value().pose;
    const TargetPose theirs = opencv_pose(keypoints, true);
    largest_turn.add(test::turn_between(theirs.R_camera_body, pose.R_camera_body).norm());
    largest_shift.add((pose.position_camera_m - theirs.position_camera_m).norm() / theirs.position_camera_m.norm());
    largest_true.add(test::turn_between(truth.R_camera_body, pose.R_camera_body).norm());
  }
  accuracy::expect_below("attitude from keypoints without noise", "OpenCV SQPnP refined, 1000 poses of Tango",
                         largest_turn, 1e-6, "rad");
  accuracy::expect_below("position from keypoints without noise, of the range",
                         "OpenCV SQPnP refined, 1000 poses of Tango", largest_shift, 1e-6, "");
  // Pixels of 500 hold 1e-13, a pixel is 1e-3 rad of Tango's image at 15 m or less: 1e-10 with a large margin
  accuracy::expect_below("true attitude from keypoints without noise", "truth, 1000 poses of Tango", largest_true, 1e-9,
                         "rad");
}

TEST(PnpPeer, WithNoiseNeverAWorseFitThanOpenCv) {
  std::mt19937_64 random(2);
  PnpSettings all;
  all.inlier_sigmas = 100.0;  // both fit all keypoints
  int worse = 0;
  int better = 0;
  for (int n = 0; n < kProblems; ++n) {
    const TargetPose truth = test::random_pose(random, 4.0, 15.0);
    Keypoints keypoints = test::seen_keypoints(truth, 1.0, 1.0, random);
    leave_out_some(keypoints, random);
    const Result<PnpSolution> found = solve_pnp(keypoints, test::tango_shape(), test::close_camera(), all, 1);
    ASSERT_TRUE(found.ok()) << n;
    const double ours = cost_of(keypoints, found.value().pose);
    const double theirs = cost_of(keypoints, opencv_pose(keypoints, true));
    // Both stop where a step changes the cost by rounding: 1e-9 px^2 of some tens
    if (!(ours <= theirs + 1e-9)) ++worse;
    if (ours < theirs - 1e-3) ++better;
  }
  RecordProperty("better", better);
  accuracy::expect_count("poses from keypoints with 1 px noise that fit worse",
                         "OpenCV SQPnP and solvePnPRefineLM, 1000 poses of Tango", worse, 0, "poses");
}

}  // namespace
}  // namespace vbar::fsw::pose

#else

TEST(PnpPeer, IsOpenCvs) {
  GTEST_SKIP() << "OpenCV (libopencv-dev) is not installed";
}

#endif
