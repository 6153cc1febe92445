#include "fsw/gnss/ratio_threshold.h"

#include <array>
#include <limits>

namespace vbar::fsw::gnss {
namespace {

// Printed by tests/unit/fsw/gnss/ratio_table.cpp, which tells how: simulated, for kFixFailureRate.
constexpr std::array<std::size_t, 12> kCounts{1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24};
constexpr std::array<double, 6> kModelFailureRates{0.002, 0.005, 0.01, 0.02, 0.05, kLargestModelFailureRate};
constexpr std::array<std::array<double, kModelFailureRates.size()>, kCounts.size()> kRatios{{
    {{1.41, 2.05, 3.50, 6.29, 27.02, 570.49}},  // 1
    {{1.28, 1.87, 2.96, 4.58, 9.43, 48.71}},    // 2
    {{1.23, 1.79, 2.45, 3.96, 7.84, 16.78}},    // 3
    {{1.25, 1.67, 2.13, 3.29, 6.46, 10.17}},    // 4
    {{1.22, 1.53, 2.13, 2.87, 4.94, 6.33}},     // 5
    {{1.21, 1.41, 2.13, 2.70, 3.55, 4.77}},     // 6
    {{1.17, 1.50, 1.71, 1.93, 2.52, 3.76}},     // 8
    {{1.17, 1.40, 1.47, 1.83, 2.04, 2.45}},     // 10
    {{1.09, 1.26, 1.50, 1.57, 2.00, 2.26}},     // 12
    {{1.12, 1.19, 1.36, 1.55, 1.71, 1.77}},     // 16
    {{1.10, 1.21, 1.32, 1.46, 1.65, 1.69}},     // 20
    {{1.10, 1.20, 1.31, 1.41, 1.51, 1.69}},     // 24
}};

}  // namespace

double ratio_threshold(std::size_t count, double model_failure_rate) {
  if (count == 0 || !(model_failure_rate <= kLargestModelFailureRate)) return std::numeric_limits<double>::infinity();
  if (model_failure_rate <= kFixFailureRate) return 1.0;  // whatever is accepted, no more can fail
  // Both ways to the stricter entry: the ratio falls with the number of ambiguities and grows with the failure rate.
  std::size_t row = kCounts.size() - 1;
  while (kCounts[row] > count) --row;
  std::size_t column = 0;
  while (kModelFailureRates[column] < model_failure_rate) ++column;
  return kRatios[row][column];
}

}  // namespace vbar::fsw::gnss
