// What angles-only tracking makes of the camera's images, against where camera and target truly were.

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tests/integration/angles_only/image_chain.h"
#include "tests/support/accuracy.h"

namespace vbar::test {
namespace {

using fsw::Vector3;
using fsw::angles_only::SightingStatus;

/// Errors of the bearings and attitudes of a series of images.
struct Errors {
  int attitudes = 0, bearings = 0, wrong = 0;
  double boresight_arcsec = 0.0;  ///< root mean square, each axis across
  double noise_arcsec = 0.0;      ///< 1 sigma, each axis
  Vector3 bias_arcsec = Vector3::Zero();
};

Errors errors_of(ImageChain& chain, SceneMaker& scenes, int images, double range_m) {
  Errors errors;
  std::vector<Vector3> bearing_errors;
  double boresight2 = 0.0;
  for (int k = 0; k < images; ++k) {
    const Scene scene = scenes.next(range_m);
    const auto& sighting = chain.look(scene);
    if (sighting.stars > 0) {
      ++errors.attitudes;
      boresight2 += (sighting.R_camera_eci.row(2) - scene.R_camera_eci.row(2)).squaredNorm() / 2.0;
    }
    if (sighting.status != SightingStatus::kBearing) continue;
    ++errors.bearings;
    bearing_errors.push_back(scene.R_camera_eci * (sighting.bearing.direction_eci - scene.target_direction()) /
                             kArcsec);
    if (!(bearing_errors.back().norm() <= 60.0)) ++errors.wrong;
  }
  errors.boresight_arcsec = std::sqrt(boresight2 / errors.attitudes) / kArcsec;
  for (const Vector3& error : bearing_errors) errors.bias_arcsec += error / errors.bearings;
  double square = 0.0;
  for (const Vector3& error : bearing_errors) square += (error - errors.bias_arcsec).squaredNorm() / 2.0;
  errors.noise_arcsec = std::sqrt(square / errors.bearings);
  return errors;
}

// The paper's figures are 35 arcsec of angle and 20 of attitude; the limits here are what far-range control needs. The
// light of a half-lit sphere of 0.7 m comes from 0.2 m beside its centre: 1.6 arcsec at 25 km, 8 at 5 km. That is no
// error of the bearing, and left to the filter, which estimates it.
TEST(ImageToBearing, AttitudeAndBearingOfAnUnresolvedTarget) {
  ImageChain chain;
  SceneMaker scenes;
  for (const int range_km : {75, 50, 25}) {
    const Errors errors = errors_of(chain, scenes, 50, 1e3 * range_km);
    // A quarter of an hour in a hundred minutes is dark, and what was not seen for long must be seen three times.
    EXPECT_GE(errors.bearings, 28) << range_km;
    EXPECT_EQ(errors.attitudes, 50) << range_km;
    EXPECT_EQ(errors.wrong, 0) << range_km;
    const std::string at = ", target " + std::to_string(range_km) + " km away";
    const std::string reference = "the truth, 50 images of 500x800 px";
    accuracy::expect_below("attitude from stars" + at, reference, errors.boresight_arcsec, 5.0, "arcsec");
    accuracy::expect_below("noise of bearings" + at, reference, errors.noise_arcsec, 15.0, "arcsec");
    accuracy::expect_below("bias of bearings" + at, reference, errors.bias_arcsec.norm(), 3.0, "arcsec");
  }
}

// Every camera has its own hot pixels, and none of them may keep the stars from being known.
TEST(ImageToBearing, EveryCameraKnowsItsStars) {
  for (std::uint64_t seed = 2; seed <= 6; ++seed) {
    ImageChain chain(seed);
    SceneMaker scenes(static_cast<unsigned>(seed));
    const Errors errors = errors_of(chain, scenes, 20, 60e3);
    EXPECT_EQ(errors.attitudes, 20) << "seed " << seed;
    EXPECT_EQ(errors.wrong, 0) << "seed " << seed;
  }
}

// The same image twice over, its tiles in another order: the same bits.
TEST(ImageToBearing, OrderOfTilesDoesNotMatter) {
  SceneMaker scenes;
  const Scene scene = scenes.next(50e3);
  ImageChain one, other;
  const auto& first = one.look(scene);
  const auto& second = other.look(scene, [](std::vector<image_tile>& tiles) { std::ranges::reverse(tiles); });
  ASSERT_GT(first.stars, 0);
  EXPECT_EQ(first.stars, second.stars);
  EXPECT_EQ(first.R_camera_eci, second.R_camera_eci);
}

}  // namespace
}  // namespace vbar::test
