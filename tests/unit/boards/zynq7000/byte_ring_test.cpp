// The ring between an interrupt handler and the main loop: order, the stated rule when full, and wrap-around.

#include "boards/zynq7000/byte_ring.h"

#include <thread>

#include <gtest/gtest.h>

namespace vbar::boards::zynq7000 {
namespace {

TEST(ByteRing, FullDropsTheNewestAndOverwritesNothing) {
  ByteRing<8> ring;
  for (std::uint8_t i = 0; i < 20; ++i) ring.push(i);
  EXPECT_EQ(ring.dropped(), 12U);
  std::uint8_t byte = 0;
  for (std::uint8_t i = 0; i < 8; ++i) {
    ASSERT_TRUE(ring.pop(byte));
    EXPECT_EQ(byte, i);
  }
  EXPECT_FALSE(ring.pop(byte));
  EXPECT_TRUE(ring.empty());
  ring.push(42);
  ASSERT_TRUE(ring.pop(byte));
  EXPECT_EQ(byte, 42);
}

// One writer and one reader at once, as an interrupt and the main loop are: every byte arrives once and in order.
TEST(ByteRing, OneWriterAndOneReader) {
  constexpr std::uint32_t kBytes = 20'000;
  ByteRing<64> ring;
  std::thread writer([&ring] {
    for (std::uint32_t i = 0; i < kBytes;) {
      const std::uint32_t dropped = ring.dropped();
      ring.push(static_cast<std::uint8_t>(i * 7U));
      if (ring.dropped() == dropped) {
        ++i;
      } else {
        std::this_thread::yield();  // full: the same byte again, so that the reader can demand all of them
      }
    }
  });
  for (std::uint32_t i = 0; i < kBytes; ++i) {
    std::uint8_t byte = 0;
    while (!ring.pop(byte)) std::this_thread::yield();
    ASSERT_EQ(byte, static_cast<std::uint8_t>(i * 7U)) << i;
  }
  writer.join();
}

}  // namespace
}  // namespace vbar::boards::zynq7000
