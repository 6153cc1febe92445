// What leaves the flight software: numbered by kind, and never with a number that is none.

#include "fsw/gnc/outbox.h"

#include <limits>

#include "tests/unit/fsw/gnc/packet_factory.h"

namespace vbar::fsw::gnc {
namespace {

using test::Bytes;

class OutboxTest : public ::testing::Test {
 protected:
  static void sink(void* sent, const std::uint8_t* packet, std::size_t size) {
    static_cast<std::vector<Bytes>*>(sent)->emplace_back(packet, packet + size);
  }
  packets::PacketHeader header(std::size_t k) {
    const Result<packets::PacketView> packet = packets::parse_packet(sent_[k]);
    EXPECT_TRUE(packet.ok());
    return packet.value().header;
  }

  std::vector<Bytes> sent_;
  Outbox outbox_{test::kServicer, &OutboxTest::sink, &sent_};
};

TEST_F(OutboxTest, CountsEachKindByItself) {
  outbox_.send({10}, telemetry_navigation{});
  outbox_.send({10}, maneuver_command{});
  outbox_.send({20}, telemetry_navigation{});
  outbox_.send({20}, telemetry_control{});
  outbox_.send({20}, telemetry_health{});
  ASSERT_EQ(sent_.size(), 5U);
  const std::uint16_t expected[] = {0, 0, 1, 0, 0};
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(header(k).sequence_count, expected[k]) << k;
    EXPECT_EQ(header(k).spacecraft, test::kServicer);
  }
  EXPECT_EQ(header(2).time.ns, 20);
}

TEST_F(OutboxTest, EveryMessageFromTheFlightSoftwareHasACountOfItsOwn) {
  for (std::uint16_t round = 0; round < 3; ++round) {
    sent_.clear();
    packets::for_each_message([&]<class Message>() {
      if constexpr (packets::MessageTraits<Message>::kRoute.kind == packets::RouteKind::kFromFlight) {
        outbox_.send({10}, Message{});
        ASSERT_FALSE(sent_.empty());
        EXPECT_EQ(header(sent_.size() - 1).apid, packets::MessageTraits<Message>::kApid);
        EXPECT_EQ(header(sent_.size() - 1).sequence_count, round) << Message::getTypeName();
      }
    });
  }
}

TEST_F(OutboxTest, TheCountWrapsAtFourteenBits) {
  for (int k = 0; k < 0x4000 + 2; ++k) {
    sent_.clear();
    outbox_.send({k}, maneuver_command{});
  }
  EXPECT_EQ(header(0).sequence_count, 1);
}

// Dropped, counted, and without a gap in the numbers: the receiver is not to look for a packet that never was.
TEST_F(OutboxTest, DropsWhatHoldsANaN) {
  telemetry_navigation message{};
  outbox_.send({10}, message);
  message.sigma_rtn[2] = std::numeric_limits<double>::quiet_NaN();
  outbox_.send({20}, message);
  message.sigma_rtn[2] = std::numeric_limits<double>::infinity();
  outbox_.send({30}, message);
  message.sigma_rtn[2] = 0.0;
  outbox_.send({40}, message);
  EXPECT_EQ(outbox_.dropped(), 2);
  ASSERT_EQ(sent_.size(), 2U);
  EXPECT_EQ(header(1).sequence_count, 1);
}

}  // namespace
}  // namespace vbar::fsw::gnc
