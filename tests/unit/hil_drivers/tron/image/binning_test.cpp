#include "hil_drivers/tron/image/binning.h"

#include <stdexcept>

#include <gtest/gtest.h>

namespace vbar::tron {
namespace {

TEST(TronBinning, TakesMeansOfFour) {
  const std::vector<std::uint16_t> dn{0, 4, 4095, 4095,  //
                                      8, 4, 4095, 4095,  //
                                      1, 0, 1,    1,     //
                                      0, 0, 0,    0};
  EXPECT_EQ(binned_by_two(dn, 4, 4), (std::vector<std::uint16_t>{4, 4095, 0, 1}));
}

TEST(TronBinning, RefusesOtherSizes) {
  const std::vector<std::uint16_t> dn(12);
  EXPECT_THROW(static_cast<void>(binned_by_two(dn, 4, 4)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(binned_by_two(dn, 3, 4)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(binned_by_two({}, 0, 0)), std::invalid_argument);
}

}  // namespace
}  // namespace vbar::tron
