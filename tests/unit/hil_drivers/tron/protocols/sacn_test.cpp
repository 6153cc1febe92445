// Data packets of E1.31, byte by byte as the standard's table 4-1 gives them.

#include "hil_drivers/tron/protocols/sacn.h"

#include <array>
#include <optional>
#include <random>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>

namespace vbar::tron::sacn {

namespace {

using ::testing::HasSubstr;

DataPacket example(std::size_t slots) {
  DataPacket packet;
  for (std::size_t k = 0; k < packet.cid.size(); ++k) packet.cid[k] = static_cast<std::uint8_t>(0x10 + k);
  packet.source_name = "vbar tron";
  packet.priority = 120;
  packet.synchronisation = 0x0203;
  packet.sequence = 0xFE;
  packet.universe = 0x1234;
  for (std::size_t k = 0; k < slots; ++k) packet.slots.push_back(static_cast<std::uint8_t>(k * 7));
  return packet;
}

Bytes bytes_of(const DataPacket& packet) {
  Bytes bytes;
  encode_data_packet(packet, bytes);
  return bytes;
}

std::string refusal_of(ByteSpan datagram) {
  try {
    (void)decode_data_packet(datagram);
  } catch (const std::invalid_argument& refusal) {
    return refusal.what();
  }
  return "accepted";
}

Bytes part(const Bytes& bytes, std::size_t from, std::size_t count) {
  return {bytes.begin() + static_cast<std::ptrdiff_t>(from), bytes.begin() + static_cast<std::ptrdiff_t>(from + count)};
}

// Lengths of a full packet in the standard: 0x726E, 0x7258, 0x720B.
TEST(DataPacket, HasTheBytesOfTheStandard) {
  const Bytes bytes = bytes_of(example(512));
  ASSERT_EQ(bytes.size(), 638U);
  EXPECT_EQ(part(bytes, 0, 16), (Bytes{0, 0x10, 0, 0, 0x41, 0x53, 0x43, 0x2D, 0x45, 0x31, 0x2E, 0x31, 0x37, 0, 0, 0}));
  EXPECT_EQ(part(bytes, 16, 6), (Bytes{0x72, 0x6E, 0, 0, 0, 4}));
  EXPECT_EQ(part(bytes, 22, 3), (Bytes{0x10, 0x11, 0x12}));
  EXPECT_EQ(part(bytes, 38, 6), (Bytes{0x72, 0x58, 0, 0, 0, 2}));
  EXPECT_EQ(std::string(bytes.begin() + 44, bytes.begin() + 53), "vbar tron");
  EXPECT_EQ(bytes[107], 0);
  EXPECT_EQ(part(bytes, 108, 7), (Bytes{120, 2, 3, 0xFE, 0, 0x12, 0x34}));
  EXPECT_EQ(part(bytes, 115, 11), (Bytes{0x72, 0x0B, 2, 0xA1, 0, 0, 0, 1, 0x02, 0x01, 0}));
  EXPECT_EQ(part(bytes, 126, 3), (Bytes{0, 7, 14}));
}

TEST(DataPacket, HasTheOptionsInTheirBits) {
  DataPacket packet = example(1);
  packet.is_preview = true;
  EXPECT_EQ(bytes_of(packet)[112], 0x80);
  packet.is_preview = false;
  packet.is_terminated = true;
  EXPECT_EQ(bytes_of(packet)[112], 0x40);
  packet.is_synchronisation_forced = true;
  EXPECT_EQ(bytes_of(packet)[112], 0x60);
}

TEST(DataPacket, IsReadAsItWasWrittenWithEveryNumberOfSlots) {
  for (std::size_t slots = 0; slots <= 512; ++slots) {
    DataPacket packet = example(slots);
    packet.is_terminated = slots % 2 == 0;
    packet.start_code = static_cast<std::uint8_t>(slots);
    EXPECT_EQ(bytes_of(packet).size(), 126 + slots);
    EXPECT_EQ(decode_data_packet(bytes_of(packet)), packet);
  }
}

TEST(DataPacket, BytesAfterThePacketAreNotRead) {
  Bytes bytes = bytes_of(example(24));
  bytes.resize(638, 0xEE);
  EXPECT_EQ(decode_data_packet(bytes), example(24));
}

TEST(DataPacket, RefusesEveryPacketThatEndsEarly) {
  const Bytes bytes = bytes_of(example(24));
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_THAT(refusal_of(ByteSpan(bytes).first(size)), HasSubstr("sACN packet, byte ")) << size;
}

TEST(DataPacket, NamesThePlaceOfWhatItRefuses) {
  const Bytes good = bytes_of(example(24));
  const auto refusal = [&](std::size_t at, std::uint8_t value) {
    Bytes bytes = good;
    bytes[at] = value;
    return refusal_of(bytes);
  };
  EXPECT_THAT(refusal(5, 'X'), HasSubstr("byte 5: 0x58 instead of 0x53: not a data packet of E1.31"));
  EXPECT_THAT(refusal(21, 8), HasSubstr("byte 21: 0x08 instead of 0x04"));  // E1.31 synchronisation, discovery
  EXPECT_THAT(refusal(43, 1), HasSubstr("byte 43"));
  EXPECT_THAT(refusal(16, 0x60), HasSubstr("byte 16: the flags"));
  EXPECT_THAT(refusal(17, 0xFF), HasSubstr("byte 16: the packet states 271 bytes, 150 have arrived"));
  EXPECT_THAT(refusal(39, 0), HasSubstr("byte 38: a layer of"));
  EXPECT_THAT(refusal(116, 0), HasSubstr("byte 115: a layer of"));
  EXPECT_THAT(refusal(108, 201), HasSubstr("byte 108: priority 201"));
  EXPECT_THAT(refusal(113, 0xFA), HasSubstr("byte 113: universe"));
  EXPECT_THAT(refusal(124, 0), HasSubstr("byte 123: 0 values where the packet has 25"));
  EXPECT_THAT(refusal(124, 26), HasSubstr("byte 123: 26 values where the packet has 25"));
  Bytes nameless = good;
  for (std::size_t k = 44; k < 108; ++k) nameless[k] = 'n';
  EXPECT_THAT(refusal_of(nameless), HasSubstr("byte 44: the name of the source does not end"));
  Bytes nowhere = good;
  nowhere[113] = nowhere[114] = 0;
  EXPECT_THAT(refusal_of(nowhere), HasSubstr("byte 113: universe 0"));
}

TEST(DataPacket, IsNotWrittenWithFieldsThatTheStandardDoesNotPermit) {
  Bytes bytes;
  const auto is_refused = [&](auto change) {
    DataPacket packet = example(3);
    change(packet);
    EXPECT_THROW(encode_data_packet(packet, bytes), std::invalid_argument);
  };
  is_refused([](DataPacket& packet) { packet.priority = 201; });
  is_refused([](DataPacket& packet) { packet.universe = 0; });
  is_refused([](DataPacket& packet) { packet.universe = 64000; });
  is_refused([](DataPacket& packet) { packet.source_name = std::string(64, 'n'); });
  is_refused([](DataPacket& packet) { packet.source_name = std::string("a\0b", 3); });
  is_refused([](DataPacket& packet) { packet.slots.resize(513); });
}

TEST(DataPacket, SurvivesAnyBytes) {
  std::mt19937 random(4);
  const Bytes good = bytes_of(example(24));
  for (int trial = 0; trial < 20000; ++trial) {
    Bytes bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(100 + random() % (good.size() - 99)));
    for (int change = 0; change < 2; ++change) bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    try {
      const DataPacket packet = decode_data_packet(bytes);
      ASSERT_EQ(decode_data_packet(bytes_of(packet)), packet);
    } catch (const std::invalid_argument&) {
    }
  }
}

}  // namespace

