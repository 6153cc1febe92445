#include "fsw/vision/stars/star_identification.h"

#include <cmath>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "fsw/vision/stars/verification.h"
#include "tests/support/paths.h"
#include "tests/support/sanitizers.h"
#include "tests/support/star_sky.h"

namespace vbar::fsw::stars {

namespace {

constexpr double kArcsecond = 4.84813681109536e-6;
constexpr double kSigma = 0.1 / 5972.7;
constexpr int kThousand = vbar::test::share_under_sanitizers(1000);

const std::vector<sky::TrueStar>& the_sky() {
  static const auto stars = sky::read_sky(vbar::tests::source_path("data/stars/hipparcos_v8.csv"), 2011.55);
  return stars;
}

void expect_right(const sky::Tally& tally, int attitudes, double share) {
  EXPECT_LE(attitudes - tally.identified, std::ceil((1.0 - share) * attitudes));
  EXPECT_EQ(tally.wrong_attitudes, 0);
  EXPECT_EQ(tally.wrong_stars, 0);
  // 8 objects, 2 stars a square degree that the magnitude gate admits, 16 arcsec of tolerance: one in 1000 attitudes;
  // ten times that would be a gate too wide.
  EXPECT_LE(tally.false_as_star, attitudes / 100 + 1);
}

TEST(StarIdentification, LostInSpaceInTheRegion) {
  expect_right(sky::fly(the_sky(), {.scene = {.camera = sky::kRegion}, .attitudes = kThousand, .seed = 1}), kThousand,
               0.99);
}

TEST(StarIdentification, LostInSpaceInTheWholeField) {
  expect_right(sky::fly(the_sky(), {.scene = {.camera = sky::kFull}, .attitudes = kThousand, .seed = 2}), kThousand,
               0.999);
}

TEST(StarIdentification, TrackingFromAPredictionInTheRegion) {
  expect_right(
      sky::fly(
          the_sky(),
          {.scene = {.camera = sky::kRegion}, .attitudes = kThousand, .seed = 3, .prediction_error = 300 * kArcsecond}),
      kThousand, 0.999);
}

TEST(StarIdentification, TrackingFromAPredictionInTheWholeField) {
  expect_right(
      sky::fly(
          the_sky(),
          {.scene = {.camera = sky::kFull}, .attitudes = kThousand, .seed = 4, .prediction_error = 300 * kArcsecond}),
      kThousand, 1.0);
}

const Vector3 kStill = Vector3::Zero();

Field field_of(const sky::Camera& camera) {
  return {Vector3::UnitZ(), camera.radius()};
}

/// 30 objects anywhere in the field, none a star.
std::vector<ObservedStar> draw_false_field(const sky::Camera& camera, sky::Random& random) {
  const sky::SceneSettings settings{.camera = camera, .faintest = 7.5, .false_objects = 30};
  return sky::observed(sky::draw_scene({}, settings, Matrix3::Identity(), kStill, random), kSigma);
}

TEST(StarIdentification, AcceptsNothingWhereThereAreNoStars) {
  sky::Random random(31);
  auto identifier = std::make_unique<StarIdentifier>();
  for (int k = 0; k < vbar::test::share_under_sanitizers(30); ++k) {
    const auto objects = draw_false_field(sky::kRegion, random);
    EXPECT_EQ(identifier->lost_in_space(objects, field_of(sky::kRegion), kStill), Status::kDidNotConverge);
  }
  for (int k = 0; k < kThousand; ++k) {
    const auto objects = draw_false_field(sky::kRegion, random);
    const Matrix3 predicted = sky::random_rotation(random);
    EXPECT_EQ(identifier->track(objects, field_of(sky::kRegion), predicted, 300 * kArcsecond, kStill),
              Status::kDidNotConverge);
  }
}

TEST(StarIdentification, StarsOfAnotherPlaceAreNotThoseOfThePrediction) {
  // A prediction that is wrong by far more than its tolerance must be refused, however many stars there are.
  sky::Random random(32);
  auto identifier = std::make_unique<StarIdentifier>();
  for (int k = 0; k < 300; ++k) {
    const Matrix3 truth = sky::random_rotation(random);
    const sky::Scene scene = sky::draw_scene(the_sky(), {.camera = sky::kFull}, truth, kStill, random);
    const Matrix3 predicted = sky::small_rotation({0.02, -0.03, 0.05}) * truth;
    EXPECT_EQ(
        identifier->track(sky::observed(scene, kSigma), field_of(sky::kFull), predicted, 300 * kArcsecond, kStill),
        Status::kDidNotConverge);
  }
}

TEST(StarIdentification, FindsItsWayAmongManyBrightFalseObjects) {
  // The target, two other satellites, and hot pixels of any brightness: 25 objects, most of them brighter than all
  // stars.
  const sky::SceneSettings scene{.camera = sky::kRegion, .false_objects = 25, .brightest_false = -7.0};
  const sky::Tally lost = sky::fly(the_sky(), {.scene = scene, .attitudes = kThousand / 5, .seed = 33});
  expect_right(lost, kThousand / 5, 0.99);
  const sky::Tally tracked = sky::fly(
      the_sky(), {.scene = scene, .attitudes = kThousand / 2, .seed = 34, .prediction_error = 300 * kArcsecond});
  expect_right(tracked, kThousand / 2, 0.999);
}

TEST(StarIdentification, ManagesWithAZeroPointHalfAMagnitudeOff) {
  sky::Random random(35);
  auto identifier = std::make_unique<StarIdentifier>();
  int found = 0;
  for (int k = 0; k < 200; ++k) {
    const Matrix3 truth = sky::random_rotation(random);
    const sky::Scene scene = sky::draw_scene(the_sky(), {}, truth, kStill, random);
    auto objects = sky::observed(scene, kSigma);
    for (ObservedStar& object : objects) object.magnitude += 0.5;
    if (identifier->lost_in_space(objects, field_of(sky::kRegion), kStill) != Status::kOk) continue;
    ++found;
    EXPECT_LT(sky::normalised_squared_error(identifier->fix(), truth), 36.0);
    EXPECT_NEAR(identifier->fix().magnitude_offset, 0.5, 0.4);  // median of some 20 with 0.3 each
  }
  EXPECT_GE(found, 198);
}

TEST(StarIdentification, WithoutAberrationTheAttitudeIsOffByIt) {
  // An observer at 30 km/s sees all stars of a small field shifted alike, so leaving it out turns the attitude by as
  // much as v/c times the sine of the angle to the motion, up to 20.6 arcsec.
  sky::Random random(36);
  auto identifier = std::make_unique<StarIdentifier>();
  for (int k = 0; k < 50; ++k) {
    const Matrix3 truth = sky::random_rotation(random);
    const Vector3 velocity = 1.0e-4 * sky::random_rotation(random).row(0).transpose();
    const sky::Scene scene = sky::draw_scene(the_sky(), {.camera = sky::kFull, .noise_px = 0.01, .false_objects = 0},
                                             truth, velocity, random);
    const auto objects = sky::observed(scene, kSigma);
    const auto boresight_error = [&] { return (identifier->fix().R_camera_eci.row(2) - truth.row(2)).norm(); };
    ASSERT_EQ(identifier->track(objects, field_of(sky::kFull), truth, 300 * kArcsecond, velocity), Status::kOk);
    EXPECT_LT(boresight_error(), 0.3 * kArcsecond);
    ASSERT_EQ(identifier->track(objects, field_of(sky::kFull), truth, 300 * kArcsecond, kStill), Status::kOk);
    const Vector3 boresight = truth.row(2);
    EXPECT_NEAR(boresight_error(), (velocity - velocity.dot(boresight) * boresight).norm(), 0.5 * kArcsecond);
  }
}

TEST(StarIdentification, HalfAnImageIsEnoughIfItHasSixStars) {
  sky::Random random(37);
  auto identifier = std::make_unique<StarIdentifier>();
  int with_six = 0, found = 0;
  for (int k = 0; k < 300; ++k) {
    const Matrix3 truth = sky::random_rotation(random);
    const sky::Scene scene = sky::draw_scene(the_sky(), {}, truth, kStill, random);
    std::vector<ObservedStar> objects;
    int stars = 0;
    for (std::size_t o = 0; o < scene.direction.size(); ++o) {
      if (scene.direction[o].y() < 0.0) continue;
      objects.push_back({scene.direction[o], kSigma, scene.magnitude[o]});
      if (scene.truth[o] != nullptr) ++stars;
    }
    if (stars < 6) continue;
    ++with_six;
    if (identifier->track(objects, field_of(sky::kRegion), truth, 300 * kArcsecond, kStill) != Status::kOk) continue;
    ++found;
    EXPECT_LT(sky::normalised_squared_error(identifier->fix(), truth), 36.0);
  }
  EXPECT_GE(with_six, 200);
  EXPECT_GE(found, with_six - 1);  // one in 10,000 residual tests refuses a star, one in 3000 stars is beyond its gate
}

TEST(StarIdentification, AVagueObjectOnAStarDoesNoHarm) {
  // The target, saturated and wide, stands on a star: its centroid is off and its sigma says so, or does not.
  sky::Random random(38);
  auto identifier = std::make_unique<StarIdentifier>();
  for (int k = 0; k < 100; ++k) {
    const Matrix3 truth = sky::random_rotation(random);
    const sky::Scene scene = sky::draw_scene(the_sky(), {.false_objects = 0}, truth, kStill, random);
    auto objects = sky::observed(scene, kSigma);
    objects[0].direction_camera = (objects[0].direction_camera + Vector3(40 * kArcsecond, 0, 0)).normalized();
    objects[0].magnitude = -3.0;
    if (k % 2 == 0) objects[0].sigma_rad = 200 * kArcsecond;
    ASSERT_EQ(identifier->track(objects, field_of(sky::kRegion), truth, 300 * kArcsecond, kStill), Status::kOk);
    EXPECT_LT(sky::normalised_squared_error(identifier->fix(), truth), 36.0);
    for (int m = 0; m < identifier->fix().matches; ++m) {
      EXPECT_NE(identifier->fix().match[static_cast<std::size_t>(m)].object, 0);
    }
  }
}

TEST(StarIdentification, DoesNotDependOnWhatWasAskedBefore) {
  sky::Random random(39);
  const sky::Scene one = sky::draw_scene(the_sky(), {}, sky::random_rotation(random), kStill, random);
  const sky::Scene other = sky::draw_scene(the_sky(), {}, sky::random_rotation(random), kStill, random);
  const Field field = field_of(sky::kRegion);
  auto fresh = std::make_unique<StarIdentifier>();
  ASSERT_EQ(fresh->lost_in_space(sky::observed(one, kSigma), field, kStill), Status::kOk);
  auto used = std::make_unique<StarIdentifier>();
  ASSERT_EQ(used->track(sky::observed(other, kSigma), field, other.R_camera_eci, 300 * kArcsecond, kStill),
            Status::kOk);
  ASSERT_EQ(used->lost_in_space(sky::observed(one, kSigma), field, kStill), Status::kOk);
  EXPECT_EQ(used->fix().R_camera_eci, fresh->fix().R_camera_eci);  // the same bits
  EXPECT_EQ(used->fix().matches, fresh->fix().matches);
}

TEST(StarIdentification, RefusesWhatIsNoImage) {
  auto identifier = std::make_unique<StarIdentifier>();
  const Field field = field_of(sky::kRegion);
  const auto lost = [&](const std::vector<ObservedStar>& objects) {
    return identifier->lost_in_space(objects, field, kStill);
  };
  const auto tracked = [&](const std::vector<ObservedStar>& objects, double tolerance = 1e-3) {
    return identifier->track(objects, field, Matrix3::Identity(), tolerance, kStill);
  };
  const ObservedStar good{Vector3::UnitZ(), kSigma, 5.0};
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(lost({}), Status::kDidNotConverge);
  EXPECT_EQ(tracked({}), Status::kDidNotConverge);
  EXPECT_EQ(lost({good}), Status::kDidNotConverge);
  EXPECT_EQ(lost(std::vector<ObservedStar>(256, good)), Status::kDidNotConverge);  // all in one place
  EXPECT_EQ(tracked(std::vector<ObservedStar>(256, good)), Status::kDidNotConverge);
  EXPECT_EQ(lost(std::vector<ObservedStar>(257, good)), Status::kTooLong);
  EXPECT_EQ(tracked(std::vector<ObservedStar>(257, good)), Status::kTooLong);
  EXPECT_EQ(lost({good, {Vector3(kNan, 0, 1), kSigma, 5.0}}), Status::kNotFinite);
  EXPECT_EQ(lost({good, {Vector3::UnitZ(), kNan, 5.0}}), Status::kNotFinite);
  EXPECT_EQ(lost({good, {Vector3::UnitZ(), kSigma, kNan}}), Status::kNotFinite);
  EXPECT_EQ(lost({good, {Vector3::UnitZ(), 0.0, 5.0}}), Status::kInvalidArgument);
  EXPECT_EQ(tracked({good}, 0.0), Status::kInvalidArgument);
  EXPECT_EQ(tracked({good}, 0.1), Status::kOutOfRange);
  EXPECT_EQ(tracked({good}, kNan), Status::kNotFinite);
  EXPECT_EQ(identifier->lost_in_space(std::vector{good}, {Vector3::UnitZ(), 0.0}, kStill), Status::kInvalidArgument);
}

}  // namespace

namespace {

TEST(Verification, ChanceIsBoundedFromAboveAndNotByMuch) {
  // Against the tail of Poisson's distribution, summed.
  for (const double expected : {1e-4, 1e-3, 0.01, 0.1, 1.0}) {
    for (int count = 2; count < 15; ++count) {
      double tail = 0.0;
      for (int k = count; k < count + 60; ++k)
        tail += std::exp(-expected + k * std::log(expected) - std::lgamma(k + 1.0));
      const double bound = log_chance_of(count, expected);
      EXPECT_GE(bound, std::log(tail) - 1e-12);
      // Stirling: the bound leaves out a factor of the root of 2 pi count.
      EXPECT_LE(bound, std::log(tail) + 0.5 * std::log(2.0 * 3.1416 * count) + 0.6);
    }
  }
  EXPECT_EQ(log_chance_of(0, 0.1), 0.0);
  EXPECT_EQ(log_chance_of(1, 2.0), 0.0);
  EXPECT_LT(log_chance_of(3, 0.0), -100.0);
}

TEST(MagnitudeGate, LetsSaturatedStarsBeTooFaint) {
  const MagnitudeGate gate{.offset = 0.5, .width = 1.0};
  EXPECT_TRUE(gate.admits(7.4, 6.0));
  EXPECT_FALSE(gate.admits(7.6, 6.0));
  EXPECT_TRUE(gate.admits(5.6, 6.0));
  EXPECT_FALSE(gate.admits(5.4, 6.0));
  EXPECT_TRUE(gate.admits(5.0, 1.0));   // three magnitudes too faint: saturated
  EXPECT_FALSE(gate.admits(0.0, 1.0));  // but not too bright
}

TEST(Verification, RefusesAnAttitudeThatIsWrong) {
  const auto sky = sky::read_sky(vbar::tests::source_path("data/stars/hipparcos_v8.csv"), 2011.55);
  auto verification = std::make_unique<Verification>();
  sky::Random random(21);
  AttitudeFix fix;
  for (int k = 0; k < 100; ++k) {
    const Eigen::Matrix3d truth = sky::random_rotation(random);
    const sky::Scene scene = sky::draw_scene(sky, {}, truth, Eigen::Vector3d::Zero(), random);
    const auto objects = sky::observed(scene, 0.1 / 5972.7);
    const Field field{Vector3::UnitZ(), sky::kRegion.radius()};
    const auto verify = [&](const Matrix3& supposed) {
      return verification->verify(objects, field, Vector3::Zero(), {supposed, 7e-5, 2, 1000}, fix);
    };
    EXPECT_EQ(verify(truth), Status::kOk);
    EXPECT_EQ(verify(sky::random_rotation(random)), Status::kDidNotConverge);
    EXPECT_EQ(verify(sky::small_rotation({0.003, 0.0, 0.0}) * truth), Status::kDidNotConverge);
  }
}

}  // namespace

}  // namespace vbar::fsw::stars
