#include "host_sim/sensors/camera/kept_truth.h"

#include <gtest/gtest.h>

namespace vbar::sensors {
namespace {

twins::TruthSnapshot truth_at(std::int64_t s) {
  twins::TruthSnapshot truth;
  truth.time = fsw::GpsTime{} + fsw::duration_of_seconds(s);
  truth.spacecraft.resize(1);
  truth.spacecraft[0].name = std::to_string(s);
  return truth;
}

TEST(KeptTruth, IsKeptUntilTakenHoweverManyFollow) {
  KeptTruth kept;
  for (std::int64_t s = 0; s < 1000; ++s) kept.keep(truth_at(s));
  const auto truth = kept.take(truth_at(0).time);
  ASSERT_TRUE(truth);
  EXPECT_EQ(truth->spacecraft[0].name, "0");
  EXPECT_EQ(kept.size(), 999U) << "released";
  EXPECT_EQ(kept.without_truth(), 0);
}

TEST(KeptTruth, TwoCamerasMayExposeAtTheSameTime) {
  KeptTruth kept;
  kept.keep(truth_at(1));
  kept.keep(truth_at(1));
  EXPECT_TRUE(kept.take(truth_at(1).time));
  EXPECT_TRUE(kept.take(truth_at(1).time));
}

TEST(KeptTruth, CountsImagesWithout) {
  KeptTruth kept;
  kept.keep(truth_at(1));
  EXPECT_FALSE(kept.take(truth_at(2).time));
  EXPECT_TRUE(kept.take(truth_at(1).time));
  EXPECT_FALSE(kept.take(truth_at(1).time)) << "told of twice";
  EXPECT_EQ(kept.without_truth(), 2);
}

}  // namespace
}  // namespace vbar::sensors
