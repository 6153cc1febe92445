// The inbox takes what the contract allows, refuses the rest with a count by cause, and orders by time tag.

#include "fsw/messaging/inbox.h"

#include <cstring>
#include <limits>
#include <memory>

#include "fsw/messaging/outbox.h"
#include "tests/unit/fsw/messaging/configurations.h"

namespace vbar::fsw::messaging {

namespace {

using gnc::test::Bytes;
using gnc::test::kServicer;
using gnc::test::packet_of;

TEST(Inbox, FilesByTimeTagWhateverTheOrderOfArrival) {
  Inbox inbox(kServicer);
  for (const std::int64_t ns : {30, 10, 20}) {
    EXPECT_EQ(inbox.receive(packet_of({ns}, ideal_navigation{})), Status::kOk);
  }
  ASSERT_EQ(inbox.queue<vbar::ideal_navigation>().size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(inbox.queue<vbar::ideal_navigation>()[k].tag.time.ns, static_cast<std::int64_t>(10 * (k + 1)));
  }
}

TEST(Inbox, RefusesADuplicateButNotAnotherPacketOfTheSameInstant) {
  Inbox inbox(kServicer);
  EXPECT_EQ(inbox.receive(packet_of({10}, executed_maneuver{}, 7)), Status::kOk);
  EXPECT_EQ(inbox.receive(packet_of({10}, executed_maneuver{}, 7)), Status::kBadSequence);
  EXPECT_EQ(inbox.receive(packet_of({10}, executed_maneuver{}, 8)), Status::kOk);
  EXPECT_EQ(inbox.queue<vbar::executed_maneuver>().size(), 2U);
  EXPECT_EQ(inbox.counters().rejected_other, 1);
}

TEST(Inbox, DropsTheNewestWhenFullAndKeepsWhatItHas) {
  Inbox inbox(kServicer);
  const auto capacity = static_cast<std::int64_t>(Inbox::kCapacity<ideal_navigation>);
  for (std::int64_t k = 0; k < capacity; ++k) {
    ideal_navigation message{};
    message.servicer_position_eci[0] = static_cast<double>(k);
    ASSERT_EQ(inbox.receive(packet_of({k}, message)), Status::kOk);
  }
  for (int k = 0; k < 5; ++k) {
    EXPECT_EQ(inbox.receive(packet_of({capacity + k}, ideal_navigation{})), Status::kFull);
  }
  EXPECT_EQ(inbox.counters().dropped_full, 5);
  ASSERT_EQ(inbox.queue<vbar::ideal_navigation>().size(), Inbox::kCapacity<ideal_navigation>);
  for (std::size_t k = 0; k < Inbox::kCapacity<ideal_navigation>; ++k) {
    EXPECT_EQ(inbox.queue<vbar::ideal_navigation>()[k].value.servicer_position_eci[0], static_cast<double>(k));
  }
}

TEST(Inbox, CountsEachRefusalByItsCause) {
  Inbox inbox(kServicer);
  const Bytes good = packet_of({1}, ideal_navigation{});

  Bytes flipped = good;
  flipped[20] ^= 0x10U;
  EXPECT_EQ(inbox.receive(flipped), Status::kBadChecksum);
  EXPECT_EQ(inbox.counters().rejected_checksum, 1);

  const Bytes cut(good.begin(), good.end() - 5);
  EXPECT_NE(inbox.receive(cut), Status::kOk);
  EXPECT_EQ(inbox.counters().rejected_length, 1);

  EXPECT_EQ(inbox.receive(packet_of({1}, maneuver_command{})), Status::kWrongType);  // not for the flight software
  EXPECT_EQ(inbox.counters().rejected_type, 1);

  EXPECT_NE(inbox.receive(packet_of({1}, ideal_navigation{}, 0, kServicer + 1)), Status::kOk);
  EXPECT_EQ(inbox.counters().rejected_other, 1);

  EXPECT_NE(inbox.receive({}), Status::kOk);
  EXPECT_EQ(inbox.counters().accepted, 0);
}

// The payload of one message under the APID of another: the type hash tells.
TEST(Inbox, RefusesAMessageUnderAnotherOnesName) {
  packets::PacketHeader header;
  header.apid = packets::Apid::kIdealNavigation;
  header.time = {1};
  header.spacecraft = kServicer;
  executed_maneuver message{};
  Bytes payload(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(payload.data(), 0, static_cast<int>(payload.size()));
  Bytes bytes(packets::kMaxPacketBytes);
  const auto size = packets::write_packet(header, payload, bytes);
  ASSERT_TRUE(size.ok());
  bytes.resize(size.value());

  Inbox inbox(kServicer);
  EXPECT_NE(inbox.receive(bytes), Status::kOk);
  EXPECT_TRUE(inbox.queue<vbar::ideal_navigation>().empty());
}

// encode() refuses a NaN, so it is put into the bytes by hand, with a CRC that fits.
TEST(Inbox, RefusesNaN) {
  ideal_navigation message{};
  message.target_velocity_eci[2] = std::numeric_limits<double>::quiet_NaN();
  Bytes payload(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(payload.data(), 0, static_cast<int>(payload.size()));
  packets::PacketHeader header;
  header.apid = packets::Apid::kIdealNavigation;
  header.spacecraft = kServicer;
  Bytes bytes(packets::kMaxPacketBytes);
  const auto size = packets::write_packet(header, payload, bytes);
  ASSERT_TRUE(size.ok());
  bytes.resize(size.value());

  Inbox inbox(kServicer);
  EXPECT_EQ(inbox.receive(bytes), Status::kNotFinite);
  EXPECT_EQ(inbox.counters().rejected_content, 1);
}

// No navigation uses it.
TEST(Inbox, FilesARange) {
  Inbox inbox(kServicer);
  range_measurement message{};
  message.range_m = 12.5;
  EXPECT_EQ(inbox.receive(packet_of({10}, message)), Status::kOk);
  ASSERT_EQ(inbox.queue<range_measurement>().size(), 1U);
  EXPECT_EQ(inbox.queue<range_measurement>()[0].value.range_m, 12.5);
}

TEST(Inbox, RefusesATickWithoutAPeriod) {
  Inbox inbox(kServicer);
  tick message{};
  EXPECT_EQ(inbox.receive(packet_of({1}, message)), Status::kOutOfRange);
  message.period_ns = 60;
  EXPECT_EQ(inbox.receive(packet_of({1}, message)), Status::kOk);
  EXPECT_EQ(inbox.step_period().ns, 60);
}

// Sums and differences of what gets in must stay within an int64.
TEST(Inbox, RefusesTimesOutsideTheClocksRange) {
  Inbox inbox(kServicer);
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
  for (const std::int64_t ns : {std::int64_t{-1}, std::numeric_limits<std::int64_t>::min(), kLatestTime.ns + 1, kMax}) {
    EXPECT_EQ(inbox.receive(packet_of({ns}, ideal_navigation{})), Status::kOutOfRange) << ns;
  }
  EXPECT_EQ(inbox.counters().rejected_content, 4);
  EXPECT_EQ(inbox.receive(packet_of(kLatestTime, ideal_navigation{})), Status::kOk);
  tick message{};
  message.period_ns = kMax;
  EXPECT_EQ(inbox.receive(packet_of({1}, message)), Status::kOutOfRange);
}

// Each message of the list, by its route: into its queue, into its place in the inbox, accepted without effect, or
// refused by its APID.
TEST(Inbox, FilesEveryMessageByItsRoute) {
  packets::for_each_message([]<class Message>() {
    using packets::RouteKind;
    constexpr packets::Route kRoute = packets::MessageTraits<Message>::kRoute;
    const auto made = std::make_unique<Inbox>(kServicer);  // two images: too large for a stack frame of all messages
    Inbox& inbox = *made;
    const Status status = inbox.receive(packet_of({1}, Message{}));
    if constexpr (kRoute.kind == RouteKind::kQueue) {
      EXPECT_EQ(status, Status::kOk) << Message::getTypeName();
      ASSERT_EQ(inbox.queue<Message>().size(), 1U) << Message::getTypeName();
      EXPECT_EQ(inbox.queue<Message>()[0].tag.time.ns, 1);
    } else if constexpr (kRoute.kind == RouteKind::kSpecial) {
      EXPECT_EQ(inbox.counters().rejected_type, 0) << Message::getTypeName();  // its own checks follow
    } else {
      EXPECT_EQ(status, Status::kWrongType) << Message::getTypeName();
    }
    EXPECT_EQ(packets::is_to_flight(packets::MessageTraits<Message>::kApid),
              kRoute.kind != RouteKind::kFromFlight && kRoute.kind != RouteKind::kBoard)
        << Message::getTypeName();
  });
}

// A full queue of one message leaves the room of the others; after the step all of them are empty.
TEST(Inbox, EveryQueueHasItsOwnRoomAndIsClearedWithTheStep) {
  Inbox inbox(kServicer);
  packets::for_each_message([&]<class Message>() {
    if constexpr (packets::MessageTraits<Message>::kRoute.kind == packets::RouteKind::kQueue) {
      for (std::uint16_t k = 0; k < Inbox::kCapacity<Message>; ++k) {
        EXPECT_EQ(inbox.receive(packet_of({1}, Message{}, k)), Status::kOk) << Message::getTypeName();
      }
      EXPECT_EQ(inbox.receive(packet_of({1}, Message{}, Inbox::kCapacity<Message>)), Status::kFull);
    }
  });
  inbox.clear(GpsTime{});
  packets::for_each_message([&]<class Message>() {
    if constexpr (packets::MessageTraits<Message>::kRoute.kind == packets::RouteKind::kQueue) {
      EXPECT_TRUE(inbox.queue<Message>().empty()) << Message::getTypeName();
      EXPECT_EQ(inbox.receive(packet_of({1}, Message{})), Status::kOk) << Message::getTypeName();
    }
  });
}

}  // namespace

// What leaves the flight software: numbered by kind, and never with a number that is none.

namespace {

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
  Outbox outbox_{gnc::test::kServicer, &OutboxTest::sink, &sent_};
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
    EXPECT_EQ(header(k).spacecraft, gnc::test::kServicer);
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

}  // namespace vbar::fsw::messaging
