// Left-aligned numbers: FLIR, Grasshopper3 GigE technical reference 3.1: 12 bits are FFF0h.

#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "hil_drivers/gige/protocol/stream_setup.h"

namespace vbar::gige {

namespace {

/// All numbers of a converter, left-aligned.
std::vector<std::uint16_t> all_numbers(int bits) {
  std::vector<std::uint16_t> pixels(std::size_t{1} << bits);
  for (std::size_t k = 0; k < pixels.size(); ++k) pixels[k] = static_cast<std::uint16_t>(k << (16 - bits));
  return pixels;
}

TEST(PixelPadding, ConvertersOfEvenBitsAreFound) {
  for (const int bits : {8, 10, 12, 14, 16}) {
    PixelPadding padding(12);
    padding.observe(all_numbers(bits));
    EXPECT_EQ(padding.bits(), bits);
    EXPECT_EQ(padding.shift(), 16 - bits);
    EXPECT_TRUE(padding.is_decided());
  }
}

TEST(PixelPadding, EvenImageDecidesNothing) {
  PixelPadding padding(12);
  // The offset of 64, left-aligned, has ten zeros.
  padding.observe(std::vector<std::uint16_t>(1000, 64 << 4));
  EXPECT_FALSE(padding.is_decided());
  EXPECT_EQ(padding.shift(), 4);
  EXPECT_EQ(padding.bits(), 12);
}

TEST(PixelPadding, LaterImagesCorrectTheFirst) {
  PixelPadding padding(12);
  padding.observe(std::vector<std::uint16_t>(1000, 0));
  EXPECT_EQ(padding.shift(), 4);
  padding.observe(all_numbers(10));
  EXPECT_EQ(padding.bits(), 10);
  padding.observe(all_numbers(12));
  EXPECT_EQ(padding.bits(), 12);
}

TEST(PixelPadding, RightAlignedNumbersAreRecognised) {
  PixelPadding padding(12);
  std::vector<std::uint16_t> pixels(4096);
  std::iota(pixels.begin(), pixels.end(), std::uint16_t{0});
  padding.observe(pixels);
  EXPECT_EQ(padding.shift(), 0);
  EXPECT_EQ(padding.bits(), 12);
}

}  // namespace

namespace {

// A packet of 1400 bytes takes a slab of 2048 bytes and a descriptor of 256.
TEST(PacketPacing, PacketInTheBuffer) {
  EXPECT_EQ(bytes_in_buffer(1400), 2304U);
}

TEST(PacketPacing, BufferThatHoldsTheImageNeedsNoPause) {
  constexpr std::size_t kImage = 500 * 848 * 2;                    // 622 packets of 1364 bytes, leader and trailer
  EXPECT_EQ(packet_delay_ns({0, 832 * 2304}, kImage, 1400), 0.0);  // 624 = 0.75 * 832
  EXPECT_GT(packet_delay_ns({0, 831 * 2304}, kImage, 1400), 0.0);
}

TEST(PacketPacing, PauseOfTheReceiverFitsTheBuffer) {
  // Debian's limit of 212992 bytes, doubled by the kernel, holds 184.9 packets, of which three quarters are usable.
  EXPECT_NEAR(packet_delay_ns({0, 2 * 212992}, 848'000, 1400), 10e6 / (0.75 * 2 * 212992 / 2304), 1e-6);
}

TEST(PacketPacing, BufferAsWantedNeedsNoPause) {
  for (const std::size_t image : {std::size_t{500 * 848 * 2}, std::size_t{1920 * 1200 * 2}})
    EXPECT_EQ(packet_delay_ns({0, 2 * wanted_socket_buffer(image, 1400)}, image, 1400), 0.0);
}

TEST(PacketPacing, WholeSensorIsPacedWithFourMebibytes) {
  // 1920 x 1200 pixels of 16 bits are 3381 packets; 8 MiB hold 3640, but only 2730 while packets are read.
  EXPECT_NEAR(packet_delay_ns({4 << 20, 8 << 20}, 1920 * 1200 * 2, 1400), 10e6 / 2730.67, 0.01);
}

TEST(PacketPacing, KernelGrantsWhatIsRequestedUpToItsLimit) {
  const SocketBuffer small = granted_socket_buffer(16384);
  EXPECT_EQ(small.granted_bytes, 32768U);  // socket(7): the kernel doubles the value
  const SocketBuffer large = granted_socket_buffer(std::size_t{1} << 30);
  EXPECT_GE(large.granted_bytes, small.granted_bytes);
  EXPECT_FALSE(description(large, 0.0, 1400).empty());
}

}  // namespace

}  // namespace vbar::gige
