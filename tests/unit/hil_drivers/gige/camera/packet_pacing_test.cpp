#include "hil_drivers/gige/camera/packet_pacing.h"

#include <gtest/gtest.h>

namespace vbar::gige {
namespace {

// A packet of 1400 bytes takes a slab of 2048 bytes and a descriptor of 256.
TEST(PacketPacing, PacketInTheBuffer) {
  EXPECT_EQ(bytes_in_buffer(1400), 2304U);
}

TEST(PacketPacing, BufferThatHoldsTheImageNeedsNoPause) {
  constexpr std::size_t kImage = 500 * 848 * 2;  // 622 packets of 1364 bytes, leader and trailer
  EXPECT_EQ(packet_delay_ns({0, 624 * 2304}, kImage, 1400), 0.0);
  EXPECT_GT(packet_delay_ns({0, 623 * 2304}, kImage, 1400), 0.0);
}

TEST(PacketPacing, PauseOfTheReceiverFitsTheBuffer) {
  // Debian's limit of 212992 bytes, doubled by the kernel, holds 184 packets: 10 ms at 54 us a packet.
  EXPECT_NEAR(packet_delay_ns({0, 2 * 212992}, 848'000, 1400), 10e6 / 184.0, 1e-6);
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
