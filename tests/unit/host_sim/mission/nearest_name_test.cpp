#include "host_sim/mission/nearest_name.h"

#include <gtest/gtest.h>

namespace vbar::mission::test {
namespace {

const std::vector<std::string_view> kNames{"gravity_degree", "gravity_order", "threads", "seed"};

TEST(NearestName, FindsSlipsOfTheKeyboard) {
  EXPECT_EQ(nearest_name("gravity_degre", kNames), "gravity_degree");  // left out
  EXPECT_EQ(nearest_name("gravity_odrer", kNames), "gravity_order");   // swapped
  EXPECT_EQ(nearest_name("treads", kNames), "threads");
  EXPECT_EQ(nearest_name("sead", kNames), "seed");  // replaced
  EXPECT_EQ(nearest_name("seed", kNames), "seed");
}

TEST(NearestName, GivesNoneForSomethingElse) {
  EXPECT_FALSE(nearest_name("colour", kNames).has_value());
  EXPECT_FALSE(nearest_name("", kNames).has_value());
  EXPECT_FALSE(nearest_name("seed", {}).has_value());
}

}  // namespace
}  // namespace vbar::mission::test
