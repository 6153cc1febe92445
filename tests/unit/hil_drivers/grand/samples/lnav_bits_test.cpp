#include "hil_drivers/grand/bench/samples/lnav_bits.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/support/gnss_scene.h"

namespace vbar::grand::bench {
namespace {

using twins::gnss::SatelliteId;
using twins::gnss::Subframe;
using twins::gnss::System;

constexpr SatelliteId kSatellite{System::kGps, 7};
constexpr std::int64_t kStart_ms = test::kGnssStart.ns / 1'000'000;

// A receiver's view: words whose predecessor ends with D30 = 1 are inverted; the six bits of parity are left out.
Subframe received(LnavBits& bits, std::int64_t begin_ms) {
  Subframe subframe{};
  bool invert = false;
  for (std::size_t word = 0; word < 10; ++word) {
    bool last = false;
    for (std::size_t k = 0; k < 30; ++k) {
      const auto number = static_cast<std::int64_t>(30 * word + k);
      last = bits.bit(kSatellite, begin_ms + number * LnavBits::kBit_ms + 7);
      if (k < 24 && last != invert)
        subframe[3 * word + k / 8] = static_cast<std::uint8_t>(subframe[3 * word + k / 8] | 0x80U >> (k % 8));
    }
    invert = last;
  }
  for (const std::size_t byte : {5U, 29U}) subframe[byte] &= 0xFCU;  // solved for parity
  return subframe;
}

TEST(LnavBits, AFrameHasTheBroadcastSetAndPageEighteen) {
  const auto constellation = test::constellation(1);
  LnavBits bits(constellation);
  std::size_t index = 0;
  while (constellation->id(index) != kSatellite) ++index;
  const twins::gnss::BroadcastSet set = constellation->broadcast_set(index, test::kGnssStart);
  const auto sent = lnav_subframes(set.ephemeris, set.issue, test::kGnssStart);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_EQ(received(bits, kStart_ms + static_cast<std::int64_t>(k) * 6000), sent[k]) << "subframe " << k + 1;
  const Subframe fourth = received(bits, kStart_ms + 18000);
  EXPECT_EQ(fourth[0], 0x8B);
  EXPECT_EQ(fourth[6], 0x40 + 56);                        // data identification 01, page 18
  EXPECT_EQ(received(bits, kStart_ms + 24000)[6], 0x40);  // dummy satellite
}

TEST(LnavBits, TimesOfAnyOrderGiveTheSameBits) {
  LnavBits forward(test::constellation(1));
  LnavBits backward(test::constellation(1));
  std::vector<bool> bits;
  for (std::int64_t t = 0; t < 40000; t += 20) bits.push_back(forward.bit(kSatellite, kStart_ms + t));
  for (std::int64_t t = 39980; t >= 0; t -= 20)
    ASSERT_EQ(backward.bit(kSatellite, kStart_ms + t), bits[static_cast<std::size_t>(t / 20)]) << t;
}

TEST(LnavBits, UnknownSatellitesAreRefused) {
  LnavBits bits(test::constellation(1));
  EXPECT_THROW(static_cast<void>(bits.bit({System::kGalileo, 11}, kStart_ms)), std::out_of_range);
  EXPECT_THROW(static_cast<void>(bits.bit({System::kGps, 0}, kStart_ms)), std::out_of_range);
  EXPECT_THROW(static_cast<void>(bits.bit({System::kGps, 77}, kStart_ms)), std::out_of_range);
  EXPECT_THROW(LnavBits(nullptr), std::invalid_argument);
}

}  // namespace
}  // namespace vbar::grand::bench
