// Who may lead a session, and when another may.

#include "boards/zynq7000/session_guard.h"

#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/link/frame.h"

namespace vbar::boards::zynq7000 {
namespace {

using fsw::link::FrameType;

std::vector<std::uint8_t> link_frame(FrameType type) {
  std::array<std::uint8_t, fsw::link::kMaxFrameBytes> bytes{};
  fsw::link::FrameHeader header;
  header.type = type;
  header.session = 7;
  const auto size = fsw::link::write_frame(header, {}, bytes);
  return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size.value())};
}

constexpr std::uint64_t kSilence = 1000;
const Sender kSerial{Interface::kSerial, {}};
const Sender kHost{Interface::kEthernet, {{}, {10, 0, 2, 2}, 40000}};
const Sender kOtherPort{Interface::kEthernet, {{}, {10, 0, 2, 2}, 40001}};
const Sender kOtherHost{Interface::kEthernet, {{}, {10, 0, 2, 3}, 40000}};

class SessionGuardTest : public testing::Test {
 protected:
  SessionGuard guard_{kSilence};
  std::vector<std::uint8_t> hello_ = link_frame(FrameType::kHello);
  std::vector<std::uint8_t> data_ = link_frame(FrameType::kData);
};

TEST_F(SessionGuardTest, OnlyAHelloOpensASession) {
  EXPECT_FALSE(guard_.admits(kSerial, data_, 0));
  EXPECT_FALSE(guard_.admits(kSerial, link_frame(FrameType::kGoodbye), 0));
  std::vector<std::uint8_t> broken = hello_;
  broken[5] ^= 1U;
  EXPECT_FALSE(guard_.admits(kSerial, broken, 0));
  EXPECT_FALSE(guard_.has_peer());
  EXPECT_TRUE(guard_.admits(kSerial, hello_, 0));
  EXPECT_EQ(guard_.peer(), kSerial);
}

TEST_F(SessionGuardTest, OthersAreRefusedAndThePeerIsNot) {
  ASSERT_TRUE(guard_.admits(kHost, hello_, 0));
  for (const Sender& other : {kSerial, kOtherPort, kOtherHost}) {
    EXPECT_FALSE(guard_.admits(other, data_, 1));
    EXPECT_FALSE(guard_.admits(other, hello_, 2));
  }
  EXPECT_TRUE(guard_.admits(kHost, data_, 3));
  EXPECT_TRUE(guard_.admits(kHost, hello_, 4));
  EXPECT_EQ(guard_.peer(), kHost);
}

// A frame that the line damaged is its peer's nevertheless; the executive counts it.
TEST_F(SessionGuardTest, ThePeersBrokenFramesAreAdmitted) {
  ASSERT_TRUE(guard_.admits(kSerial, hello_, 0));
  data_[3] ^= 0x10U;
  EXPECT_TRUE(guard_.admits(kSerial, data_, 1));
}

TEST_F(SessionGuardTest, GoodbyeFreesTheBoard) {
  ASSERT_TRUE(guard_.admits(kHost, hello_, 0));
  guard_.end_session();
  EXPECT_FALSE(guard_.admits(kSerial, data_, 1));
  EXPECT_TRUE(guard_.admits(kSerial, hello_, 2));
  EXPECT_FALSE(guard_.admits(kHost, data_, 3));
}

TEST_F(SessionGuardTest, AHelloTakesOverFromASilentPeer) {
  ASSERT_TRUE(guard_.admits(kHost, hello_, 0));
  ASSERT_TRUE(guard_.admits(kHost, data_, 500));
  EXPECT_FALSE(guard_.admits(kOtherPort, hello_, 500 + kSilence - 1));
  EXPECT_FALSE(guard_.admits(kOtherPort, data_, 500 + kSilence)) << "silence alone admits nobody";
  EXPECT_TRUE(guard_.admits(kHost, data_, 500 + kSilence)) << "nor does it shut the peer out";
  EXPECT_TRUE(guard_.admits(kOtherPort, hello_, 500 + 2 * kSilence));
  EXPECT_FALSE(guard_.admits(kHost, data_, 501 + 2 * kSilence));
}

TEST_F(SessionGuardTest, AfterAResetThePeerIsHeardAgainWithoutAHello) {
  guard_.resume(kHost, 100);
  EXPECT_TRUE(guard_.admits(kHost, data_, 101));
  EXPECT_FALSE(guard_.admits(kOtherPort, hello_, 102));
  EXPECT_TRUE(guard_.admits(kOtherPort, hello_, 101 + kSilence));
}

}  // namespace
}  // namespace vbar::boards::zynq7000
