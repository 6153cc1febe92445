#include "host_sim/mission/word_search.h"

#include <gtest/gtest.h>

namespace vbar::mission::test {
namespace {

TEST(WordSearch, FindsWordsNotParts) {
  EXPECT_EQ(match_of("isp", "X display"), Match::kNone);
  EXPECT_EQ(match_of("hold", "acquisition_threshold_dbhz"), Match::kNone);
  EXPECT_EQ(match_of("hold", "safety.hold_distance_m"), Match::kWord);
  EXPECT_EQ(match_of("hold", "holdover"), Match::kWordStart);
  EXPECT_EQ(match_of("hold", "a threshold, then holdover, then a hold"), Match::kWord) << "the best of several";
}

TEST(WordSearch, IgnoresCaseAndFindsSeveralWords) {
  EXPECT_EQ(match_of("klobuchar", "Klobuchar, scaled"), Match::kWord);
  EXPECT_EQ(match_of("keep_out", "guidance.keep_out_radius_m"), Match::kWord);
  EXPECT_EQ(match_of("sensors.cam", "spacecraft.sensors.camera.period_s"), Match::kWordStart);
  EXPECT_EQ(match_of("_deg", "inclination_deg"), Match::kWord);
}

TEST(WordSearch, EndsOfTheText) {
  EXPECT_EQ(match_of("", "anything"), Match::kWord);
  EXPECT_EQ(match_of("longer than it", "it"), Match::kNone);
  EXPECT_EQ(match_of("it", "it"), Match::kWord);
  EXPECT_EQ(match_of("a", ""), Match::kNone);
}

TEST(WordSearch, MeansANameOrAPartOfOne) {
  const std::vector<std::string> names{"links.crosslink.loss_probability", "truth.csv position_error_m"};
  EXPECT_EQ(word_meant("crosslnk", names), " (did you mean crosslink?)");
  EXPECT_EQ(word_meant("positon_error", names), " (did you mean position_error_m?)");
  EXPECT_EQ(word_meant("probabilty", names), " (did you mean probability?)");
  EXPECT_EQ(word_meant("gravity_gradient", names), "");
}

}  // namespace
}  // namespace vbar::mission::test
