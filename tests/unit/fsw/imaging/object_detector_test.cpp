// What is found, and what is not, in star fields of the reference camera.

#include "fsw/imaging/object_detector.h"

#include <gtest/gtest.h>

#include "tests/support/accuracy.h"
#include "tests/unit/fsw/imaging/detection.h"

namespace vbar::fsw::imaging {
namespace {

std::vector<test::Point> random_stars(int count, double electrons, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<test::Point> stars;
  for (int k = 0; k < count; ++k) {
    const double x = 6.0 + 488.0 * uniform(random);
    const double y = 6.0 + 788.0 * uniform(random);
    const auto is_near = [&](const test::Point& star) { return std::hypot(star.x - x, star.y - y) < 15.0; };
    if (std::none_of(stars.begin(), stars.end(), is_near)) stars.push_back({x, y, electrons, 0.8, 0.0, 1.2});
  }
  return stars;
}

/// The faintest stars of the catalogue, magnitude 7.5: their 3 x 3 pixels hold 700 of the 900 electrons, 31 times the
/// noise of 22. At a third of the light they are still ten sigmas.
TEST(ObjectDetector, FindsEveryStarOfMagnitudeSevenAndAHalf) {
  Detection d;
  int lost = 0;
  int count = 0;
  for (int image = 0; image < 10; ++image) {
    for (const double electrons : {900.0, 300.0}) {
      const std::vector<test::Point> stars = random_stars(100, electrons, d.random);
      test::SyntheticImage scene(500, 800);
      for (const test::Point& star : stars) scene.add(star);
      EXPECT_EQ(d.expose(scene).condition, ImageCondition::kGood);
      for (const test::Point& star : stars) lost += d.near(star.x, star.y) == nullptr ? 1 : 0;
      count += static_cast<int>(stars.size());
    }
  }
  EXPECT_GT(count, 1500);
  accuracy::expect_count("stars of magnitudes 7.5 and 8.7 not found", "synthetic fields, 20 images", lost, 0, "stars");
}

/// Five sigmas of a sum of nine pixels: one pixel in 3.5 million exceeds that, and nine neighbouring sums are hardly
/// independent: 0.1 to 0.3 an image.
TEST(ObjectDetector, HardlyFindsWhatIsNotThere) {
  Detection d;
  int found = 0;
  for (int image = 0; image < 25; ++image) found += d.expose(test::SyntheticImage(500, 800)).objects;
  accuracy::expect_below("false objects per image of 400,000 pixels at five sigma", "synthetic dark images, 25",
                         found / 25.0, 0.6, "objects");
}

TEST(ObjectDetector, TellsFluxInOrderAndOnTheDetector) {
  Detection d;
  test::SyntheticImage scene(200, 150);
  scene.add({50.25, 40.5, 2000.0});
  scene.add({120.0, 90.75, 20000.0});
  scene.add({30.0, 120.0, 8000.0});
  d.expose(scene);
  d.objects->detect(test::view_of(d.pixels, 200, 150, 710, 200), d.settings);
  const auto objects = d.objects->objects();
  ASSERT_EQ(objects.size(), 3u);
  const std::array<std::array<double, 3>, 3> expected{
      {{830.0, 290.75, 2500.0}, {740.0, 320.0, 1000.0}, {760.25, 240.5, 250.0}}};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(objects[k].centroid_px.x(), expected[k][0], 0.1);
    EXPECT_NEAR(objects[k].centroid_px.y(), expected[k][1], 0.1);
    // Photon noise and the pixels' noise, some 40 of them: 2 to 4 %; the wings below the threshold 1 to 5 %
    EXPECT_NEAR(objects[k].flux_dn, expected[k][2], 0.1 * expected[k][2]);
    EXPECT_NEAR(objects[k].radius_px, std::sqrt(0.64 + 1.0 / 12.0), 0.1);
    EXPECT_FALSE(objects[k].is_cut);
    EXPECT_FALSE(objects[k].is_saturated);
  }
  // 21.9 % of a point's light falls on the pixel in whose middle it is
  EXPECT_NEAR(objects[1].peak_dn, 64 + 0.219 * 1000.0, 20.0);
}

TEST(ObjectDetector, AHotPixelHasNoWidth) {
  Detection d;
  test::SyntheticImage scene(500, 800);
  for (int k = 0; k < 20; ++k) scene.at(20 + 23 * k, 700 - 31 * k) += 4000.0;
  EXPECT_EQ(d.expose(scene).objects, 20);
  for (const DetectedObject& object : d.objects->objects()) EXPECT_LT(object.radius_px, 0.4);
}

TEST(ObjectDetector, TheBrightestOfTooManyAreReported) {
  Detection d;
  test::SyntheticImage scene(500, 800);
  std::vector<double> fluxes;
  for (int k = 0; k < 600; ++k) {
    const double electrons = 1000.0 * std::pow(1.005, k);
    scene.add({12.0 + 20.0 * (k % 24), 12.0 + 30.0 * (k / 24), electrons});
    fluxes.push_back(electrons);
  }
  const DetectionReport report = d.expose(scene);
  EXPECT_EQ(report.components, 600);
  ASSERT_EQ(d.objects->objects().size(), kMaxObjects);
  // The 230 brightest are sure to be among them: 14 % brighter than the last, and their light is known to 3 %.
  for (int k = 370; k < 600; ++k) EXPECT_NE(d.near(12.0 + 20.0 * (k % 24), 12.0 + 30.0 * (k / 24)), nullptr) << k;
  const auto is_sorted = std::is_sorted(d.objects->objects().begin(), d.objects->objects().end(),
                                        [](const auto& a, const auto& b) { return a.flux_dn > b.flux_dn; });
  EXPECT_TRUE(is_sorted);
}

TEST(ObjectDetector, SaysWhatTheEdgeCuts) {
  Detection d;
  test::SyntheticImage scene(200, 200);
  for (const auto& [x, y] : {std::pair{0.5, 50.0}, {199.0, 60.0}, {70.0, 1.0}, {80.0, 198.2}, {100.0, 100.0}}) {
    scene.add({x, y, 20000.0});
  }
  ASSERT_EQ(d.expose(scene).objects, 5);
  for (const DetectedObject& object : d.objects->objects()) {
    const bool is_in_the_middle = std::abs(object.centroid_px.x() - 100.0) < 2.0;
    EXPECT_EQ(object.is_cut, !is_in_the_middle) << object.centroid_px.transpose();
  }
}

/// The noise that lifts bits of a bright target's halo above the threshold makes no objects of them.
TEST(ObjectDetector, ABrightTargetIsOneObject) {
  Detection d;
  for (int k = 0; k < 20; ++k) {
    test::SyntheticImage scene(200, 200);
    add_lens_point(scene, 100.0 + 0.05 * k, 100.0, electrons_of(-7.0));
    EXPECT_EQ(d.expose(scene).objects, 1);
  }
}

TEST(ObjectDetector, OneImageLeavesNothingToTheNext) {
  Detection d;
  test::SyntheticImage scene(300, 200);
  for (const test::Point& star : random_stars(20, 5000.0, d.random)) {
    if (star.x < 290.0 && star.y < 190.0) scene.add(star);
  }
  d.expose(scene);
  const std::vector<DetectedObject> first(d.objects->objects().begin(), d.objects->objects().end());
  const std::vector<std::uint16_t> pixels = d.pixels;
  test::SyntheticImage bright(500, 800);
  bright.add_light([](int x, int y) { return y > 300 ? 1e6 : 3.0 * x; });
  d.expose(bright);
  d.objects->detect(test::view_of(pixels, 300, 200), d.settings);
  ASSERT_EQ(d.objects->objects().size(), first.size());
  for (std::size_t k = 0; k < first.size(); ++k) {
    EXPECT_EQ(d.objects->objects()[k].centroid_px, first[k].centroid_px);
    EXPECT_EQ(d.objects->objects()[k].flux_dn, first[k].flux_dn);
    EXPECT_EQ(d.objects->objects()[k].sigma_px, first[k].sigma_px);
  }
}

TEST(ObjectDetector, FitsItsBudget) {
  EXPECT_LT(sizeof(ObjectDetector), 700'000u);
}

}  // namespace
}  // namespace vbar::fsw::imaging