// What the source sends: read from a socket.

namespace {

using boost::asio::ip::udp;

class SenderTest : public ::testing::Test {
 protected:
  [[nodiscard]] SacnSettings settings() const {
    SacnSettings settings;
    settings.address = "127.0.0.1";
    settings.port = socket_.local_endpoint().port();
    settings.universe = 7;
    settings.start_slot = 3;
    settings.priority = 150;
    return settings;
  }
  /// The next packet; nothing if none is there.
  std::optional<DataPacket> next(int patience_ms = 60000) {
    pollfd waiting{socket_.native_handle(), POLLIN, 0};
    if (::poll(&waiting, 1, patience_ms) != 1) return std::nullopt;
    Bytes bytes(2000);
    bytes.resize(socket_.receive(boost::asio::buffer(bytes)));
    EXPECT_EQ(bytes.size(), 638U);
    return decode_data_packet(bytes);
  }

  boost::asio::io_context context_;
  udp::socket socket_{context_, udp::endpoint(boost::asio::ip::address_v4::loopback(), 0)};
};

TEST_F(SenderTest, PutsValuesIntoTwoSlotsEachCoarseFirst) {
  Sender sender(settings(), "tron");
  sender.send(std::array<std::uint16_t, 2>{0x1234, 0xFFFE});
  const auto packet = next();
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->universe, 7);
  EXPECT_EQ(packet->priority, 150);
  EXPECT_EQ(packet->source_name, "vbar tron");
  EXPECT_EQ(packet->start_code, 0);
  ASSERT_EQ(packet->slots.size(), 512U);
  EXPECT_EQ(Bytes(packet->slots.begin(), packet->slots.begin() + 7), (Bytes{0, 0, 0x12, 0x34, 0xFF, 0xFE, 0}));
  std::array<std::uint16_t, 3> read{};
  load_values(packet->slots, 3, read);
  EXPECT_THAT(read, ::testing::ElementsAre(0x1234, 0xFFFE, 0));
}

