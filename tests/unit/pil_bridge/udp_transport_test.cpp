#include "pil_bridge/udp_transport.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fsw/link/frame.h"
#include "host_sim/io/udp_socket.h"

namespace vbar::pil {
namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;
using Bytes = std::vector<std::uint8_t>;

Clock::time_point soon() {
  return Clock::now() + std::chrono::seconds(10);
}

/// Two transports that are each other's peers.
struct Pair {
  Pair() {
    io::BoundUdpSocket a = io::bind_udp_loopback();
    io::BoundUdpSocket b = io::bind_udp_loopback();
    port = a.port;
    one = make_udp_transport(std::move(a.socket), "127.0.0.1", b.port);
    other = make_udp_transport(std::move(b.socket), "127.0.0.1", a.port);
  }
  std::uint16_t port = 0;  ///< of `one`
  std::unique_ptr<FrameTransport> one;
  std::unique_ptr<FrameTransport> other;
};

TEST(UdpTransport, CarriesOneFrameADatagram) {
  const Pair pair;
  const Bytes longest(fsw::link::kMaxFrameBytes, 0xA5);
  pair.one->send(Bytes{1, 2, 3});
  pair.one->send(longest);
  EXPECT_THAT(pair.other->receive(soon()), ElementsAre(1, 2, 3));
  EXPECT_THAT(pair.other->receive(soon()), ElementsAreArray(longest));
  EXPECT_EQ(pair.one->counters().bytes_sent, 3 + longest.size());
  EXPECT_EQ(pair.other->counters().bytes_received, 3 + longest.size());
}

TEST(UdpTransport, IgnoresAndCountsForeignDatagrams) {
  const Pair pair;
  const auto stranger = make_udp_transport("127.0.0.1", pair.port);
  stranger->send(Bytes{6, 6, 6});
  stranger->send(Bytes{6, 6, 6});
  pair.other->send(Bytes{7});
  EXPECT_THAT(pair.one->receive(soon()), ElementsAre(7));
  EXPECT_EQ(pair.one->counters().foreign_datagrams, 2U);
  EXPECT_EQ(pair.one->counters().bytes_received, 1U);
}

TEST(UdpTransport, RejectsAndCountsWhatCannotBeAFrame) {
  const Pair pair;
  pair.other->send(Bytes(fsw::link::kMaxFrameBytes + 1));
  pair.other->send(Bytes(3000));
  pair.other->send(Bytes{});
  pair.other->send(Bytes{7});
  EXPECT_THAT(pair.one->receive(soon()), ElementsAre(7));
  EXPECT_EQ(pair.one->counters().frames_rejected, 3U);
}

TEST(UdpTransport, ReceiveEndsAtItsDeadline) {
  const Pair pair;
  const auto deadline = Clock::now() + std::chrono::milliseconds(20);
  EXPECT_TRUE(pair.one->receive(deadline).empty());
  EXPECT_GE(Clock::now(), deadline);
}

TEST(UdpTransport, APeerThatIsNotThereYetIsNoError) {
  std::uint16_t free_port = io::bind_udp_loopback().port;
  const auto transport = make_udp_transport("127.0.0.1", free_port);
  for (int i = 0; i < 3; ++i) {
    transport->send(Bytes{1});
    EXPECT_TRUE(transport->receive(Clock::now() + std::chrono::milliseconds(5)).empty());
  }
}

TEST(UdpTransport, AnAddressThatIsNoneIsAnError) {
  EXPECT_THROW(make_udp_transport("localhost?", 5000), LinkError);
}

}  // namespace
}  // namespace vbar::pil
