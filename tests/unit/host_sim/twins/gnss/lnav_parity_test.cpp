#include "host_sim/twins/gnss/lnav_parity.h"

#include <gtest/gtest.h>

#include "host_sim/twins/gnss/system_time.h"

namespace vbar::twins::gnss {
namespace {

// A subframe 4 of the real satellite PRN 5, as a u-blox receiver reported it (UBX-RXM-SFRBX in the test data of the
// decoder pyubx2; that receiver inverts each word whose predecessor ends with D30 = 1, which is undone here).
constexpr std::array<std::uint32_t, 10> kReportedData{0x8B0140, 0x4B45B2, 0x5E26F3, 0x63FD25, 0xFD4000,
                                                      0xA10C23, 0x92F454, 0x8D6F1C, 0xB71F0D, 0xD5FFD3};
constexpr std::array<std::uint32_t, 10> kTransmitted{
    0x22C0502E, 0x12D16C80, 0x1789BCED, ~0x18FF4950U & 0x3FFFFFFFU, ~0x3F50000FU & 0x3FFFFFFFU,
    0x284308F0, 0x24BD152A, 0x235BC727, ~0x2DC7C349U & 0x3FFFFFFFU, 0x357FF4E0};

TEST(LnavParity, WordsOfARealSatellite) {
  std::uint32_t previous = 0;
  for (std::size_t k = 0; k < 10; ++k) {
    EXPECT_EQ(lnav_word(kReportedData[k], previous), kTransmitted[k]) << "word " << k + 1;
    previous = kTransmitted[k];
  }
}

// The two bits that the satellite solved for in words 2 and 10 are found again.
TEST(LnavParity, SubframeOfARealSatelliteWithItsSolvedBits) {
  Subframe subframe{};
  for (std::size_t k = 0; k < 10; ++k)
    for (std::size_t byte = 0; byte < 3; ++byte)
      subframe[3 * k + byte] = static_cast<std::uint8_t>(kReportedData[k] >> (16U - 8U * byte) & 0xFFU);
  subframe[5] &= 0xFCU;
  subframe[29] &= 0xFCU;
  EXPECT_EQ(lnav_transmitted(subframe), kTransmitted);
}

std::uint32_t field(const Subframe& subframe, std::size_t first_bit, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t k = first_bit; k < first_bit + count; ++k)
    value = value << 1U | (subframe[k / 8] >> (7U - k % 8) & 1U);
  return value;
}

// Positions (bits of the subframe without parity) and scales: IS-GPS-200N figure 20-1 sheet 8, tables 20-IX and 20-X.
// Klobuchar numbers on their grid.
TEST(LnavParity, PageEighteenHasTheFieldsOfTheInterfaceSpecification) {
  BroadcastCorrections corrections;
  corrections.klobuchar.alpha = {3.0 * 0x1p-30, -4.0 * 0x1p-27, 5.0 * 0x1p-24, -6.0 * 0x1p-24};
  corrections.klobuchar.beta = {7.0 * 0x1p11, -8.0 * 0x1p14, 9.0 * 0x1p16, -10.0 * 0x1p16};
  corrections.utc_a0_s = -11.0 * 0x1p-30;
  corrections.utc_a1 = 12.0 * 0x1p-50;
  const UtcOffset utc{.gps_minus_utc_s = 15, .change_week = 1512, .change_day = 4};
  const Subframe page = lnav_page_18(corrections, utc, gps_time_of(System::kGps, 1645, 90030));
  EXPECT_EQ(field(page, 0, 8), 0x8BU);
  EXPECT_EQ(field(page, 24, 17), 90030U / 6U + 4U);  // beginning of the next subframe
  EXPECT_EQ(field(page, 43, 3), 4U);
  EXPECT_EQ(field(page, 48, 2), 1U);
  EXPECT_EQ(field(page, 50, 6), 56U);
  constexpr std::array<std::uint32_t, 8> kIonosphere{3, 0x100 - 4, 5, 0x100 - 6, 7, 0x100 - 8, 9, 0x100 - 10};
  for (std::size_t k = 0; k < 8; ++k) EXPECT_EQ(field(page, 56 + 8 * k, 8), kIonosphere[k]) << k;
  EXPECT_EQ(field(page, 120, 24), 12U);
  EXPECT_EQ(field(page, 144, 32), 0xFFFFFFFFU - 10U);
  EXPECT_EQ(field(page, 176, 8), 36U);  // 147456 s in units of 4096 s
  EXPECT_EQ(field(page, 184, 8), 1645U % 256U);
  EXPECT_EQ(field(page, 192, 8), 15U);
  EXPECT_EQ(field(page, 200, 8), 1512U % 256U);
  EXPECT_EQ(field(page, 208, 8), 4U);
  EXPECT_EQ(field(page, 216, 8), 15U);
}

TEST(LnavParity, DummyPageNamesNoSatellite) {
  const Subframe page = lnav_dummy_page(5, gps_time_of(System::kGps, 1645, 604770));
  EXPECT_EQ(field(page, 24, 17), 0U);  // the next subframe begins the week
  EXPECT_EQ(field(page, 43, 3), 5U);
  EXPECT_EQ(field(page, 50, 6), 0U);
  for (std::size_t k = 56; k < 238; k += 2) EXPECT_EQ(field(page, k, 2), 2U) << k;
}

TEST(LnavParity, ANumberThatDoesNotFitPageEighteenIsRefused) {
  BroadcastCorrections corrections;
  corrections.klobuchar.alpha[0] = 1.0;
  EXPECT_THROW(lnav_page_18(corrections, {}, gps_time_of(System::kGps, 1645, 0)), std::out_of_range);
}

}  // namespace
}  // namespace vbar::twins::gnss
