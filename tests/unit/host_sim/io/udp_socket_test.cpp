#include "host_sim/io/udp_socket.h"

#include <chrono>
#include <cstdint>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::io {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::SizeIs;

constexpr std::size_t kMaxBytes = 8;

Clock::time_point soon() {
  return Clock::now() + std::chrono::seconds(10);
}

/// Two sockets that are each other's peers.
struct Pair {
  explicit Pair(BoundUdpSocket a = bind_udp_loopback(), BoundUdpSocket b = bind_udp_loopback())
      : port(a.port),
        one(std::move(a.socket), "127.0.0.1", b.port, kMaxBytes),
        other(std::move(b.socket), "127.0.0.1", a.port, kMaxBytes) {}
  std::uint16_t port;  ///< of `one`
  UdpSocket one;
  UdpSocket other;
};

TEST(UdpSocket, DeliversDatagramsWholeAndInOrder) {
  Pair pair;
  pair.one.send(std::vector<std::uint8_t>{1, 2, 3});
  pair.one.send({});
  EXPECT_THAT(pair.other.receive(soon()).value(), ElementsAre(1, 2, 3));
  EXPECT_THAT(pair.other.receive(soon()).value(), SizeIs(0));
}

TEST(UdpSocket, ALongerDatagramIsSeenToBeLonger) {
  Pair pair;
  pair.one.send(std::vector<std::uint8_t>(kMaxBytes + 5, 7));
  EXPECT_THAT(pair.other.receive(soon()).value(), SizeIs(kMaxBytes + 1));
}

TEST(UdpSocket, DatagramsOfAnotherAddressAreCountedAndDiscarded) {
  Pair pair;
  UdpSocket foreign("127.0.0.1", pair.port, 0, kMaxBytes);
  foreign.send(std::vector<std::uint8_t>{9});
  pair.other.send(std::vector<std::uint8_t>{1});
  EXPECT_THAT(pair.one.receive(soon()).value(), ElementsAre(1));
  EXPECT_EQ(pair.one.foreign_datagrams(), 1U);
}

TEST(UdpSocket, NothingByTheDeadline) {
  Pair pair;
  EXPECT_FALSE(pair.one.receive(Clock::now() + milliseconds(10)).has_value());
}

TEST(UdpSocket, APeerThatIsNotThereLosesDatagramsOnly) {
  const std::uint16_t free_port = bind_udp_loopback().port;
  UdpSocket socket("127.0.0.1", free_port, 0, kMaxBytes);
  socket.send(std::vector<std::uint8_t>{1});
  EXPECT_FALSE(socket.receive(Clock::now() + milliseconds(10)).has_value());
  socket.send(std::vector<std::uint8_t>{1});
}

TEST(UdpSocket, ErrorsNameTheAddress) {
  try {
    UdpSocket socket("zedboard.local", 1, 0, kMaxBytes);
    FAIL() << "a host name was accepted";
  } catch (const ChannelError& error) {
    EXPECT_STREQ(error.what(), "'zedboard.local' is not an IPv4 address");
  }
}

}  // namespace
}  // namespace vbar::io
