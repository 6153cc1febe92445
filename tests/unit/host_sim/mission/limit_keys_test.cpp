// [[limit]]: what is read, what is refused, and that nothing else of a mission is needed to read it.

#include <array>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/host_sim/mission/mission_text.h"

namespace vbar::mission::test {
namespace {

std::string with_limits(const std::string& tables) {
  return std::string(kSmallMission) + tables;
}

TEST(LimitKeys, AreReadInTheOrderOfTheFile) {
  const auto limits = parse_mission(with_limits("[[limit]]\nkey = \"dv_mps\"\nmost = 4.2\n"
                                                "[[limit]]\nkey = \"waypoints.10.nees\"\nleast = 0.5\nmost = 7.8\n"),
                                    "m.toml")
                          .limits;
  ASSERT_EQ(limits.size(), 2U);
  EXPECT_EQ(limits[0].key, "dv_mps");
  EXPECT_EQ(limits[0].most, 4.2);
  EXPECT_FALSE(limits[0].least);
  EXPECT_EQ(limits[1].least, 0.5);
  EXPECT_TRUE(parse_mission(std::string(kSmallMission), "m.toml").limits.empty());
}

TEST(LimitKeys, RefuseALimitThatCannotBeMetOrSaysNothing) {
  const auto refusal = [](const std::string& tables) { return message_of(with_limits(tables)); };
  EXPECT_THAT(refusal("[[limit]]\nkey = \"a\"\n"), testing::HasSubstr("neither most nor least"));
  EXPECT_THAT(refusal("[[limit]]\nmost = 1\n"), testing::HasSubstr("limit.0.key"));
  EXPECT_THAT(refusal("[[limit]]\nkey = \"a\"\nmost = 1\nleast = 2\n"), testing::HasSubstr("limit.0.least"));
  EXPECT_THAT(refusal("[[limit]]\nkey = \"a\"\nmost = nan\n"), testing::HasSubstr("limit.0.most"));
  EXPECT_THAT(refusal("[[limit]]\nkey = \"a\"\nmost = 1\nmax = 1\n"), testing::HasSubstr("max"));
  EXPECT_THAT(refusal("[[limit]]\nkey = \"a\"\nmost = 1\n[[limit]]\nkey = \"a\"\nleast = 0\n"),
              testing::HasSubstr("limit.1.key"));
}

TEST(LimitKeys, OfAFileAloneNeedNothingElseOfTheMission) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "vbar_limits_only.toml";
  std::ofstream(file) << "[[limit]]\nkey = \"dv_mps\"\nmost = 4.2\n";
  const std::array<std::string, 1> overrides{"limit=[{key=\"dv_mps\", most=1.0}]"};
  EXPECT_EQ(load_limits(file, {}).at(0).most, 4.2);
  EXPECT_EQ(load_limits(file, overrides).at(0).most, 1.0);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace vbar::mission::test
