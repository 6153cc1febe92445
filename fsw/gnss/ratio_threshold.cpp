#include "fsw/gnss/ratio_threshold.h"

#include <array>
#include <limits>

namespace vbar::fsw::gnss {
namespace {

// Output of tests/unit/fsw/gnss/ratio_table.cpp, which describes the method: simulated, for kFixFailureRate.
constexpr std::array<std::size_t, 12> kCounts{1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24};
constexpr std::array<double, 6> kModelFailureRates{0.002, 0.005, 0.01, 0.02, 0.05, kLargestModelFailureRate};
constexpr std::array<std::array<double, kModelFailureRates.size()>, kCounts.size()> kRatios{{
    {{1.39, 2.20, 3.35, 6.31, 32.16, 602.82}},  // 1
    {{1.35, 1.86, 2.81, 4.96, 14.15, 52.87}},   // 2
    {{1.29, 1.83, 2.45, 3.54, 9.12, 17.15}},    // 3
    {{1.24, 1.72, 2.27, 3.31, 6.26, 10.27}},    // 4
    {{1.22, 1.66, 2.17, 2.78, 4.68, 7.44}},     // 5
    {{1.22, 1.62, 2.04, 2.52, 3.85, 4.75}},     // 6
    {{1.16, 1.43, 1.71, 2.21, 2.84, 3.59}},     // 8
    {{1.13, 1.36, 1.71, 1.80, 2.47, 2.88}},     // 10
    {{1.13, 1.27, 1.46, 1.64, 1.96, 2.41}},     // 12
    {{1.12, 1.24, 1.38, 1.51, 1.80, 1.86}},     // 16
    {{1.11, 1.22, 1.38, 1.45, 1.59, 1.69}},     // 20
    {{1.10, 1.21, 1.31, 1.41, 1.51, 1.59}},     // 24
}};

}  // namespace

double ratio_threshold(std::size_t count, double model_failure_rate) {
  if (count == 0 || !(model_failure_rate <= kLargestModelFailureRate)) return std::numeric_limits<double>::infinity();
  if (model_failure_rate <= kFixFailureRate) return 1.0;  // the failure rate cannot be exceeded, whatever is accepted
  // Rounded to the stricter entry: the ratio falls with the number of ambiguities and grows with the failure rate.
  std::size_t row = kCounts.size() - 1;
  while (kCounts[row] > count) --row;
  std::size_t column = 0;
  while (kModelFailureRates[column] < model_failure_rate) ++column;
  return kRatios[row][column];
}

}  // namespace vbar::fsw::gnss
