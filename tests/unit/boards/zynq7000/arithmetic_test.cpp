// Divisors of clocks against the figures of the manuals and an exhaustive search; the extension of the cycle counter.

#include <cmath>
#include <cstdint>
#include <utility>

#include <gtest/gtest.h>

#include "boards/zynq7000/clocks.h"
#include "boards/zynq7000/timer.h"

namespace vbar::boards::zynq7000 {
namespace {

double baud_of(std::uint32_t clock_hz, const BaudDivisors& d) {
  return static_cast<double>(clock_hz) / (d.generator * (d.divider + 1.0));
}

// UG585 chapter 19 lists, for a 50 MHz reference clock, generator 62 and divider 6 for 115,200 baud and generator 9 and
// divider 5 for 921,600. Ours may not be worse.
TEST(BaudDivisors, AsGoodAsTheManual) {
  EXPECT_LE(std::abs(baud_of(50'000'000, baud_divisors(50'000'000, 115'200)) - 115'200),
            std::abs(50e6 / (62 * 7) - 115'200));
  EXPECT_LE(std::abs(baud_of(50'000'000, baud_divisors(50'000'000, 921'600)) - 921'600),
            std::abs(50e6 / (9 * 6) - 921'600));
}

// A frame of ten bits is read wrong when the two ends drift half a bit apart, 5 %. Each end may therefore be off by 2.5
// %; this one stays within 2 % for every reference clock from 25 to 100 MHz. (Below 23 MHz there are clocks of which no
// divisors make 921,600 baud that well: half a step of 1 in 25.)
TEST(BaudDivisors, EveryReferenceClockIsCloseEnough) {
  for (std::uint32_t clock_hz = 25'000'000; clock_hz <= 100'000'000; clock_hz += 250'000) {
    for (const std::uint32_t baud : {115'200U, 921'600U}) {
      const BaudDivisors divisors = baud_divisors(clock_hz, baud);
      ASSERT_TRUE(divisors.divider >= 4 && divisors.divider <= 255);
      ASSERT_TRUE(divisors.generator >= 1 && divisors.generator <= 65535);
      EXPECT_LT(std::abs(baud_of(clock_hz, divisors) / baud - 1.0), 0.02) << clock_hz << " Hz, " << baud;
    }
  }
}

// 1 GHz, the usual I/O PLL, divided by 8, 40 and 400 gives the clocks of the three rates exactly.
TEST(ClockDivisors, EthernetFromAGigahertz) {
  for (const auto& [wanted_hz, ratio] : {std::pair{125'000'000U, 8U}, {25'000'000U, 40U}, {2'500'000U, 400U}}) {
    const ClockDivisors divisors = clock_divisors(1'000'000'000, wanted_hz);
    EXPECT_EQ(divisors.first * divisors.second, ratio);
    EXPECT_LE(divisors.first, 63U);
    EXPECT_LE(divisors.second, 63U);
  }
}

TEST(CycleCount, IsCongruentAndNearest) {
  constexpr std::uint64_t kTurn = 1ULL << 32;
  EXPECT_EQ(nearest_cycle_count(1000, 1002), 1000U);
  EXPECT_EQ(nearest_cycle_count(5, kTurn - 3), kTurn + 5);            // went round just after the estimate
  EXPECT_EQ(nearest_cycle_count(0xFFFFFFF0, kTurn + 4), kTurn - 16);  // just before
  EXPECT_EQ(nearest_cycle_count(0xFFFFFFF0, 4), 0xFFFFFFF0U);         // never negative
  // Ten seconds at 667 MHz with an estimate off by a thousandth.
  constexpr std::uint64_t kTrue = 6'670'000'000;
  EXPECT_EQ(nearest_cycle_count(static_cast<std::uint32_t>(kTrue), kTrue + kTrue / 1000), kTrue);
}

}  // namespace
}  // namespace vbar::boards::zynq7000
