// What the source sends: read from a socket.

#include "hil_drivers/tron/sacn/sender.h"

#include <array>
#include <optional>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>

#include "hil_drivers/tron/sacn/levels.h"

namespace vbar::tron::sacn {
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
