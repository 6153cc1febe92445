// Counts and light of a display.

#include "hil_drivers/optical_stimulator/counts/display_light.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/figures.h"

namespace vbar::optical_stimulator {
namespace {

DisplayLight light_of(const DisplayResponse& response) {
  return {response, 2, 1, {100.0F, 50.0F}};
}

TEST(DisplayLight, FollowsThePowerLaw) {
  const DisplayLight light = light_of({2.0, 55.0, 1e4});
  EXPECT_EQ(light.fraction(255), 1.0);
  EXPECT_DOUBLE_EQ(light.fraction(155), 0.25);  // half of the range, squared
  EXPECT_EQ(light.fraction(55), 0.0);
  EXPECT_DOUBLE_EQ(light.fraction(56), 1.0 / 40000.0);
  EXPECT_DOUBLE_EQ(light.black_electrons(1, 0), 0.005);
}

TEST(DisplayLight, NearestCountIsThatOfALinearSearch) {
  const DisplayLight light = light_of({2.2, 3.3, 1e5});
  for (int k = 0; k <= 4000; ++k) {
    const double wanted = std::pow(10.0, -7.0 + 7.5 * k / 4000.0);
    accuracy::Smallest least;
    for (int count = 0; count <= 255; ++count) least.add(std::abs(light.fraction(count) - wanted));
    EXPECT_EQ(std::abs(light.fraction(light.nearest_count(wanted)) - wanted), least.value) << wanted;
  }
  EXPECT_EQ(light.nearest_count(0.0), 0);
  EXPECT_EQ(light.nearest_count(-1.0), 0);
  EXPECT_EQ(light.nearest_count(std::nan("")), 0);
  EXPECT_EQ(light.nearest_count(1e9), 255);
}

TEST(DisplayLight, StepsPassOverCountsWithoutLight) {
  const DisplayLight light = light_of({2.2, 3.3, 1e5});
  EXPECT_EQ(light.above(0), 4);
  EXPECT_EQ(light.below(4), 0);
  EXPECT_EQ(light.above(255), 255);
  EXPECT_EQ(light.below(0), 0);
}

TEST(DisplayLight, RefusesWhatNoDisplayHas) {
  const double nan = std::nan("");
  for (const DisplayResponse& response :
       {DisplayResponse{nan, 0.0, 1e5}, DisplayResponse{0.0, 0.0, 1e5}, DisplayResponse{2.2, nan, 1e5},
        DisplayResponse{2.2, 255.0, 1e5}, DisplayResponse{2.2, 0.0, nan}, DisplayResponse{2.2, -1.0, 1e5}})
    EXPECT_THROW(light_of(response), std::invalid_argument);
  EXPECT_THROW(DisplayLight({}, 2, 1, {1.0F}), std::invalid_argument);
  EXPECT_THROW(DisplayLight({}, 2, 1, {1.0F, 0.0F}), std::invalid_argument);
  EXPECT_THROW(DisplayLight({}, 2, 1, {1.0F, std::nanf("")}), std::invalid_argument);
}

}  // namespace
}  // namespace vbar::optical_stimulator
