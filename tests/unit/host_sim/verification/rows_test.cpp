// Order of the rows and what a budget buys.
#include "host_sim/verification/rows.h"

#include <gtest/gtest.h>

#include "host_sim/simulation/exit_codes.h"

namespace vbar::verification {
namespace {

Row row(const std::string& name, std::size_t seeds, double case_s, std::size_t requirements) {
  Row made{name, {}};
  made.campaign.seeds.resize(seeds);
  made.campaign.expected_case_s = case_s;
  made.campaign.requirements.resize(requirements);
  return made;
}

TEST(Budget, IsSharedEquallyAndWhatIsLeftGoesToTheOthers) {
  const std::vector<Row> rows{row("cheap", 100, 1.0, 5), row("dear", 100, 50.0, 5), row("dearer", 10, 100.0, 5)};
  // 1300 s: all of 100 s, then 600 s for each of the others.
  EXPECT_EQ(seeds_within(rows, 1300.0), (std::vector<std::size_t>{100, 12, 6}));
  EXPECT_EQ(seeds_within(rows, 1e9), (std::vector<std::size_t>{100, 100, 10}));
  EXPECT_EQ(seeds_within(rows, 0.0), (std::vector<std::size_t>{0, 0, 0}));
}

TEST(Budget, ThatIsTooSmallForARowGoesToTheFirstThatFits) {
  const std::vector<Row> rows{row("a", 10, 60.0, 5), row("b", 10, 60.0, 5)};
  EXPECT_EQ(seeds_within(rows, 100.0), (std::vector<std::size_t>{1, 0}));
}

TEST(Budget, CountsTheSeedsThatAreLeft) {
  std::vector<Row> rows{row("a", 10, 10.0, 5)};
  rows[0].flown_seeds = 8;
  EXPECT_EQ(seeds_within(rows, 1000.0), (std::vector<std::size_t>{2}));
}

TEST(Order, IsByRequirementsForEachMinuteAndEndsWithWhatIsFlown) {
  std::vector<Row> rows{row("flown", 1, 1.0, 9), row("slow", 10, 60.0, 10), row("fast", 10, 6.0, 10)};
  rows[0].flown_seeds = 1;
  order_by_value(rows);
  EXPECT_EQ(rows[0].name, "fast");
  EXPECT_EQ(rows[1].name, "slow");
  EXPECT_EQ(rows[2].name, "flown");
}

TEST(Selection, TakesFoldersAndRefusesUnknownNames) {
  const std::vector<Row> rows{row("a", 1, 1.0, 1), row("regressions/b", 1, 1.0, 1), row("sample/c", 1, 1.0, 1)};
  EXPECT_EQ(selected_rows(rows, {}).size(), 2U);
  EXPECT_EQ(selected_rows(rows, {"sample"}).size(), 1U);
  EXPECT_THROW(static_cast<void>(selected_rows(rows, {"d"})), app::Refused);
}

}  // namespace
}  // namespace vbar::verification
