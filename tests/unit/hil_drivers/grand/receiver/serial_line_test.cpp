#include "hil_drivers/grand/bench/receiver/serial_line.h"

#include <gtest/gtest.h>

namespace vbar::grand::bench::test {
namespace {

SerialLine line(unsigned baud, int buffer = 4096) {
  return {baud, buffer, engine::RandomStream(1, "test/line")};
}

// 8N1: a byte is ten bits, at 9600 baud 1.0417 ms.
TEST(SerialLine, BytesLeaveAtTheBaudRate) {
  SerialLine com = line(9600);
  ASSERT_TRUE(com.queue(Bytes(960, 0x55), 1'000'000'000));
  EXPECT_EQ(com.take(1'000'000'000, 0).size(), 0U);
  EXPECT_EQ(com.take(1'001'041'666, 0).size(), 0U);
  EXPECT_EQ(com.take(1'001'041'667, 0).size(), 1U);
  EXPECT_EQ(com.take(1'500'000'000, 0).size(), 479U);
  EXPECT_EQ(com.take(2'000'000'000, 0).size(), 480U);
  EXPECT_FALSE(com.busy(2'000'000'000));
}

TEST(SerialLine, MessagesFollowEachOther) {
  SerialLine com = line(115200);
  ASSERT_TRUE(com.queue(Bytes(1152, 1), 0));
  ASSERT_TRUE(com.queue(Bytes(1152, 2), 50'000'000));  // 50 ms later, while the first takes 100 ms
  const Bytes first = com.take(100'000'000, 0);
  EXPECT_EQ(first, Bytes(1152, 1));
  EXPECT_EQ(com.take(200'000'000, 0), Bytes(1152, 2));
}

TEST(SerialLine, AFullBufferDropsTheWholeMessage) {
  SerialLine com = line(9600, 1000);
  EXPECT_TRUE(com.queue(Bytes(700, 1), 0));
  EXPECT_FALSE(com.queue(Bytes(400, 2), 0));
  EXPECT_TRUE(com.queue(Bytes(300, 3), 0));
  // 480 bytes leave in half a second.
  EXPECT_TRUE(com.queue(Bytes(400, 4), 500'000'000));
  const Bytes all = com.take(100'000'000'000, 0);
  EXPECT_EQ(all.size(), 1400U);
  EXPECT_EQ(std::count(all.begin(), all.end(), 2), 0);
}

TEST(SerialLine, AListenerAtAnotherRateHearsNoise) {
  SerialLine com = line(115200);
  com.queue(Bytes(1000, 0x42), 0);
  const Bytes heard = com.take(1'000'000'000, 57600);
  EXPECT_EQ(heard.size(), 500U);
  EXPECT_LT(std::count(heard.begin(), heard.end(), 0x42), 20);
}

}  // namespace
}  // namespace vbar::grand::bench::test
