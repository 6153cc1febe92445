#include "fsw/stars/verification.h"

#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "tests/support/paths.h"
#include "tests/support/star_campaign.h"

namespace vbar::fsw::stars {
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
