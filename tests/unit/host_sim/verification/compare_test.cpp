// Which rows are named as worse, on samples of known distributions.
#include "host_sim/verification/compare.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "tests/unit/host_sim/verification/verification_record.h"

namespace vbar::verification {
namespace {

/// Ranks 0.5, 1.5 ... of `count` as values of a uniform distribution on (0, scale): no chance enters.
std::vector<double> uniform(std::size_t count, double scale) {
  std::vector<double> values;
  for (std::size_t k = 0; k < count; ++k) values.push_back(scale * (static_cast<double>(k) + 0.5) / count);
  return values;
}

TEST(Compare, NamesARowWhoseErrorsHaveDoubled) {
  const Json earlier = verification_of({flown_row("a", uniform(40, 1.0), 40), flown_row("b", uniform(40, 1.0), 40)});
  const Json later = verification_of({flown_row("a", uniform(40, 1.02), 40), flown_row("b", uniform(40, 2.0), 40)});
  const Comparison comparison = compare(earlier, later);
  EXPECT_EQ(comparison.tests, 4U);
  ASSERT_EQ(comparison.worse.size(), 1U);
  EXPECT_EQ(comparison.worse[0].row, "b");
  EXPECT_EQ(comparison.worse[0].what, "waypoints.10.navigation_error_m");
}

TEST(Compare, DoesNotNameARowThatIsBetter) {
  const Json earlier = verification_of({flown_row("a", uniform(40, 2.0), 40)});
  EXPECT_TRUE(compare(earlier, verification_of({flown_row("a", uniform(40, 1.0), 40)})).worse.empty());
}

// 30 of 40 against 40 of 40: C(40, 30) / C(80, 70) = 5.1e-4, twice that after Holm for two tests.
TEST(Compare, NamesAShareThatFell) {
  const Json earlier = verification_of({flown_row("a", uniform(40, 1.0), 40)});
  const Comparison comparison = compare(earlier, verification_of({flown_row("a", uniform(40, 1.0), 30)}));
  ASSERT_EQ(comparison.worse.size(), 1U);
  EXPECT_EQ(comparison.worse[0].what, "share of achieved cases");
  EXPECT_NE(text_of(comparison).find("75.0 %"), std::string::npos);
}

TEST(Compare, ComparesNoShareOfARowWithoutVerdict) {
  Json row = flown_row("a", uniform(4, 1.0), 0);
  row["achieved"]["of"] = 0;
  EXPECT_EQ(compare(verification_of({row}), verification_of({row})).tests, 1U);
}

TEST(Compare, StatesRowsThatCannotBeCompared) {
  const Json earlier = verification_of({unflown_row("a")});
  const Comparison comparison =
      compare(earlier, verification_of({flown_row("a", uniform(4, 1.0), 4), unflown_row("c")}));
  EXPECT_EQ(comparison.not_compared, (std::vector<std::string>{"a", "c"}));
  EXPECT_EQ(comparison.tests, 0U);
}

// The cases of a sweep share the noise of their seed: four seeds with ten cases each are four samples, not forty.
TEST(Compare, CountsTheCasesOfASeedOnce) {
  Json before = flown_row("a", uniform(40, 1.0), 40), after = flown_row("a", uniform(40, 2.0), 40);
  before["cases_per_seed"] = after["cases_per_seed"] = 10;
  const Comparison comparison = compare(verification_of({before}), verification_of({after}));
  EXPECT_EQ(comparison.tests, 1U);
  EXPECT_TRUE(comparison.worse.empty());
}

}  // namespace
}  // namespace vbar::verification
