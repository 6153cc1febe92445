// Corners of the board in images drawn here: each pixel is the mean of rays through it onto the rectangles of the
// board.

#include "hil_drivers/tron/calibration/corner_detection.h"

#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "host_sim/engine/random_stream.h"
#include "tests/support/figures.h"

namespace vbar::tron::calibrate {
namespace {

using Eigen::Isometry3d;
using fsw::Vector2;
using fsw::Vector3;

constexpr int kWidth = 1600, kHeight = 1000;
constexpr double kFocal_px = 2901.0, kCentreX_px = 799.5, kCentreY_px = 499.5;
constexpr double kWhite_dn = 2600.0, kBlack_dn = 260.0, kRoom_dn = 120.0;

Vector2 project(const Vector3& point) {
  return {kFocal_px * point.x() / point.z() + kCentreX_px, kFocal_px * point.y() / point.z() + kCentreY_px};
}

/// Light of the board's plane on a grid of 0.5 mm, from its rectangles (all edges are on that grid).
class BoardLight {
 public:
  BoardLight() : values_(kColumns * kRows, kRoom_dn) {
    for (const BoardQuad& quad : board_quads()) {
      const int left = index(quad.corners_B[0].x()) + kColumns / 2, right = index(quad.corners_B[2].x()) + kColumns / 2;
      const int top = index(quad.corners_B[0].y()) + kRows / 2, bottom = index(quad.corners_B[2].y()) + kRows / 2;
      for (int y = top; y < bottom; ++y)
        for (int x = left; x < right; ++x)
          values_[static_cast<std::size_t>(y * kColumns + x)] = quad.is_white ? kWhite_dn : kBlack_dn;
    }
  }
  [[nodiscard]] double at(double x_m, double y_m) const {
    const int x = static_cast<int>(std::floor(x_m / kCell_m)) + kColumns / 2;
    const int y = static_cast<int>(std::floor(y_m / kCell_m)) + kRows / 2;
    if (x < 0 || y < 0 || x >= kColumns || y >= kRows) return kRoom_dn;
    return values_[static_cast<std::size_t>(y * kColumns + x)];
  }

