#include "fsw/faults/persistence.h"

#include <gtest/gtest.h>

namespace vbar::fsw::faults {
namespace {

TEST(Persistence, RaisedByTheLimitWithinTheWindow) {
  Persistence p(3, 5);
  EXPECT_FALSE(p.add(true));
  EXPECT_FALSE(p.add(false));
  EXPECT_FALSE(p.add(true));
  EXPECT_FALSE(p.add(false));
  EXPECT_TRUE(p.add(true));
}

TEST(Persistence, DetectionsOutsideTheWindowDoNotCount) {
  Persistence p(2, 3);
  EXPECT_FALSE(p.add(true));
  EXPECT_FALSE(p.add(false));
  EXPECT_FALSE(p.add(false));
  EXPECT_FALSE(p.add(true));
}

TEST(Persistence, EndsWhenTheWholeWindowIsClear) {
  Persistence p(1, 3);
  EXPECT_TRUE(p.add(true));
  EXPECT_TRUE(p.add(false));
  EXPECT_TRUE(p.add(false));
  EXPECT_FALSE(p.add(false));
}

TEST(Persistence, LargestWindow) {
  Persistence p(64, 64);
  for (int k = 0; k < 63; ++k) EXPECT_FALSE(p.add(true)) << k;
  EXPECT_TRUE(p.add(true));
  for (int k = 0; k < 63; ++k) EXPECT_TRUE(p.add(false)) << k;
  EXPECT_FALSE(p.add(false));
}

TEST(Persistence, ResetForgetsEverything) {
  Persistence p(2, 4);
  p.add(true);
  p.reset();
  EXPECT_FALSE(p.add(true));
  EXPECT_TRUE(p.add(true));
  p.reset();
  EXPECT_FALSE(p.is_persistent());
}

}  // namespace
}  // namespace vbar::fsw::faults
