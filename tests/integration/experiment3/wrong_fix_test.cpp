// Wrong integers: held on purpose, and made by slips that no receiver tells of.

#include <algorithm>

#include <gtest/gtest.h>

#include "host_sim/twins/gnss/body_frame.h"
#include "tests/integration/experiment3/emulated_pair.h"

namespace vbar::test {
namespace {

constexpr double kLargestMove_m = 0.05;  // what a wrong fix may cost

const CoastingPair& wrong_fix_coast() {
  static const CoastingPair pair(900);
  return pair;
}

/// Three times what the unknown places of both antennas alone leave of a position, root mean square.
double settled_m() {
  const twins::gnss::BodyFrameSettings body;
  return 3.0 * twins::gnss::static_floor_rms_m(body, body);
}

/// Held before the filter itself would have: the first epochs with phases.
class WrongFix : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(AfterEpochs, WrongFix, ::testing::Values(11, 13));

// The one most likely to be taken for the right one. It differs from that by a cycle of one satellite, and two epochs
// are enough for the others to outvote it.
TEST_P(WrongFix, TheSecondBestIntegersAreFoundOut) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    EmulatedPair pair(wrong_fix_coast(), seed);
    pair.fly(GetParam());
    ASSERT_TRUE(pair.hold_second_best()) << seed;
    ASSERT_GT(pair.wrong_integers(), 0) << seed;
    EXPECT_LT(pair.position_error_m(), kLargestMove_m) << seed;
    const auto said = [&] { return pair.carrier().counters().slips + pair.carrier().counters().phases_rejected; };
    const std::int32_t before = said();
    for (int epoch = 0; epoch < 2; ++epoch) {
      pair.fly();
      EXPECT_LT(pair.position_error_m(), kLargestMove_m) << seed;
    }
    EXPECT_GT(said(), before) << seed;
    while (!pair.done()) {
      pair.fly();
      EXPECT_EQ(pair.wrong_integers(), 0) << seed << " at " << pair.elapsed_s() << " s";
    }
    EXPECT_TRUE(pair.is_fixed()) << seed;
    EXPECT_LT(pair.position_error_m(), settled_m()) << seed;
  }
}

// No decision would take these: half of all satellites a cycle off, which moves the position by decimetres at once. The
// next epoch contradicts them, everything is given up, and the position with it.
TEST_P(WrongFix, AGrossMistakeIsGivenUpAtOnce) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    EmulatedPair pair(wrong_fix_coast(), seed);
    pair.fly(GetParam());
    ASSERT_TRUE(pair.hold_shifted(1.0)) << seed;
    ASSERT_GT(pair.wrong_integers(), 5) << seed;
    pair.fly();
    EXPECT_EQ(pair.carrier().report().releases, 1) << seed;
    EXPECT_FALSE(pair.is_fixed()) << seed;
    EXPECT_EQ(pair.navigation().state().source, fsw::gnc::NavigationSource::kGnssFloat) << seed;
    pair.fly(30);  // what a warm start may take
    EXPECT_TRUE(pair.is_fixed()) << seed;
    while (!pair.done()) {
      EXPECT_EQ(pair.wrong_integers(), 0) << seed << " at " << pair.elapsed_s() << " s";
      pair.fly();
    }
    EXPECT_LT(pair.position_error_m(), settled_m()) << seed;
  }
}

// Three slips an hour of every signal, a hundred times as many as a receiver has, and it tells of none of them.
TEST(UnseenSlips, NeverStayInAHeldInteger) {
  const char* kTracking = "sensors.gnss.tracking";
  std::vector<std::string> overrides;
  for (const std::string spacecraft : {"servicer", "target"}) {
    const std::string tracking = "spacecraft." + spacecraft + "." + kTracking;
    overrides.push_back(tracking + ".cycle_slips_per_hour=3.0");
    overrides.push_back(tracking + ".undetected_slip_fraction=1.0");
  }
  std::int32_t found = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    EmulatedPair pair(wrong_fix_coast(), seed, overrides);
    bool was_fixed = false;
    while (!pair.done()) {
      pair.fly();
      if (!pair.valid()) continue;
      was_fixed = was_fixed || pair.is_fixed();
      EXPECT_EQ(pair.wrong_integers(), 0) << seed << " at " << pair.elapsed_s() << " s";
      if (was_fixed) {
        EXPECT_LT(pair.position_error_m(), kLargestMove_m) << seed << " at " << pair.elapsed_s() << " s";
      }
    }
    EXPECT_TRUE(pair.is_fixed()) << seed;
    found += pair.carrier().counters().slips;
  }
  EXPECT_GT(found, 200);  // ten flights of a quarter of an hour, two receivers, twenty signals and more: 300
}

}  // namespace
}  // namespace vbar::test
