// The endpoint answers what it must: frames that another implementation sent, and frames built by hand from the RFCs.

#include "boards/zynq7000/udp_endpoint.h"

#include <array>
#include <numeric>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/boards/zynq7000/network_frames.h"

namespace vbar::boards::zynq7000 {
namespace {

using testing::ElementsAreArray;
using namespace vbar::test;

class UdpEndpointTest : public testing::Test {
 protected:
  // What is received points into the frame, so the frame is kept.
  UdpReceived receive(const Frame& frame) {
    frame_ = frame;
    return endpoint_.receive(frame_, reply_);
  }

  Frame frame_;
  UdpEndpoint endpoint_{kBoardMac, kBoardAddress, kBoardPort};
  std::array<std::uint8_t, kMaxEthernetFrameBytes> reply_{};
};

TEST_F(UdpEndpointTest, AnswersArpOfLibslirp) {
  const UdpReceived received = receive(recorded_arp_request());
  ASSERT_EQ(received.event, UdpEvent::kReply);
  // RFC 826: request turned round, sender's hardware address filled in; padded to Ethernet's 60 bytes.
  Frame expected = {0x52, 0x55, 0x0a, 0x00, 0x02, 0x02, 0x02, 0x76, 0x62, 0x61, 0x72, 0x15, 0x08, 0x06,
                    0x00, 0x01, 0x08, 0x00, 0x06, 0x04, 0x00, 0x02, 0x02, 0x76, 0x62, 0x61, 0x72, 0x15,
                    0x0a, 0x00, 0x02, 0x0f, 0x52, 0x55, 0x0a, 0x00, 0x02, 0x02, 0x0a, 0x00, 0x02, 0x02};
  expected.resize(60);
  EXPECT_THAT(received.bytes, ElementsAreArray(expected));
}

TEST_F(UdpEndpointTest, IgnoresArpForOthers) {
  Frame frame = recorded_arp_request();
  frame[41] = 16;
  EXPECT_EQ(receive(frame).event, UdpEvent::kNothing);
  EXPECT_EQ(endpoint_.counters().not_for_us, 1U);
}

TEST_F(UdpEndpointTest, TakesDatagramOfLibslirp) {
  const Frame frame = recorded_datagram();
  const UdpReceived received = receive(frame);
  ASSERT_EQ(received.event, UdpEvent::kDatagram);
  EXPECT_THAT(received.bytes, ElementsAreArray(std::span(frame).subspan(42)));
  EXPECT_EQ(received.from.mac, kHostMac);
  EXPECT_EQ(received.from.address, kHostAddress);
  EXPECT_EQ(received.from.port, 40776);
}

TEST_F(UdpEndpointTest, EthernetPaddingIsNotPayload) {
  const std::array<std::uint8_t, 2> payload{7, 8};
  Frame frame = ipv4_frame(udp(payload));
  frame.resize(kMinEthernetFrameBytes, 0xEE);
  EXPECT_THAT(receive(frame).bytes, ElementsAreArray(payload));
}

TEST_F(UdpEndpointTest, SkipsIpOptions) {
  const std::array<std::uint8_t, 3> payload{1, 2, 3};
  const UdpReceived received = receive(ipv4_frame(udp(payload), {.option_words = 10}));
  ASSERT_EQ(received.event, UdpEvent::kDatagram);
  EXPECT_THAT(received.bytes, ElementsAreArray(payload));
}

// RFC 768: an all-zero checksum means that the sender computed none.
TEST_F(UdpEndpointTest, TakesDatagramWithoutChecksum) {
  const std::array<std::uint8_t, 3> payload{1, 2, 3};
  Frame datagram = udp(payload);
  set16(datagram, 6, 0);
  EXPECT_EQ(receive(ipv4_frame(datagram)).event, UdpEvent::kDatagram);
}

// RFC 792: type 0, the rest of the request, and a checksum that makes the whole sum to zero.
TEST_F(UdpEndpointTest, AnswersPing) {
  Frame request = {8, 0, 0, 0, 0x12, 0x34, 0, 1};
  request.resize(8 + 55, 0xA5);  // odd length: the last byte counts as a word's upper half
  set16(request, 2, reference_checksum(request));
  const UdpReceived received = receive(ipv4_frame(request, {.protocol = 1}));
  ASSERT_EQ(received.event, UdpEvent::kReply);
  ASSERT_EQ(received.bytes.size(), 34 + request.size());
  const auto echo = received.bytes.subspan(34);
  EXPECT_EQ(echo[0], 0);
  EXPECT_THAT(echo.subspan(4), ElementsAreArray(std::span(request).subspan(4)));
  EXPECT_EQ(reference_checksum(echo), 0);
  EXPECT_EQ(reference_checksum(received.bytes.subspan(14, 20)), 0);
}

// What one endpoint writes another takes, at every size that fits, and the frame's checksums hold by another road.
TEST_F(UdpEndpointTest, WritesWhatAnotherEndpointReads) {
  UdpEndpoint host(kHostMac, kHostAddress, 40000);
  std::array<std::uint8_t, kMaxEthernetFrameBytes> frame{};
  std::array<std::uint8_t, kMaxDatagramBytes> payload{};
  std::iota(payload.begin(), payload.end(), std::uint8_t{1});
  for (std::size_t size = 0; size <= kMaxDatagramBytes; ++size) {
    const auto sent = std::span(payload).first(size);
    const auto written = endpoint_.write_datagram({kHostMac, kHostAddress, 40000}, sent, frame);
    ASSERT_TRUE(written.ok()) << size;
    ASSERT_GE(written.value(), kMinEthernetFrameBytes);
    EXPECT_EQ(reference_checksum(std::span(frame).subspan(14, 20)), 0);
    EXPECT_EQ(reference_checksum(std::span(frame).subspan(34, 8 + size),
                                 pseudo_header_sum(kBoardAddress, kHostAddress, 8 + size)),
              0);
    const UdpReceived received = host.receive(std::span(frame).first(written.value()), reply_);
    ASSERT_EQ(received.event, UdpEvent::kDatagram) << size;
    ASSERT_THAT(received.bytes, ElementsAreArray(sent));
    EXPECT_EQ(received.from.port, kBoardPort);
  }
}

// RFC 768: a checksum that comes out as zero is sent as all ones, since zero means none.
TEST_F(UdpEndpointTest, ZeroChecksumIsSentAsOnes) {
  std::array<std::uint8_t, kMaxEthernetFrameBytes> frame{};
  int found = 0;
  for (unsigned word = 0; word <= 0xFFFF; ++word) {
    const std::array<std::uint8_t, 2> payload{static_cast<std::uint8_t>(word >> 8U), static_cast<std::uint8_t>(word)};
    ASSERT_TRUE(endpoint_.write_datagram({kHostMac, kHostAddress, 40000}, payload, frame).ok());
    ASSERT_FALSE(frame[40] == 0 && frame[41] == 0) << word;
    found += frame[40] == 0xFF && frame[41] == 0xFF ? 1 : 0;
  }
  EXPECT_GE(found, 1);
}

TEST_F(UdpEndpointTest, RefusesDatagramThatDoesNotFit) {
  std::array<std::uint8_t, 2 * kMaxEthernetFrameBytes> frame{};
  std::array<std::uint8_t, kMaxDatagramBytes + 1> payload{};
  EXPECT_EQ(endpoint_.write_datagram({}, payload, frame).status(), fsw::Status::kTooLong);
  EXPECT_EQ(endpoint_.write_datagram({}, std::span(payload).first(100), std::span(frame).first(141)).status(),
            fsw::Status::kTooLong);
  EXPECT_EQ(endpoint_.write_datagram({}, {}, std::span(frame).first(59)).status(), fsw::Status::kTooLong);
}

}  // namespace
}  // namespace vbar::boards::zynq7000
