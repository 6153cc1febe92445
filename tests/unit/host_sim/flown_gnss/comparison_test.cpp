// Figures of two receivers side by side, and the correlation time beside white noise.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "host_sim/flown_gnss/flown_receiver.h"

namespace vbar::flown_gnss {
namespace {

/// A result with 200 ranges of `range_m` at 45 deg, 8 satellites in each of 10 epochs.
FlownResult result(double range_m) {
  FlownResult made(fsw::GpsTime{}, 10.0);
  made.epochs = 10;
  made.satellites = 80;
  for (int k = 0; k < 200; ++k) made.ranges[bin_of(0.25 * 3.14159265)].add(range_m);
  return made;
}

const ComparedFigure* find(const std::vector<ComparedFigure>& figures, const std::string& name) {
  const auto found = std::ranges::find(figures, name, &ComparedFigure::name);
  return found == figures.end() ? nullptr : &*found;
}

TEST(Comparison, HasTheFiguresOfBoth) {
  const auto figures = compare(result(0.5), result(0.6));
  const ComparedFigure* const range = find(figures, "range, m, 40 to 50 deg");
  ASSERT_NE(range, nullptr);
  EXPECT_NEAR(range->flown, 0.5, 1e-12);
  EXPECT_NEAR(range->twin, 0.6, 1e-12);
  EXPECT_NEAR(range->ratio(), 1.2, 1e-12);
  EXPECT_EQ(range->count, 200U);
  EXPECT_EQ(find(figures, "range, m, 50 to 60 deg"), nullptr);
  const ComparedFigure* const satellites = find(figures, "satellites of an epoch");
  ASSERT_NE(satellites, nullptr);
  EXPECT_EQ(satellites->flown, 8.0);
}

/// White noise beside a Gauss-Markov process of 12 epochs with a quarter of the variance.
TEST(Correlation, TimeBesideWhiteIsThatOfTheProcess) {
  Correlation correlation;
  for (std::size_t lag = 0; lag < Correlation::kLags; ++lag) {
    correlation.pairs[lag] = 100;
    correlation.products[lag] = 100.0 * (lag == 0 ? 1.0 : 0.25 * std::exp(-static_cast<double>(lag) / 12.0));
  }
  ASSERT_TRUE(correlation.time_beside_white().has_value());
  EXPECT_NEAR(*correlation.time_beside_white(), 12.0, 0.01);
  Correlation white = correlation;
  for (std::size_t lag = 1; lag < Correlation::kLags; ++lag) white.products[lag] = 0.0;
  EXPECT_FALSE(white.time_beside_white().has_value());
  EXPECT_LT(*white.time(), 1.0);
}

}  // namespace
}  // namespace vbar::flown_gnss
