#include "fsw/guard/range_filter.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/figures.h"

namespace vbar::fsw::guard {
namespace {

GpsTime at(double s) {
  return GpsTime{} + nearest_duration(s);
}

TEST(RangeFilter, AConstantRangeIsKept) {
  RangeFilter filter;
  EXPECT_FALSE(filter.is_known());
  for (int k = 0; k < 500; ++k) filter.add(at(5.0 * k), 40.0);
  EXPECT_NEAR(filter.range_m(at(2500.0)), 40.0, 1e-9);
  EXPECT_NEAR(filter.range_rate(at(2500.0)), 0.0, 1e-12);
  EXPECT_TRUE(filter.has_rate());
}

// A range that shrinks by a constant share a second is a straight line of the logarithm: followed without a lag.
TEST(RangeFilter, FollowsASteadyApproach) {
  RangeFilter filter;
  const double rate = -3e-4;
  for (int k = 0; k <= 3000; ++k) filter.add(at(5.0 * k), 100.0 * std::exp(rate * 5.0 * k));
  const double range_m = 100.0 * std::exp(rate * 15000.0);
  EXPECT_NEAR(filter.range_m(at(15000.0)), range_m, 1e-3 * range_m);
  EXPECT_NEAR(filter.range_rate(at(15000.0)), rate * range_m, 0.01 * std::abs(rate * range_m));
}

// A tumbling target changes its size by a third in five minutes: a rate of 1e-3 a second if it were believed.
TEST(RangeFilter, AttitudesOfTheTargetAverageOut) {
  RangeFilter filter;
  accuracy::Largest largest;
  for (int k = 0; k < 4000; ++k) {
    const double t = 5.0 * k;
    filter.add(at(t), 10.0 * std::exp(0.15 * std::sin(2.0 * M_PI * t / 600.0)));
    if (filter.has_rate()) largest.add(std::abs(filter.range_rate(at(t))));
  }
  EXPECT_LT(largest, 10.0 / 2000.0);
}

TEST(RangeFilter, ALongGapBeginsAgain) {
  RangeFilter filter;
  for (int k = 0; k < 500; ++k) filter.add(at(5.0 * k), 40.0);
  filter.add(at(2495.0 + RangeFilter::kLongestGap_s + 1.0), 60.0);
  EXPECT_FALSE(filter.has_rate());
  EXPECT_NEAR(filter.range_m(filter.last()), 60.0, 1e-9);
}

TEST(RangeFilter, WhatIsNoRangeIsIgnored) {
  RangeFilter filter;
  filter.add(at(0.0), 40.0);
  filter.add(at(5.0), -1.0);
  filter.add(at(5.0), std::nan(""));
  filter.add(at(0.0), 80.0);
  EXPECT_EQ(filter.last(), at(0.0));
  EXPECT_NEAR(filter.range_m(at(0.0)), 40.0, 1e-9);
}

}  // namespace
}  // namespace vbar::fsw::guard
