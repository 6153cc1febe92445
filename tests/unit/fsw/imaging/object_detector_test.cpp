#include "fsw/imaging/object_detector.h"

#include <memory>

#include <gtest/gtest.h>

#include "tests/support/synthetic_image.h"

namespace vbar::fsw::imaging {
namespace {
TEST(ObjectDetector, FindsSixtyStars) {
  std::mt19937_64 random(1);
  test::SyntheticImage scene(500, 800);
  std::uniform_real_distribution<double> u(0, 1);
  std::vector<test::Point> stars;
  for (int k = 0; k < 60; ++k) {
    stars.push_back({.x = 20 + 460 * u(random),
                     .y = 20 + 760 * u(random),
                     .electrons = 900 * std::pow(10, 2 * u(random)),
                     .smear_x_px = 1.2});
    scene.add(stars.back());
  }
  auto pixels = scene.expose({}, random);
  const auto detector = std::make_unique<ObjectDetector>();
  const DetectionReport report = detector->detect(test::view_of(pixels, 500, 800), {});
  EXPECT_EQ(report.condition, ImageCondition::kGood);
  EXPECT_EQ(report.objects, 60);
}
}  // namespace
}  // namespace vbar::fsw::imaging