TEST_F(SenderTest, CountsItsPacketsAndKeepsItsLastValues) {
  Sender sender(settings(), "tron");
  sender.keep_alive();  // nothing to keep
  for (int k = 0; k < 300; ++k) {
    if (k % 2 == 0)
      sender.send(std::array<std::uint16_t, 1>{static_cast<std::uint16_t>(k)});
    else
      sender.keep_alive();
    const auto packet = next();
    ASSERT_TRUE(packet);
    EXPECT_EQ(packet->sequence, k % 256);
    EXPECT_EQ(packet->slots[2] * 256 + packet->slots[3], k - k % 2);
    EXPECT_FALSE(packet->is_terminated);
  }
  EXPECT_EQ(sender.packets(), 300U);
}

TEST_F(SenderTest, EndsWithThreeTerminatedPacketsOnce) {
  {
    Sender sender(settings(), "tron");
    sender.send(std::array<std::uint16_t, 1>{5});
    ASSERT_TRUE(next());
    sender.terminate();
    for (int k = 1; k <= 3; ++k) {
      const auto packet = next();
      ASSERT_TRUE(packet);
      EXPECT_TRUE(packet->is_terminated);
      EXPECT_EQ(packet->sequence, k);
    }
    sender.terminate();
    sender.keep_alive();
    EXPECT_FALSE(next(50));
    sender.send(std::array<std::uint16_t, 1>{6});  // begins again
    const auto packet = next();
    ASSERT_TRUE(packet);
    EXPECT_FALSE(packet->is_terminated);
  }
  for (int k = 0; k < 3; ++k) {
    const auto packet = next();
    ASSERT_TRUE(packet) << "the destructor ends the source";
    EXPECT_TRUE(packet->is_terminated);
  }
  EXPECT_FALSE(next(50));
}

TEST_F(SenderTest, ASourceThatSentNothingDoesNotEnd) {
  { const Sender sender(settings(), "tron"); }
  EXPECT_FALSE(next(50));
}

TEST_F(SenderTest, RefusesValuesBeyondTheUniverse) {
  SacnSettings late = settings();
  late.start_slot = 490;
  Sender sender(late, "tron");
  sender.send(std::array<std::uint16_t, 11>{});
  EXPECT_THROW(sender.send(std::array<std::uint16_t, 12>{}), std::invalid_argument);
}

TEST_F(SenderTest, AReceiverThatIsNotThereIsNoError) {
  const SacnSettings nobody = settings();
  socket_.close();
  Sender sender(nobody, "tron");
  for (int k = 0; k < 10; ++k) sender.send(std::array<std::uint16_t, 1>{1});
  EXPECT_EQ(sender.packets(), 10U);
}

TEST(Sender, RefusesAnAddressThatIsNone) {
  SacnSettings settings;
  settings.address = "lights";
  EXPECT_THROW(Sender(settings, "tron"), std::runtime_error);
  settings.address = "127.0.0.1";
  settings.universe = 0;
  EXPECT_THROW(Sender(settings, "tron"), std::invalid_argument);
}

TEST(Cid, IsThatOfTheBench) {
  EXPECT_EQ(cid_of_bench("tron"), cid_of_bench("tron"));
  EXPECT_NE(cid_of_bench("tron"), cid_of_bench("other"));
  EXPECT_EQ(cid_of_bench("tron")[6] >> 4U, 8);     // version
  EXPECT_EQ(cid_of_bench("tron")[8] >> 6U, 0b10);  // variant
}

TEST(Levels, SlotsBeyondAShortPacketAreZero) {
  std::array<std::uint16_t, 3> values{};
  load_values(std::vector<std::uint8_t>{1, 2, 3}, 1, values);
  EXPECT_THAT(values, ::testing::ElementsAre(0x0102, 0x0300, 0));
  load_values(std::vector<std::uint8_t>{1, 2, 3}, 500, values);
  EXPECT_THAT(values, ::testing::ElementsAre(0, 0, 0));
}

}  // namespace

}  // namespace vbar::tron::sacn