 private:
  static constexpr double kCell_m = 0.5e-3;
  static constexpr int kColumns = 1200, kRows = 1200;
  static int index(double at_m) { return static_cast<int>(std::lround(at_m / kCell_m)); }
  std::vector<double> values_;
};

/// Rows above and columns left of `low` stay those of the room.
std::vector<double> drawn(const Isometry3d& T_C_B, int samples) {
  static const BoardLight light;
  const Isometry3d T_B_C = T_C_B.inverse();
  std::vector<double> image(static_cast<std::size_t>(kWidth * kHeight), kRoom_dn);
  Vector2 low(1e9, 1e9), high(-1e9, -1e9);
  for (const Vector3& corner : board_plate().corners_B) {
    low = low.cwiseMin(project(T_C_B * corner));
    high = high.cwiseMax(project(T_C_B * corner));
  }
  for (int y = std::max(0, static_cast<int>(low.y()) - 2); y < std::min<double>(kHeight, high.y() + 3.0); ++y)
    for (int x = std::max(0, static_cast<int>(low.x()) - 2); x < std::min<double>(kWidth, high.x() + 3.0); ++x) {
      double sum = 0.0;
      for (int sy = 0; sy < samples; ++sy)
        for (int sx = 0; sx < samples; ++sx) {
          const Vector3 ray((x - 0.5 + (sx + 0.5) / samples - kCentreX_px) / kFocal_px,
                            (y - 0.5 + (sy + 0.5) / samples - kCentreY_px) / kFocal_px, 1.0);
          const Vector3 direction = T_B_C.linear() * ray;
          const double distance = -T_B_C.translation().z() / direction.z();
          const Vector3 point = T_B_C.translation() + distance * direction;
          sum += light.at(point.x(), point.y());
        }
      image[static_cast<std::size_t>(y * kWidth + x)] = sum / (samples * samples);
    }
  return image;
}

/// Gaussian blur, rows then columns.
void blur(std::vector<double>& image, double sigma) {
  std::vector<double> kernel;
  double total = 0.0;
  for (int k = -4; k <= 4; ++k) total += kernel.emplace_back(std::exp(-0.5 * k * k / (sigma * sigma)));
  for (const int step : {1, kWidth}) {
    const std::vector<double> before = image;
    const int count = kWidth * kHeight;
    for (int at = 4 * step; at < count - 4 * step; ++at) {
      double sum = 0.0;
      for (int k = -4; k <= 4; ++k)
        sum += kernel[static_cast<std::size_t>(k + 4)] * before[static_cast<std::size_t>(at + k * step)];
      image[static_cast<std::size_t>(at)] = sum / total;
    }
  }
}

std::vector<std::uint16_t> exposed(const Isometry3d& T_C_B, std::uint64_t seed) {
  std::vector<double> light = drawn(T_C_B, 8);
  blur(light, 0.8);
  engine::RandomStream random(seed, "test/noise");
  std::vector<std::uint16_t> pixels;
  pixels.reserve(light.size());
  for (const double value : light)
    pixels.push_back(static_cast<std::uint16_t>(std::lround(std::max(0.0, value + 16.0 * 3.0 * random.normal()))));
  return pixels;
}

Isometry3d pose(double x, double y, double z, double tilt, double axis, double roll) {
  Isometry3d T = Isometry3d::Identity();
  T.translation() << x, y, z;
  T.linear() = (Eigen::AngleAxisd(tilt, Vector3(std::cos(axis), std::sin(axis), 0.0)) *
                Eigen::AngleAxisd(roll, Vector3::UnitZ()))
                   .toRotationMatrix();
  return T;
}

struct Bias {
  Vector2 mean = Vector2::Zero(), rms = Vector2::Zero();
  int count = 0;
};

/// Difference of the corners found from those projected.
Bias bias_of(const std::vector<Isometry3d>& poses, const DetectionSettings& settings) {
  Bias bias;
  std::uint64_t seed = 1;
  for (const Isometry3d& T_C_B : poses) {
    const auto pixels = exposed(T_C_B, seed++);
    for (const Corner& corner : detect_corners({kWidth, kHeight, pixels}, BoardDesign{}, settings)) {
      const Vector2 difference = corner.px - project(T_C_B * BoardDesign{}.corner(corner.id));
      bias.mean += difference;
      bias.rms += difference.cwiseAbs2();
      ++bias.count;
    }
  }
  bias.mean /= bias.count;
  bias.rms = (bias.rms / bias.count - bias.mean.cwiseAbs2()).cwiseSqrt();
  std::printf("%d corners: mean %.4f %.4f px, spread %.4f %.4f px\n", bias.count, bias.mean.x(), bias.mean.y(),
              bias.rms.x(), bias.rms.y());
  return bias;
}

/// Rolls all around, so that a shift in the image is not one of the board.
std::vector<Isometry3d> poses_at(double range_m) {
  return {pose(0.05, -0.02, range_m, 0.1, 0.3, 0.1), pose(-0.1, 0.05, range_m, 0.4, 2.0, 1.7),
          pose(0.02, 0.01, range_m, 0.6, -1.0, 3.2), pose(0.0, -0.04, range_m, 0.25, 4.0, -1.4)};
}

TEST(BoardCorners, AreFoundWithoutBiasNearBy) {
  const Bias bias = bias_of(poses_at(2.5), {});
  EXPECT_GE(bias.count, 4 * 52);                        // a marker may be missed in the noise, and with it its corners
  EXPECT_LT(accuracy::largest_entry(bias.mean), 0.03);  // the brief's goal
  EXPECT_LT(accuracy::largest_entry(bias.rms), 0.1);
}

TEST(BoardCorners, AreFoundAtTheFarEnd) {
  const Bias bias = bias_of(poses_at(5.5), {});
  EXPECT_GE(bias.count, 4 * 32);  // the brief's prototype: 32 to 50 an image
  EXPECT_LT(accuracy::largest_entry(bias.mean), 0.03);
  EXPECT_LT(accuracy::largest_entry(bias.rms), 0.35);
}

// The library alone is half a pixel off (the brief: +0.49, +0.48 px; OpenCV's pull request 28380 describes it). If a
// later release is not, the correction still does no harm, and this test says that it is no longer needed.
TEST(BoardCorners, OfTheLibraryAloneAreHalfAPixelOff) {
  DetectionSettings settings;
  settings.is_refined = false;
  const Bias bias = bias_of(poses_at(2.5), settings);
  EXPECT_NEAR(bias.mean.x(), 0.5, 0.1);
  EXPECT_NEAR(bias.mean.y(), 0.5, 0.1);
}

TEST(BoardCorners, WithoutABoardThereAreNone) {
  std::vector<std::uint16_t> pixels(static_cast<std::size_t>(kWidth * kHeight), 500);
  EXPECT_TRUE(detect_corners({kWidth, kHeight, pixels}, BoardDesign{}).empty());
  engine::RandomStream random(3, "test/noise");
  for (auto& pixel : pixels) pixel = static_cast<std::uint16_t>(random.uniform(0.0, 4095.0));
  EXPECT_TRUE(detect_corners({kWidth, kHeight, pixels}, BoardDesign{}).empty());
}

TEST(BoardCorners, PixelsOfAnotherSizeAreRefused) {
  const std::vector<std::uint16_t> pixels(100, 0);
  EXPECT_THROW(static_cast<void>(detect_corners({kWidth, kHeight, pixels}, BoardDesign{})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(detect_corners({0, 0, {}}, BoardDesign{})), std::invalid_argument);
}

}  // namespace
}  // namespace vbar::tron::calibrate
