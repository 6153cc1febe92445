#include "host_sim/truth/event_location.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

namespace vbar::truth {
namespace {

TEST(EventLocation, FindsTheFirstChangeInEitherDirection) {
  const auto g = [](double t) { return std::sin(t); };
  EXPECT_NEAR(first_sign_change(g, 1.0, 10.0, 30, 1e-9).value(), M_PI, 2e-9);
  EXPECT_NEAR(first_sign_change(g, 10.0, 1.0, 30, 1e-9).value(), 3.0 * M_PI, 2e-9);
  EXPECT_FALSE(first_sign_change(g, 0.5, 3.0, 30, 1e-9).has_value());
}

TEST(EventLocation, ReturnsTheFarSideAndDoesNotFindAnEventTwice) {
  const auto g = [](double t) { return t * t * t - 2.0; };
  const double found = first_sign_change(g, 0.0, 3.0, 1, 1e-6).value();
  EXPECT_GE(g(found), 0.0);
  EXPECT_NEAR(found, std::cbrt(2.0), 1e-6);
  EXPECT_FALSE(first_sign_change(g, found, 3.0, 10, 1e-6).has_value());
  // A zero exactly at the start is an event already dealt with.
  EXPECT_FALSE(first_sign_change([](double t) { return t; }, 0.0, 1.0, 10, 1e-6).has_value());
  // A zero exactly at a sample is found there.
  EXPECT_EQ(first_sign_change([](double t) { return t - 0.5; }, 0.0, 1.0, 2, 1e-6).value(), 0.5);
}

TEST(EventLocation, RefusesNonsense) {
  const auto g = [](double t) { return t - 0.3; };
  EXPECT_THROW(first_sign_change(g, 0.0, 1.0, 0, 1e-6), std::invalid_argument);
  EXPECT_THROW(first_sign_change(g, 0.0, 1.0, 1, 0.0), std::invalid_argument);
  EXPECT_THROW(first_sign_change([](double) { return std::nan(""); }, 0.0, 1.0, 1, 1e-6), std::invalid_argument);
}

TEST(EventLocation, AtTheStartTheFunctionCountsAsPositive) {
  // An edge just located, whose function is still a little negative by rounding: not an exit.
  const auto rising = [](double t) { return t - 1e-9; };
  EXPECT_FALSE(first_exit(rising, 0.0, 1.0, 2, 1e-6).has_value());
  // But one that stays on the wrong side is left at once.
  const auto falling = [](double t) { return -1e-9 - t; };
  EXPECT_NEAR(first_exit(falling, 0.0, 1.0, 2, 1e-6).value(), 0.0, 1e-6);
}

TEST(EventLocation, FollowsADipBetweenSamplesToItsBottom) {
  // A parabola negative for `width` around any place between three samples, either way in time; found half to one
  // resolution beyond, and rounding.
  for (double width : {0.1, 1e-3, 1e-5}) {
    for (double centre : {0.07, 0.31, 0.48, 0.62, 0.9}) {
      const auto g = [&](double t) { return (t - centre) * (t - centre) - 0.25 * width * width; };
      EXPECT_NEAR(first_exit(g, 0.0, 1.0, 2, 1e-9).value(), centre - 0.5 * width, 1.001e-9);
      EXPECT_NEAR(first_exit(g, 1.0, 0.0, 2, 1e-9).value(), centre + 0.5 * width, 1.001e-9);
    }
  }
}

TEST(EventLocation, ADipThatDoesNotReachZeroIsNone) {
  const auto g = [](double t) { return (t - 0.4) * (t - 0.4) + 1e-9; };
  EXPECT_FALSE(first_exit(g, 0.0, 1.0, 2, 1e-6).has_value());
}

}  // namespace
}  // namespace vbar::truth
