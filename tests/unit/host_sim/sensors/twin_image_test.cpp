// A testbed's image beside the digital twin's: where the target lies relative to the stars, and what a picture of the
// difference shows.

#include "host_sim/sensors/camera/twin_image.h"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fsw/math/math.h"

namespace vbar::sensors {
namespace {

constexpr int kWidth = 120, kHeight = 90, kX = 710, kY = 200;

class Images : public testing::Test {
 protected:
  Images() : testbed_(kWidth * kHeight, 0.0), twin_(kWidth * kHeight, 0.0) {}

  /// A Gaussian of 0.8 px at a place of the detector, and what the flight software calls it.
  static void add_star(std::vector<double>& light, double x_px, double y_px, double flux) {
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const double dx = x + kX - x_px, dy = y + kY - y_px;
        light[static_cast<std::size_t>(y * kWidth + x)] +=
            flux / (2.0 * M_PI * 0.64) * std::exp(-0.5 * (dx * dx + dy * dy) / 0.64);
      }
  }
  void add(std::int8_t kind, double x_px, double y_px, const Eigen::Vector2d& shift_px, double flux = 12000.0) {
    add_star(twin_, x_px, y_px, flux);
    add_star(testbed_, x_px + shift_px.x(), y_px + shift_px.y(), flux);
    const auto k = static_cast<std::size_t>(objects_.count++);
    objects_.kind[k] = kind;
    objects_.x_px[k] = static_cast<float>(x_px + shift_px.x());
    objects_.y_px[k] = static_cast<float>(y_px + shift_px.y());
  }
  static std::vector<std::uint16_t> dn(const std::vector<double>& light) {
    std::vector<std::uint16_t> dn;
    for (const double value : light) dn.push_back(static_cast<std::uint16_t>(std::min(64.5 + value, 4095.0)));
    return dn;
  }
  ImagePair pair() {
    testbed_dn_ = dn(testbed_);
    twin_dn_ = dn(twin_);
    return {kWidth, kHeight, kX, kY, testbed_dn_, twin_dn_};
  }

  std::vector<double> testbed_, twin_;
  std::vector<std::uint16_t> testbed_dn_, twin_dn_;
  telemetry_objects objects_{};
};

using Kind = telemetry_objects;

// A shift of all alike is the attitude's, not the bearing's.
TEST_F(Images, TargetIsMeasuredRelativeToTheStars) {
  const Eigen::Vector2d all(0.3, -0.2);
  add(Kind::kKindStar, kX + 20, kY + 20, all);
  add(Kind::kKindStar, kX + 90.4, kY + 30.3, all);
  add(Kind::kKindStar, kX + 60.7, kY + 70.1, all);
  add(Kind::kKindTarget, kX + 40.2, kY + 50.6, all + Eigen::Vector2d(0.1, 0.05));
  const auto shift = target_shift_px(pair(), objects_);
  ASSERT_TRUE(shift);
  // Numbers are rounded to whole DN of some thousand: 0.01 px.
  EXPECT_NEAR(shift->x(), 0.1, 0.01);
  EXPECT_NEAR(shift->y(), 0.05, 0.01);

  ImageRow row;
  row.bearing_error_x_arcsec = 5.0;
  row.bearing_error_y_arcsec = -1.0;
  const double focal_length_px = 1.0 / (10.0 * fsw::math::kArcsecond);  // 10 arcsec a pixel
  EXPECT_THAT(difference_text(pair(), row, &objects_, focal_length_px),
              testing::HasSubstr("bearing error 5.0, -1.0 arcsec, in the image of the twin 4.0, -1.5 arcsec"));
}

TEST_F(Images, ShiftNeedsTargetAndStars) {
  add(Kind::kKindTarget, kX + 40, kY + 50, {0.0, 0.0});
  EXPECT_FALSE(target_shift_px(pair(), objects_));
  add(Kind::kKindStar, kX + 1, kY + 1, {0.0, 0.0});
  EXPECT_FALSE(target_shift_px(pair(), objects_)) << "at the edge";
  add(Kind::kKindStar, kX + 20, kY + 20, {0.0, 0.0});
  EXPECT_TRUE(target_shift_px(pair(), objects_));
  objects_.x_px[0] = NAN;
  EXPECT_FALSE(target_shift_px(pair(), objects_)) << "not a place";
  EXPECT_THAT(difference_text(pair(), {}, nullptr, 6000.0), testing::HasSubstr("noise"));
}

TEST_F(Images, MissingPixelsAreNotCompared) {
  add(Kind::kKindStar, kX + 20, kY + 20, {0.0, 0.0});
  add(Kind::kKindTarget, kX + 40, kY + 50, {0.0, 0.0});
  ImagePair both = pair();
  std::fill(testbed_dn_.begin(), testbed_dn_.begin() + 55 * kWidth, std::uint16_t{0xFFFF});
  both.testbed = testbed_dn_;
  EXPECT_FALSE(target_shift_px(both, objects_));
  EXPECT_EQ(difference_text(both, {}, &objects_, 6000.0), "median 0.0 DN, noise 0.5 DN");
}

TEST_F(Images, EqualImagesHaveABlackDifference) {
  add(Kind::kKindStar, kX + 20, kY + 20, {0.0, 0.0});
  const std::vector<std::uint8_t> black = difference_png(pair());
  add_star(testbed_, kX + 70, kY + 70, 5000.0);
  EXPECT_NE(difference_png(pair()), black);
  EXPECT_EQ(difference_text(pair(), {}, nullptr, 6000.0), "median 0.0 DN, noise 0.5 DN");
}

}  // namespace
}  // namespace vbar::sensors
