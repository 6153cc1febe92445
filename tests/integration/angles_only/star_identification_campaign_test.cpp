// Star identification over 10,000 random attitudes: 0.1 pixel of noise, 8 objects that are no stars, stars to V 7.5.

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/support/accuracy.h"
#include "tests/support/paths.h"
#include "tests/support/sanitizers.h"
#include "tests/support/star_sky.h"

namespace vbar {
namespace {

constexpr double kArcsecond = 4.84813681109536e-6;
constexpr int kAttitudes = vbar::test::share_under_sanitizers(10'000);

const std::vector<sky::TrueStar>& the_sky() {
  static const auto stars = sky::read_sky(vbar::tests::source_path("data/stars/hipparcos_v8.csv"), 2011.55);
  return stars;
}

void expect_none_wrong(const sky::Tally& tally) {
  EXPECT_EQ(tally.wrong_attitudes, 0);
  EXPECT_EQ(tally.wrong_stars, 0);
}

TEST(StarIdentificationCampaign, WholeFieldLostInSpace) {
  const sky::Tally tally = sky::fly(the_sky(), {.scene = {.camera = sky::kFull}, .attitudes = kAttitudes, .seed = 11});
  expect_none_wrong(tally);
  accuracy::expect_below("stars lost in space, 18 x 12 degrees: attitudes not identified",
                         "10,000 random skies, star file through ERFA, 8 false objects", kAttitudes - tally.identified,
                         0.001 * kAttitudes, "of 10,000");
}

TEST(StarIdentificationCampaign, RegionLostInSpace) {
  const sky::Tally tally =
      sky::fly(the_sky(), {.scene = {.camera = sky::kRegion}, .attitudes = kAttitudes, .seed = 12});
  expect_none_wrong(tally);
  accuracy::expect_below("stars lost in space, 4.8 x 7.7 degrees: attitudes not identified",
                         "10,000 random skies, star file through ERFA, 8 false objects", kAttitudes - tally.identified,
                         0.01 * kAttitudes, "of 10,000");
}

TEST(StarIdentificationCampaign, RegionTracking) {
  const sky::Tally tally = sky::fly(
      the_sky(),
      {.scene = {.camera = sky::kRegion}, .attitudes = kAttitudes, .seed = 13, .prediction_error = 300 * kArcsecond});
  expect_none_wrong(tally);
  EXPECT_GE(tally.identified, 0.999 * kAttitudes);
  const double worst = accuracy::quantile(tally.boresight_error, 0.999);
  // 20 arcsec is what a bearing needs; noise of 3.45 arcsec over some 20 stars leaves about one, three and more with
  // few.
  accuracy::expect_below("boresight from stars, 999 of 1000 attitudes", "10,000 random skies, 0.1 px noise",
                         worst / kArcsecond, 5.0, "arcsec");
  // The covariance says what the errors are: mean of 3 degrees of freedom over 10,000 attitudes, 4 sigma = 0.1; the
  // catalogue's own sigma of 1 arcsec, which this sky does not have, takes 8 % off, the gate of 4 sigma nothing.
  const double mean = tally.squared_error / tally.identified;
  EXPECT_NEAR(mean, 3.0 * 3.45 * 3.45 / (3.45 * 3.45 + 1.0), 0.1);
}

TEST(StarIdentificationCampaign, NothingIsAcceptedWhereThereAreNoStars) {
  // All attitudes may come out, so that some 100,000 hypotheses are tried in a field of 30 objects.
  sky::Random random(14);
  auto identifier = std::make_unique<fsw::stars::StarIdentifier>();
  const fsw::stars::Field field{Eigen::Vector3d::UnitZ(), sky::kRegion.radius()};
  int accepted = 0;
  for (int k = 0; k < kAttitudes / 33; ++k) {
    const sky::Scene scene =
        sky::draw_scene({}, {.false_objects = 30}, Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero(), random);
    const auto objects = sky::observed(scene, 0.1 / 5972.7);
    if (identifier->lost_in_space(objects, field, Eigen::Vector3d::Zero()) == fsw::Status::kOk) ++accepted;
  }
  EXPECT_EQ(accepted, 0);
}

}  // namespace
}  // namespace vbar
