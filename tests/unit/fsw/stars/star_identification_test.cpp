#include "fsw/stars/star_identification.h"

#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "tests/support/star_campaign.h"

namespace vbar::fsw::stars {
namespace {

constexpr double kArcsecond = 4.84813681109536e-6;
constexpr double kSigma = 0.1 / 5972.7;

const std::vector<sky::TrueStar>& the_sky() {
  static const auto stars = sky::read_sky(VBAR_SOURCE_DIR "/data/stars/hipparcos_v8.csv", 2011.55);
  return stars;
}


void expect_right(const sky::Tally& tally, int attitudes, double share) {
  EXPECT_GE(tally.identified, share * attitudes);
  EXPECT_EQ(tally.wrong_attitudes, 0);
  EXPECT_EQ(tally.wrong_stars, 0);
  // 8 objects, 2 stars a square degree that the magnitude gate admits, 16 arcsec of tolerance: one in 1000 attitudes; ten
  // times that would be a gate too wide.
  EXPECT_LE(tally.false_as_star, attitudes / 100);
}

TEST(StarIdentification, LostInSpaceInTheRegion) {
  expect_right(sky::fly(the_sky(), {.scene = {.camera = sky::kRegion}, .attitudes = 1000, .seed = 1}), 1000, 0.99);
}

TEST(StarIdentification, LostInSpaceInTheWholeField) {
  expect_right(sky::fly(the_sky(), {.scene = {.camera = sky::kFull}, .attitudes = 1000, .seed = 2}), 1000, 0.999);
}

TEST(StarIdentification, TrackingFromAPredictionInTheRegion) {
  expect_right(sky::fly(the_sky(), {.scene = {.camera = sky::kRegion}, .seed = 3, .prediction_error = 300 * kArcsecond}),
               1000, 0.999);
}

TEST(StarIdentification, TrackingFromAPredictionInTheWholeField) {
  expect_right(sky::fly(the_sky(), {.scene = {.camera = sky::kFull}, .seed = 4, .prediction_error = 300 * kArcsecond}),
               1000, 1.0);
}

}  // namespace
}  // namespace vbar::fsw::stars
