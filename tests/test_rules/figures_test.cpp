// What is measured over many cases retains a NaN, wherever among them it stands, and fails every comparison with it.

#include "tests/support/figures.h"

#include <cmath>
#include <limits>
#include <sstream>

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include "tests/support/accuracy.h"

namespace vbar::accuracy {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(Largest, OfNumbersIsTheirLargest) {
  Largest largest;
  EXPECT_EQ(largest, 0.0);
  largest.add(0.5, 3.0, 2);
  EXPECT_EQ(largest, 3.0);
  EXPECT_LT(largest, 3.5);
  Largest of_negative(-10.0);
  of_negative.add(-4.0F);
  EXPECT_EQ(of_negative, -4.0);
  std::ostringstream text;
  text << largest;
  EXPECT_EQ(text.str(), "3");
}

TEST(Smallest, OfNumbersIsTheirSmallest) {
  Smallest smallest;
  EXPECT_EQ(smallest, std::numeric_limits<double>::infinity());
  smallest.add(2.0, -7.0, 3.0);
  EXPECT_EQ(smallest, -7.0);
}

TEST(Largest, RetainsANanFromAnyPlace) {
  for (int place = 0; place < 3; ++place) {
    Largest largest;
    Smallest smallest;
    for (int k = 0; k < 3; ++k) {
      largest.add(k == place ? kNan : 1.0);
      smallest.add(k == place ? kNan : 1.0);
    }
    EXPECT_TRUE(std::isnan(largest)) << place;
    EXPECT_TRUE(std::isnan(smallest)) << place;
  }
}

void expect_below_one() {
  Largest largest;
  largest.add(0.5, kNan, 0.7);
  EXPECT_LT(largest, 1.0);
}

void expect_accurate() {
  Largest largest;
  largest.add(0.5, kNan, 0.7);
  expect_below("claim of a test that fails", "a NaN", largest, 1.0, "m");
}

TEST(Largest, WithANanFailsTheTest) {
  EXPECT_NONFATAL_FAILURE(expect_below_one(), "largest");
  EXPECT_NONFATAL_FAILURE(expect_accurate(), "nan m, at most 1");
}

TEST(LargestEntry, IsThatOfTheMagnitudes) {
  EXPECT_EQ(largest_entry(Eigen::Vector3d(1.0, -4.0, 2.0)), 4.0);
  EXPECT_EQ(largest_entry(Eigen::MatrixXd(0, 3)), 0.0);
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  for (Eigen::Index k = 0; k < 9; ++k) {
    Eigen::Matrix3d with_nan = matrix;
    with_nan(k) = kNan;
    EXPECT_TRUE(std::isnan(largest_entry(with_nan))) << k;
    EXPECT_TRUE(std::isnan(largest_entry(with_nan - matrix))) << k;
  }
}

TEST(Median, IsTheMiddleOfSortedValues) {
  EXPECT_EQ(median({5.0, 1.0, 3.0}), 3.0);
  EXPECT_EQ(median({8.0, 1.0, 2.0, 4.0}), 3.0);
  EXPECT_EQ(median({7.0}), 7.0);
  EXPECT_EQ(quantile({4.0, 0.0, 3.0, 1.0, 2.0}, 0.75), 3.0);
  EXPECT_EQ(quantile({4.0, 0.0, 3.0, 1.0, 2.0}, 1.0), 4.0);
  EXPECT_TRUE(std::isnan(median({})));
  for (std::size_t place = 0; place < 4; ++place) {
    std::vector<double> values{8.0, 1.0, 2.0, 4.0};
    values[place] = kNan;
    EXPECT_TRUE(std::isnan(median(values))) << place;
    EXPECT_TRUE(std::isnan(quantile(values, 0.9))) << place;
  }
}

}  // namespace
}  // namespace vbar::accuracy
