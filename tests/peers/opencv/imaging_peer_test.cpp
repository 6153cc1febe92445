// The same components as OpenCV's connectedComponentsWithStats, the same directions as its undistortPoints and the same
// pixels as its projectPoints.

#include <gtest/gtest.h>

#ifdef VBAR_HAVE_OPENCV

#include <algorithm>
#include <array>
#include <memory>
#include <random>
#include <vector>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "fsw/vision/imaging/camera_model.h"
#include "fsw/vision/imaging/components.h"
#include "tests/support/accuracy.h"

namespace vbar::fsw::imaging {
namespace {

using Facts = std::array<int, 5>;  // x, y, width, height, pixels

std::vector<Facts> theirs(const cv::Mat& mask) {
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat centroids;
  const int count = cv::connectedComponentsWithStats(mask, labels, stats, centroids, 8, CV_32S);
  std::vector<Facts> all;
  for (int k = 1; k < count; ++k) {  // 0 is what is not set
    all.push_back({stats.at<int>(k, cv::CC_STAT_LEFT), stats.at<int>(k, cv::CC_STAT_TOP),
                   stats.at<int>(k, cv::CC_STAT_WIDTH), stats.at<int>(k, cv::CC_STAT_HEIGHT),
                   stats.at<int>(k, cv::CC_STAT_AREA)});
  }
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<Facts> ours(const cv::Mat& mask) {
  const auto components = std::make_unique<Components>();
  components->clear(mask.rows * mask.cols);
  for (int y = 0; y < mask.rows; ++y) {
    const auto* row = mask.ptr<std::uint8_t>(y);
    for (int x = 0; x < mask.cols; ++x) {
      if (row[x] == 0) continue;
      const int begin = x;
      while (x < mask.cols && row[x] != 0) ++x;
      Component* component = components->add_run(y, begin, x);
      if (component != nullptr) component->pixels += x - begin;
    }
    components->end_row(y);
  }
  components->finish();
  std::vector<Facts> all;
  for (const Component& c : components->kept()) {
    all.push_back({c.x_min, c.y_min, c.x_max - c.x_min + 1, c.y_max - c.y_min + 1, c.pixels});
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// Smooth noise above a level: blobs, rings and lakes of all shapes, as many as are kept at most.
TEST(ImagingPeer, ComponentsAreOpenCvs) {
  std::mt19937 random(1);
  int different = 0;
  int compared = 0;
  std::size_t components = 0;
  for (int k = 0; k < 100; ++k) {
    cv::Mat noise(300, 200, CV_32F);
    for (auto it = noise.begin<float>(); it != noise.end<float>(); ++it) *it = static_cast<float>(random() % 1000);
    cv::GaussianBlur(noise, noise, cv::Size(0, 0), 1.5 + 0.03 * k);
    cv::Scalar mean;
    cv::Scalar sigma;
    cv::meanStdDev(noise, mean, sigma);
    const cv::Mat mask = noise > mean[0] + (0.01 * (k % 50) * 3) * sigma[0];
    const std::vector<Facts> expected = theirs(mask);
    if (expected.size() > kMaxObjects) continue;
    ++compared;
    components += expected.size();
    different += ours(mask) == expected ? 0 : 1;
  }
  EXPECT_GT(compared, 70);
  EXPECT_GT(components, 4000u);
  accuracy::expect_count("connected components, masks that differ", "OpenCV connectedComponentsWithStats, 100 masks",
                         different, 0, "masks");
}

/// A wide lens with far more distortion than the reference camera's.
class CameraPeer : public testing::Test {
 protected:
  CameraModel camera{.focal_length_px = {2901.0, 2905.0},
                     .principal_point_px = {955.2, 602.8},
                     .distortion = {-0.11, 0.09, 0.0011, -0.0007, 0.04}};
  cv::Matx33d matrix{2901.0, 0.0, 955.2, 0.0, 2905.0, 602.8, 0.0, 0.0, 1.0};
  std::vector<double> distortion{-0.11, 0.09, 0.0011, -0.0007, 0.04};
};

TEST_F(CameraPeer, DirectionsAreOpenCvs) {
  std::vector<cv::Point2d> pixels;
  for (int y = 0; y < 1200; y += 50) {
    for (int x = 0; x < 1920; x += 50) pixels.emplace_back(x, y);
  }
  std::vector<cv::Point2d> points;
  const cv::TermCriteria until(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-15);
  cv::undistortPoints(pixels, points, matrix, distortion, cv::noArray(), cv::noArray(), until);
  accuracy::Largest largest;
  for (std::size_t k = 0; k < pixels.size(); ++k) {
    const Result<Vector3> direction = direction_of(camera, {pixels[k].x, pixels[k].y});
    ASSERT_TRUE(direction.ok());
    const Vector3 expected = Vector3(points[k].x, points[k].y, 1.0).normalized();
    largest.add((direction.value() - expected).norm());
  }
  // Both iterate to rounding: 1e-15 of the image plane
  accuracy::expect_below("direction of a pixel through a distorting lens", "OpenCV undistortPoints, 936 pixels",
                         largest, 1e-13, "rad");
}

TEST_F(CameraPeer, PixelsAreOpenCvs) {
  std::vector<cv::Point3d> points;
  for (int i = -6; i <= 6; ++i) {
    for (int j = -4; j <= 4; ++j) points.emplace_back(0.05 * i, 0.05 * j, 1.0);
  }
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(points, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), matrix, distortion, pixels);
  accuracy::Largest largest;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vector2 pixel = pixel_of(camera, Vector3(points[k].x, points[k].y, points[k].z)).value();
    largest.add((pixel - Vector2(pixels[k].x, pixels[k].y)).norm());
  }
  // Rounding of pixel numbers near 2000: 2e-13 each operation
  accuracy::expect_below("pixel of a direction through a distorting lens", "OpenCV projectPoints, 117 directions",
                         largest, 2e-12, "px");
}

}  // namespace
}  // namespace vbar::fsw::imaging

#else

TEST(ImagingPeer, IsOpenCvs) {
  GTEST_SKIP() << "OpenCV (libopencv-dev) is not installed";
}

#endif
