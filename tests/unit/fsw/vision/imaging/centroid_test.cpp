// Centroids of points against where they are: bias over the places within a pixel, scatter against the Cramer-Rao
// bound.

#include <gtest/gtest.h>

#include "tests/support/accuracy.h"
#include "tests/unit/fsw/vision/imaging/synthetic_images.h"

namespace vbar::fsw::imaging {
namespace {

struct Errors {
  accuracy::Largest worst;
  double rms = 0.0;  ///< each axis
  double mean_x = 0.0, mean_y = 0.0;
  double predicted = 0.0;  ///< root mean square of what the detector says of itself
  int lost = 0;
  int count = 0;
};

/// 15 x 15 points like this one, a fifteenth of a pixel further each, `images` times.
Errors errors_of(Detection& d, const test::Point& like, int images) {
  Errors e;
  double squares = 0.0;
  double predicted = 0.0;
  test::SyntheticImage scene(400, 400);
  std::vector<test::Point> points;
  for (int k = 0; k < 225; ++k) {
    test::Point point = like;
    point.x = 30.0 + 24.0 * (k % 15) + (k % 15) / 15.0;
    point.y = 30.0 + 24.0 * (k / 15) + (k / 15) / 15.0;
    points.push_back(point);
    scene.add(point);
  }
  for (int image = 0; image < images; ++image) {
    d.expose(scene);
    for (const test::Point& point : points) {
      const DetectedObject* object = d.near(point.x, point.y);
      if (object == nullptr) {
        ++e.lost;
        continue;
      }
      const double x = object->centroid_px.x() - point.x;
      const double y = object->centroid_px.y() - point.y;
      e.worst.add(std::hypot(x, y));
      squares += 0.5 * (x * x + y * y);
      predicted += object->sigma_px * object->sigma_px;
      e.mean_x += x;
      e.mean_y += y;
      ++e.count;
    }
  }
  e.rms = std::sqrt(squares / e.count);
  e.predicted = std::sqrt(predicted / e.count);
  e.mean_x /= e.count;
  e.mean_y /= e.count;
  return e;
}

/// Least possible standard deviation of a position (mean of the axes' variances), from the Fisher information of the
/// pixels of a point with these noises; of a detector that knows the image of a point exactly.
double cramer_rao(const test::Point& like, const test::SyntheticDetector& detector) {
  const auto scene_at = [&](double x, double y) {
    test::SyntheticImage scene(31, 31);
    test::Point point = like;
    point.x = 15.3 + x;
    point.y = 15.3 + y;
    scene.add(point);
    return scene;
  };
  constexpr double h = 0.01;
  std::array<test::SyntheticImage, 5> scenes{scene_at(0, 0), scene_at(-h, 0), scene_at(h, 0), scene_at(0, -h),
                                             scene_at(0, h)};
  double information_x = 0.0;
  double information_y = 0.0;
  const double quantum = 1.0 / detector.gain_dn_per_electron;
  for (int y = 0; y < 31; ++y) {
    for (int x = 0; x < 31; ++x) {
      const double read = detector.read_noise_electrons;
      const double variance = scenes[0].at(x, y) + detector.dark_electrons + read * read + quantum * quantum / 12.0;
      const double slope_x = (scenes[2].at(x, y) - scenes[1].at(x, y)) / (2.0 * h);
      const double slope_y = (scenes[4].at(x, y) - scenes[3].at(x, y)) / (2.0 * h);
      information_x += slope_x * slope_x / variance;
      information_y += slope_y * slope_y / variance;
    }
  }
  return std::sqrt(0.5 / information_x + 0.5 / information_y);
}

/// A detector so good that what is left is the method's own: 1 electron a DN, hardly any noise.
test::SyntheticDetector perfect() {
  test::SyntheticDetector detector;
  detector.gain_dn_per_electron = 1.0;
  detector.read_noise_electrons = 0.35;
  detector.has_photon_noise = false;
  return detector;
}

TEST(Centroid, IsUnbiasedWhereverInAPixelThePointIs) {
  Detection d;
  d.detector = perfect();
  d.settings.gain_dn_per_electron = 1.0;
  // The image of a point of the reference camera, still, smeared by the orbit's rate along and across, and obliquely.
  // The light is 8000 DN: the noise of 0.45 DN a pixel alone scatters by 0.0002 px.
  accuracy::Largest worst;
  for (const auto& [smear_x, smear_y] : {std::pair{0.0, 0.0}, {1.2, 0.0}, {0.0, 1.2}, {0.8, 0.9}}) {
    const Errors e = errors_of(d, {.electrons = 8000.0, .smear_x_px = smear_x, .smear_y_px = smear_y}, 1);
    EXPECT_EQ(e.lost, 0);
    worst.add(e.worst);
  }
  // Sampled by pixels, a Gaussian of 0.85 px under the window of 1.06 px gives a bias of some thousandths (Poisson's
  // sum: 4 pi s^2 exp(-2 pi^2 s^2) with s = 0.66 px of their product is 0.001 px each axis).
  accuracy::expect_below("star centroid, bias over positions within a pixel",
                         "pixel-integrated Gaussians, static and smeared by 1.2 px, 900 positions", worst, 0.004, "px");
}

TEST(Centroid, IsUnbiasedForSharpAndForSoftLenses) {
  Detection d;
  d.detector = perfect();
  d.settings.gain_dn_per_electron = 1.0;
  for (const double sigma : {0.7, 1.0, 1.5, 2.0}) {
    d.settings.point_spread_sigma_px = sigma;
    const Errors e = errors_of(d, {.electrons = 6000.0 * sigma * sigma, .sigma_px = sigma}, 1);
    EXPECT_EQ(e.lost, 0);
    EXPECT_LT(e.worst, 0.01) << sigma;
  }
}

/// From the faintest stars of the catalogue (magnitude 7.5, 900 electrons) to the target at 75 km. 1125 centroids: a
/// standard deviation is known to 1.5 %, a mean to 0.03 of one.
TEST(Centroid, ScattersHardlyMoreThanItMustAndSaysHowMuch) {
  Detection d;
  accuracy::Largest worst_ratio;
  for (const double electrons : {450.0, 900.0, 3000.0, 20000.0, 100000.0}) {
    for (const double smear : {0.0, 1.2}) {
      const test::Point like{.electrons = electrons, .smear_y_px = smear};
      const Errors e = errors_of(d, like, 5);
      EXPECT_EQ(e.lost, 0) << electrons;
      worst_ratio.add(e.rms / cramer_rao(like, d.detector));
      EXPECT_NEAR(e.predicted, e.rms, 0.08 * e.rms) << electrons << " electrons";
      EXPECT_LT(std::hypot(e.mean_x, e.mean_y), 0.002 + 0.13 * e.rms) << electrons;
    }
  }
  accuracy::expect_below("star centroid, standard deviation over its lower bound, magnitudes 8.3 to 2.4",
                         "Cramer-Rao bound, 11,250 centroids", worst_ratio, 1.25, "relative");
}

/// The camera's target: the bearing's noise is to be below 15 arcsec and its bias below 3 (0.43 and 0.087 px at 34.5
/// arcsec a pixel). From magnitude 2.4 at 75 km to -7 at 1 km, where the disc is saturated.
TEST(Centroid, OfATargetThatSaturates) {
  Detection d;
  accuracy::Largest worst;
  for (double magnitude = 3.0; magnitude > -9.0; magnitude -= 1.0) {
    for (int k = 0; k < 25; ++k) {
      test::SyntheticImage scene(100, 100);
      const double x = 50.0 + (k % 5) / 5.0;
      const double y = 50.0 + (k / 5) / 5.0;
      add_lens_point(scene, x, y, electrons_of(magnitude));
      d.expose(scene);
      ASSERT_FALSE(d.objects->objects().empty());
      const DetectedObject& object = d.objects->objects()[0];
      EXPECT_EQ(object.is_saturated, magnitude < 2.0) << magnitude;
      worst.add(std::hypot(object.centroid_px.x() - x, object.centroid_px.y() - y));
    }
  }
  // What rounding of a disc's edge to pixels leaves: a disc of 3 px has some 10 pixels at its edge, each wrong by 0.3.
  accuracy::expect_below("centroid of a point from magnitude 3 to -8, saturated from 1.5 on",
                         "true position, 300 points with 1 % scattered light", worst, 0.087, "px");
}

TEST(Centroid, OfADiscIsItsMiddle) {
  Detection d;
  for (const double electrons : {4000.0, 1e6}) {
    test::SyntheticImage scene(300, 300);
    scene.add_light([&](int x, int y) { return std::hypot(x - 150.3, y - 140.8) < 20.5 ? electrons : 0.0; });
    double sum = 0.0;
    double sum_x = 0.0;
    double sum_y = 0.0;
    for (int y = 0; y < 300; ++y) {
      for (int x = 0; x < 300; ++x) {
        sum += scene.at(x, y);
        sum_x += x * scene.at(x, y);
        sum_y += y * scene.at(x, y);
      }
    }
    d.expose(scene);
    const DetectedObject* object = d.near(150.3, 140.8);
    ASSERT_NE(object, nullptr);
    // Against the middle of the pixels drawn; 1 sigma of it is below 0.01 px
    EXPECT_NEAR(object->centroid_px.x(), sum_x / sum, 0.03);
    EXPECT_NEAR(object->centroid_px.y(), sum_y / sum, 0.03);
    EXPECT_NEAR(object->radius_px, 20.5 / 2.0, 0.2);  // of a uniform disc: half its radius
  }
}

/// Charge that spills up and down the column of a saturated target must not draw its centroid away.
TEST(Centroid, OfATargetWithABloomingColumn) {
  Detection d;
  test::SyntheticImage scene(300, 300);
  for (int y = -20; y <= 20; ++y) {
    for (int x = -20; x <= 20; ++x) scene.at(150 + x, 140 + y) += 1e6;
  }
  for (int y = -55; y <= 55; ++y) scene.at(152, 140 + y) += 1e5;
  d.expose(scene);
  const DetectedObject* object = d.near(150.0, 140.0);
  ASSERT_NE(object, nullptr);
  EXPECT_TRUE(object->is_saturated);
  // Column of 70 pixels outside the box of 1681, 2 px off its middle: 0.08 px by moments.
  EXPECT_NEAR(object->centroid_px.x(), 150.0 + 2.0 * 70.0 / 1751.0, 0.02);
  EXPECT_NEAR(object->centroid_px.y(), 140.0, 0.02);
}

/// A star of magnitude 5.5 passes the target of magnitude 2.4: once it is 4 px away the target's bearing feels less
/// than 0.02 px of it.
TEST(Centroid, OfATargetBesideAStar) {
  Detection d;
  for (const double distance : {4.0, 5.0, 6.0, 8.0}) {
    test::SyntheticImage scene(120, 120);
    add_lens_point(scene, 60.2, 60.4, electrons_of(2.4));
    scene.add({60.2 + 0.8 * distance, 60.4 + 0.6 * distance, electrons_of(5.5), 0.8, 0.0, 1.2});
    d.expose(scene);
    const DetectedObject* object = d.near(60.2, 60.4);
    ASSERT_NE(object, nullptr);
    EXPECT_NEAR(object->centroid_px.x(), 60.2, 0.02) << distance;
    EXPECT_NEAR(object->centroid_px.y(), 60.4, 0.02) << distance;
  }
}

TEST(Centroid, OfTwoEqualStarsThatTouch) {
  Detection d;
  for (const double distance : {4.0, 5.0, 6.0, 9.0}) {
    for (int k = 0; k < 10; ++k) {
      test::SyntheticImage scene(120, 120);
      const double x = 50.0 + 0.1 * k;
      const double direction = 0.6 * k;
      const double dx = distance * std::cos(direction);
      const double dy = distance * std::sin(direction);
      scene.add({x, 60.0, 5000.0});
      scene.add({x + dx, 60.0 + dy, 5000.0});
      EXPECT_EQ(d.expose(scene).objects, 2) << distance;
      // Each draws the other's window by exp(-d^2 / (2 (0.85^2 + 1.06^2))) of the distance at most: 0.06 px at 4 px.
      ASSERT_NE(d.near(x, 60.0, 0.15), nullptr) << distance << " " << k;
      ASSERT_NE(d.near(x + dx, 60.0 + dy, 0.15), nullptr) << distance << " " << k;
      EXPECT_NEAR(d.near(x, 60.0)->flux_dn, 625.0, 60.0);
    }
  }
}

}  // namespace
}  // namespace vbar::fsw::imaging
