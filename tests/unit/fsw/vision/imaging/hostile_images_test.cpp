// Images in which there is nothing to be found, and images in which there is far too much.

#include <limits>

#include <gtest/gtest.h>

#include "tests/unit/fsw/vision/imaging/synthetic_images.h"

namespace vbar::fsw::imaging {
namespace {

class HostileImage : public testing::Test {
 protected:
  HostileImage() {
    for (int k = 0; k < 40; ++k)
      stars.push_back({20.0 + 460.0 * (k % 5) / 4.0, 20.0 + 14.0 * k, 9000.0, 0.8, 0.0, 1.2});
  }
  test::SyntheticImage star_field() {
    test::SyntheticImage scene(500, 800);
    for (const test::Point& star : stars) scene.add(star);
    return scene;
  }
  /// Stars of the field found where it is true of their place.
  template <class Where>
  std::pair<int, int> found_and_all(Where where) const {
    std::pair<int, int> count{0, 0};
    for (const test::Point& star : stars) {
      if (!where(star.x, star.y)) continue;
      ++count.second;
      if (d.near(star.x, star.y, 0.2) != nullptr) ++count.first;
    }
    return count;
  }
  DetectionReport of_one_value(std::uint16_t value) {
    d.width = 500;
    d.height = 800;
    d.pixels.assign(400'000, value);
    return d.detect();
  }

  Detection d;
  std::vector<test::Point> stars;
};

TEST_F(HostileImage, BlankSaturatedAndMissingOnesSaySo) {
  d.expose(star_field());
  ASSERT_FALSE(d.objects->objects().empty());
  EXPECT_EQ(of_one_value(0).condition, ImageCondition::kBlank);
  EXPECT_TRUE(d.objects->objects().empty());
  EXPECT_EQ(of_one_value(1000).condition, ImageCondition::kBlank);
  EXPECT_EQ(of_one_value(4095).condition, ImageCondition::kSaturated);
  EXPECT_EQ(of_one_value(kMissingPixel).condition, ImageCondition::kTooLittle);
  EXPECT_TRUE(d.objects->objects().empty());
}

TEST_F(HostileImage, HalfOfItMissing) {
  d.expose(star_field());
  for (std::size_t k = 0; k < 400'000; ++k) {
    if (k / 868 % 2 == 1) d.pixels[k] = kMissingPixel;  // every other tile
  }
  const DetectionReport report = d.detect();
  EXPECT_EQ(report.condition, ImageCondition::kGood);
  // A tile is not quite two rows: a star reaches over six and is always cut
  for (const DetectedObject& object : d.objects->objects()) EXPECT_TRUE(object.is_cut);
  d.expose(star_field());
  std::fill(d.pixels.begin() + 250 * 500, d.pixels.begin() + 650 * 500, kMissingPixel);
  EXPECT_EQ(d.detect().condition, ImageCondition::kGood);
  const auto [found, all] = found_and_all([](double, double y) { return y < 245.0 || y > 655.0; });
  EXPECT_EQ(found, all);
  EXPECT_GE(all, 15);
  for (const DetectedObject& object : d.objects->objects()) {
    const double y = object.centroid_px.y();
    EXPECT_TRUE(y < 255.0 || y > 645.0);
    EXPECT_EQ(object.is_cut, y > 247.0 && y < 652.0) << y;
  }
}

TEST_F(HostileImage, SingleMissingPixels) {
  d.expose(star_field());
  const std::size_t seen = d.objects->objects().size();
  for (std::size_t k = 137; k < 400'000; k += 997) d.pixels[k] = kMissingPixel;
  const DetectionReport report = d.detect();
  EXPECT_EQ(report.condition, ImageCondition::kGood);
  EXPECT_EQ(d.objects->objects().size(), seen);
}

/// Bright limb and its glow in the lower part: an extended thing, left alone; the stars far from it are found, and
/// along it hardly anything is taken for one.
TEST_F(HostileImage, EarthsLimb) {
  for (const double glow_px : {1.0, 5.0, 20.0}) {
    test::SyntheticImage scene = star_field();
    const auto depth = [](double x, double y) { return y - 450.0 + 0.2 * x; };
    scene.add_light([&](int x, int y) { return 1e6 / (1.0 + std::exp(-depth(x, y) / glow_px)); });
    const DetectionReport report = d.expose(scene);
    EXPECT_EQ(report.condition, ImageCondition::kGood);
    EXPECT_GE(report.extended, 1);
    EXPECT_GT(report.pixels_rejected, 180'000);
    const auto [found, all] = found_and_all([&](double x, double y) { return depth(x, y) < -200.0 - 8.0 * glow_px; });
    EXPECT_EQ(found, all) << glow_px;
    const double visible = found_and_all([&](double x, double y) { return depth(x, y) < 0.0; }).second;
    EXPECT_LT(report.objects, visible + 6) << glow_px;
  }
}

TEST_F(HostileImage, TheMoon) {
  // Half a degree is 54 px across
  test::SyntheticImage scene = star_field();
  scene.add_light([](int x, int y) { return std::hypot(x - 310.0, y - 400.0) < 120.0 ? 1e7 : 0.0; });
  const DetectionReport report = d.expose(scene);
  EXPECT_EQ(report.extended, 1);
  // The disc and the pixels whose neighbours are in it
  EXPECT_GT(report.pixels_rejected, 3.1416 * 120.0 * 120.0);
  EXPECT_LT(report.pixels_rejected, 3.1416 * 122.0 * 122.0);
  const auto [found, all] = found_and_all([](double x, double y) { return std::hypot(x - 310.0, y - 400.0) > 130.0; });
  EXPECT_EQ(found, all);
  EXPECT_EQ(report.objects, all);
}

TEST_F(HostileImage, StrayLightOfTheSun) {
  test::SyntheticImage scene = star_field();
  // 4000 electrons at the corner, as far as 1000 px away
  scene.add_light([](int x, int y) { return 4000.0 * std::exp(-0.5 * (x * x + y * y) / 400.0 / 400.0); });
  const DetectionReport report = d.expose(scene);
  const auto [found, all] = found_and_all([](double, double) { return true; });
  EXPECT_EQ(found, all);
  EXPECT_LE(report.objects, all + 2);
}

/// Every fourth pixel is hot: some 20,000 objects. Bounded, and the brightest are told.
TEST_F(HostileImage, FarTooManyObjects) {
  test::SyntheticImage scene(500, 800);
  scene.add_light([](int x, int y) { return x % 4 == 0 && y % 4 == 0 ? 10000.0 : 0.0; });
  const DetectionReport report = d.expose(scene);
  EXPECT_GT(report.components, 10'000);
  EXPECT_EQ(report.objects, static_cast<int>(kMaxObjects));
}

TEST_F(HostileImage, NoiseThatNoDetectorHas) {
  d.width = 500;
  d.height = 800;
  for (const unsigned most : {1U, 255U, 4095U, 65535U}) {
    d.pixels.clear();
    for (int k = 0; k < 400'000; ++k) d.pixels.push_back(static_cast<std::uint16_t>(d.random() & most));
    const DetectionReport report = d.detect();
    EXPECT_LE(report.objects, static_cast<int>(kMaxObjects));
    for (const DetectedObject& object : d.objects->objects()) {
      EXPECT_TRUE(std::isfinite(object.centroid_px.sum()) && std::isfinite(object.sigma_px));
      EXPECT_GE(object.centroid_px.x(), 0.0);
      EXPECT_GE(object.centroid_px.y(), 0.0);
      EXPECT_LT(object.centroid_px.x(), 500.0);
      EXPECT_LT(object.centroid_px.y(), 800.0);
    }
  }
}

TEST_F(HostileImage, SizesFromNothingToTheLargest) {
  for (const auto& [w, h] : {std::pair{1, 1}, {2, 2}, {3, 3}, {1, 4096}, {4096, 1}, {4096, 97}, {97, 4096}}) {
    d.width = w;
    d.height = h;
    d.pixels.clear();
    for (int k = 0; k < w * h; ++k) d.pixels.push_back(static_cast<std::uint16_t>(64 + d.random() % 4));
    if (w > 90 && h > 90) {
      d.pixels[static_cast<std::size_t>(50 * w + 60)] = 3000;
      EXPECT_EQ(d.detect().objects, 1);
      EXPECT_NEAR(d.objects->objects()[0].centroid_px.x(), 60.0, 0.01);
    } else {
      EXPECT_EQ(d.detect().objects, 0);
    }
  }
}

TEST_F(HostileImage, SettingsThatNoCameraHasAreRefused) {
  d.expose(star_field());
  const auto condition_with = [&](auto change) {
    d.settings = {};
    change(d.settings);
    const DetectionReport report = d.detect();
    EXPECT_TRUE(d.objects->objects().empty());
    return report.condition;
  };
  using S = DetectorSettings;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(condition_with([](S& s) { s.detection_sigmas = kNan; }), ImageCondition::kInvalid);
  EXPECT_EQ(condition_with([](S& s) { s.detection_sigmas = 0.5; }), ImageCondition::kInvalid);
  EXPECT_EQ(condition_with([](S& s) { s.gain_dn_per_electron = 0.0; }), ImageCondition::kInvalid);
  EXPECT_EQ(condition_with([](S& s) { s.gain_dn_per_electron = -kNan; }), ImageCondition::kInvalid);
  EXPECT_EQ(condition_with([](S& s) { s.point_spread_sigma_px = 100.0; }), ImageCondition::kInvalid);
  EXPECT_EQ(condition_with([](S& s) { s.saturation_dn = 5000; }), ImageCondition::kInvalid);
  EXPECT_EQ(condition_with([](S& s) { s.largest_object_px = 0; }), ImageCondition::kInvalid);
}

}  // namespace
}  // namespace vbar::fsw::imaging
