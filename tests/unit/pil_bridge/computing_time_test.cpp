// How the time of an exchange is divided between a line and the flight computer.

#include <gtest/gtest.h>

#include "pil_bridge/remote_computer.h"

namespace vbar::pil {
namespace {

// 8N1: ten bits a byte. 3840 bytes at 38400 baud take 1 s.
TEST(ComputingTime, IsWhatTheBytesLeaveOfTheExchangeOnALineOfAKnownRate) {
  EXPECT_DOUBLE_EQ(computing_time(1.25, 0.0, 3840, 38400.0), 0.25);
  EXPECT_DOUBLE_EQ(computing_time(1.25, 1.0, 0, 38400.0), 1.25);
}

TEST(ComputingTime, IsTheWaitForTheAnswerWithoutARate) {
  EXPECT_DOUBLE_EQ(computing_time(1.25, 0.5, 3840, 0.0), 0.5);
}

TEST(ComputingTime, IsWithinTheExchange) {
  EXPECT_DOUBLE_EQ(computing_time(0.5, 0.0, 3840, 38400.0), 0.0);
  EXPECT_DOUBLE_EQ(computing_time(0.5, -0.1, 0, 0.0), 0.0);
  EXPECT_DOUBLE_EQ(computing_time(0.5, 0.7, 0, 0.0), 0.5);
}

}  // namespace
}  // namespace vbar::pil
