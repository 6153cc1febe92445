// What is found, and what is not, in star fields of the reference camera.

#include "fsw/vision/imaging/object_detector.h"

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/vision/imaging/components.h"
#include "tests/support/accuracy.h"
#include "tests/unit/fsw/vision/imaging/synthetic_images.h"

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

// Components against a flood fill of the whole mask, which is slow and obvious.

namespace {

/// Rows of text: '#' is above the threshold.
struct Mask {
  int width = 0;
  int height = 0;
  std::vector<bool> is_set;
  [[nodiscard]] bool at(int x, int y) const {
    return x >= 0 && y >= 0 && x < width && y < height && is_set[static_cast<std::size_t>(y * width + x)];
  }
};

Mask random_mask(int width, int height, double part, std::mt19937& random) {
  std::bernoulli_distribution is_set(part);
  Mask mask{width, height, {}};
  for (int k = 0; k < width * height; ++k) mask.is_set.push_back(is_set(random));
  return mask;
}

Mask mask_of(const std::vector<std::string>& rows) {
  Mask mask{static_cast<int>(rows[0].size()), static_cast<int>(rows.size()), {}};
  for (const std::string& row : rows) {
    for (const char c : row) mask.is_set.push_back(c == '#');
  }
  return mask;
}

/// What identifies a component: number of pixels, sums of coordinates, box.
using Facts = std::array<std::int64_t, 7>;

std::vector<Facts> flood_filled(const Mask& mask) {
  std::vector<bool> is_seen(mask.is_set.size());
  std::vector<Facts> all;
  for (int k = 0; k < mask.width * mask.height; ++k) {
    if (!mask.is_set[static_cast<std::size_t>(k)] || is_seen[static_cast<std::size_t>(k)]) continue;
    Facts f{0, 0, 0, mask.width, -1, mask.height, -1};
    std::vector<int> open{k};
    is_seen[static_cast<std::size_t>(k)] = true;
    while (!open.empty()) {
      const int x = open.back() % mask.width;
      const int y = open.back() / mask.width;
      open.pop_back();
      f[0] += 1;
      f[1] += x;
      f[2] += y;
      f[3] = std::min<std::int64_t>(f[3], x);
      f[4] = std::max<std::int64_t>(f[4], x);
      f[5] = std::min<std::int64_t>(f[5], y);
      f[6] = std::max<std::int64_t>(f[6], y);
      for (int j = y - 1; j <= y + 1; ++j) {
        for (int i = x - 1; i <= x + 1; ++i) {
          const auto n = static_cast<std::size_t>(j * mask.width + i);
          if (!mask.at(i, j) || is_seen[n]) continue;
          is_seen[n] = true;
          open.push_back(j * mask.width + i);
        }
      }
    }
    all.push_back(f);
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// A pixel's light is one; its sums as the detector would add them.
void scan(Components& components, const Mask& mask, std::int32_t largest) {
  components.clear(largest);
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      if (!mask.at(x, y) || mask.at(x - 1, y)) continue;
      int end = x;
      while (mask.at(end, y)) ++end;
      Component* c = components.add_run(y, x, end);
      if (c == nullptr) continue;
      c->pixels += end - x;
      c->flux += end - x;
      for (int i = x; i < end; ++i) {
        c->x += i;
        c->y += y;
      }
    }
    components.end_row(y);
  }
  components.finish();
}

std::vector<Facts> labelled(const Mask& mask) {
  const auto components = std::make_unique<Components>();
  scan(*components, mask, 1'000'000);
  std::vector<Facts> all;
  for (const Component& c : components->kept()) all.push_back({c.pixels, c.x, c.y, c.x_min, c.x_max, c.y_min, c.y_max});
  EXPECT_EQ(components->found(), static_cast<int>(all.size()));
  EXPECT_EQ(components->runs_dropped(), 0);
  std::sort(all.begin(), all.end());
  return all;
}

TEST(Components, AreThoseOfAFloodFill) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 300; ++trial) {
    // From sparse to past the density where all grows together (40.7 % with eight neighbours): long and winding ones.
    const Mask mask = random_mask(60, 40, 0.02 + 0.0018 * trial, random);
    const std::vector<Facts> expected = flood_filled(mask);
    if (expected.size() > kMaxObjects) continue;
    ASSERT_EQ(labelled(mask), expected) << "trial " << trial;
  }
}

TEST(Components, ShapesThatMeetLate) {
  const std::vector<std::vector<std::string>> shapes{
      {"#.#.#.#", "#.#.#.#", "#######"},                                              // a comb
      {"#######", "#.....#", "#.###.#", "#.#.#.#", "#.#...#", "#.#####", "#......"},  // a spiral
      {"#...#", ".#.#.", "..#..", ".#.#.", "#...#"},                                  // corners touch
      {"#.....#", "#.#.#.#", "#.#.#.#", "###.###", "......."},                        // two, side by side
      {"##.##", ".....", "##.##"},                                                    // four
  };
  for (const auto& shape : shapes) EXPECT_EQ(labelled(mask_of(shape)), flood_filled(mask_of(shape)));
}

TEST(Components, OfTooManyTheBrightestAreKept) {
  // Singles first, then so many of two pixels
  Mask mask{400, 101, std::vector<bool>(400 * 101)};
  int doubles = 0;
  for (int y = 0; y < 100; y += 2) {
    for (int x = 0; x < 399; x += 4) {
      mask.is_set[static_cast<std::size_t>(y * 400 + x)] = true;
      if ((x / 4 + y) % 20 == 19 && doubles < 200) {
        mask.is_set[static_cast<std::size_t>(y * 400 + x + 1)] = true;
        ++doubles;
      }
    }
  }
  ASSERT_EQ(doubles, 200);
  const auto components = std::make_unique<Components>();
  scan(*components, mask, 1000);
  EXPECT_EQ(components->found(), 5000);
  ASSERT_EQ(components->kept().size(), kMaxObjects);
  for (std::size_t k = 0; k < kMaxObjects; ++k) EXPECT_EQ(components->kept()[k].flux, k < 200 ? 2 : 1);
  // Of those that are alike, the topmost
  EXPECT_EQ(components->kept()[200].y_min, 0);
  EXPECT_LE(components->kept()[255].y_min, 2);
}

TEST(Components, ExtendedOnesAreCountedAndLeftOut) {
  const auto components = std::make_unique<Components>();
  scan(*components, mask_of({"###..#", "###...", "###..#"}), 8);
  EXPECT_EQ(components->found(), 3);
  EXPECT_EQ(components->extended(), 1);
  EXPECT_EQ(components->extended_pixels(), 9);
  EXPECT_EQ(components->kept().size(), 2u);
}

TEST(Components, ARowTooFullIsNotReadToItsEnd) {
  Mask mask{2048, 3, {}};
  for (int k = 0; k < 2048 * 3; ++k) mask.is_set.push_back(k % 2 == 0);
  const auto components = std::make_unique<Components>();
  scan(*components, mask, 1'000'000);
  EXPECT_EQ(components->runs_dropped(), 3 * (1024 - 512));
  EXPECT_EQ(components->found(), 512);
}

}  // namespace

}  // namespace vbar::fsw::imaging
