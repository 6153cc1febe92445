#include "hil_drivers/grand/bench/samples/ca_code.h"

#include <stdexcept>

#include <gtest/gtest.h>

namespace vbar::grand::bench {
namespace {

// IS-GPS-200N table 3-Ia, column "first 10 chips octal, C/A".
constexpr std::array<int, kCaCodes> kFirstTenChips{
    01440, 01620, 01710, 01744, 01133, 01455, 01131, 01454, 01626, 01504, 01642, 01750, 01764, 01772, 01775, 01776,
    01156, 01467, 01633, 01715, 01746, 01763, 01063, 01706, 01743, 01761, 01770, 01774, 01127, 01453, 01625, 01712};

TEST(CaCode, FirstTenChipsOfTheInterfaceSpecification) {
  for (int prn = 1; prn <= kCaCodes; ++prn) {
    int chips = 0;
    for (std::size_t k = 0; k < 10; ++k) chips = 2 * chips + ca_code(prn)[k];
    EXPECT_EQ(chips, kFirstTenChips[static_cast<std::size_t>(prn - 1)]) << "PRN " << prn;
  }
}

int correlation(const CaCode& a, const CaCode& b, std::size_t shift) {
  int sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] == b[(k + shift) % b.size()] ? 1 : -1;
  return sum;
}

// Gold (1967): the correlations of a set of length 1023 have three values away from the peak, for codes of one set.
TEST(CaCode, CorrelationsAreThoseOfGoldCodes) {
  for (const int prn : {1, 13, 32})
    for (std::size_t shift = 0; shift < kCaCodeChips; ++shift) {
      const int own = correlation(ca_code(prn), ca_code(prn), shift);
      const int other = correlation(ca_code(prn), ca_code(7), shift);
      if (shift == 0) {
        EXPECT_EQ(own, 1023);
      } else {
        EXPECT_TRUE(own == -1 || own == 63 || own == -65) << prn << ": " << own;
      }
      EXPECT_TRUE(other == -1 || other == 63 || other == -65) << prn << ": " << other;
    }
}

TEST(CaCode, UnknownNumbersAreRefused) {
  for (const int prn : {0, 33, -1, 193}) EXPECT_THROW(ca_code(prn), std::out_of_range) << prn;
}

}  // namespace
}  // namespace vbar::grand::bench
