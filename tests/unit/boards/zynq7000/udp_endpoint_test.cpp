// The endpoint answers what it must: frames that another implementation sent, and frames built by hand from the RFCs.

#include "boards/zynq7000/udp_endpoint.h"

#include <array>
#include <cstdint>
#include <numeric>
#include <random>
#include <span>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vbar::test {
namespace {

// Ethernet frames for tests: some that another implementation sent, and a plain builder for the rest.

using Frame = std::vector<std::uint8_t>;

constexpr boards::zynq7000::MacAddress kBoardMac{0x02, 0x76, 0x62, 0x61, 0x72, 0x15};
constexpr boards::zynq7000::Ipv4Address kBoardAddress{10, 0, 2, 15};
constexpr std::uint16_t kBoardPort = 5000;
constexpr boards::zynq7000::MacAddress kHostMac{0x52, 0x55, 0x0a, 0x00, 0x02, 0x02};
constexpr boards::zynq7000::Ipv4Address kHostAddress{10, 0, 2, 2};

/// ARP request for 10.0.2.15, as QEMU's user network (libslirp 4.7) sent it.
Frame recorded_arp_request() {
  return {0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x52, 0x55, 0x0a, 0x00, 0x02, 0x02, 0x08, 0x06, 0x00,
          0x01, 0x08, 0x00, 0x06, 0x04, 0x00, 0x01, 0x52, 0x55, 0x0a, 0x00, 0x02, 0x02, 0x0a, 0x00,
          0x02, 0x02, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x0a, 0x00, 0x02, 0x0f, 0x00, 0x00, 0x00,
          0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00};
}

/// A datagram of 19 bytes from 10.0.2.2:40776 to 10.0.2.15:5000, likewise.
Frame recorded_datagram() {
  return {0x02, 0x76, 0x62, 0x61, 0x72, 0x15, 0x52, 0x55, 0x0a, 0x00, 0x02, 0x02, 0x08, 0x00, 0x45, 0x00,
          0x00, 0x2f, 0x00, 0x00, 0x00, 0x00, 0x40, 0x11, 0x62, 0xae, 0x0a, 0x00, 0x02, 0x02, 0x0a, 0x00,
          0x02, 0x0f, 0x9f, 0x48, 0x13, 0x88, 0x00, 0x1b, 0xab, 0x4b, 0x01, 0x01, 0x00, 0x00, 0x00, 0x0c,
          0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x01, 0x61, 0xe9, 0x1c, 0x9e};
}

void append16(Frame& frame, std::size_t value) {
  frame.push_back(static_cast<std::uint8_t>(value >> 8U));
  frame.push_back(static_cast<std::uint8_t>(value));
}

void set16(Frame& frame, std::size_t at, std::size_t value) {
  frame[at] = static_cast<std::uint8_t>(value >> 8U);
  frame[at + 1] = static_cast<std::uint8_t>(value);
}

/// The Internet checksum by another road than the code's: ones' complement addition is addition modulo 65535, here in
/// one 64-bit sum.
std::uint16_t reference_checksum(std::span<const std::uint8_t> bytes, std::uint64_t sum = 0) {
  for (std::size_t i = 0; i < bytes.size(); ++i) sum += std::uint64_t{bytes[i]} * (i % 2 == 0 ? 256U : 1U);
  const std::uint64_t folded = sum == 0 ? 0 : (sum - 1) % 65535 + 1;
  return static_cast<std::uint16_t>(65535 - folded);
}

std::uint64_t pseudo_header_sum(const boards::zynq7000::Ipv4Address& a, const boards::zynq7000::Ipv4Address& b,
                                std::size_t udp_size) {
  const auto words = [](const boards::zynq7000::Ipv4Address& x) {
    return std::uint64_t{x[0]} * 256 + x[1] + std::uint64_t{x[2]} * 256 + x[3];
  };
  return words(a) + words(b) + 17 + udp_size;
}

/// What a test may want wrong about an IPv4 packet from the host to the board.
struct Ipv4Options {
  boards::zynq7000::MacAddress destination_mac = kBoardMac;
  boards::zynq7000::MacAddress source_mac = kHostMac;
  boards::zynq7000::Ipv4Address source = kHostAddress;
  boards::zynq7000::Ipv4Address destination = kBoardAddress;
  std::uint8_t protocol = 17;
  std::uint16_t fragment = 0;
  std::size_t option_words = 0;
};

Frame ipv4_frame(std::span<const std::uint8_t> payload, const Ipv4Options& options = {}) {
  Frame frame(options.destination_mac.begin(), options.destination_mac.end());
  frame.insert(frame.end(), options.source_mac.begin(), options.source_mac.end());
  append16(frame, 0x0800);
  const std::size_t header_size = 20 + 4 * options.option_words;
  frame.push_back(static_cast<std::uint8_t>(0x40U | (header_size / 4)));
  frame.push_back(0);
  append16(frame, header_size + payload.size());
  append16(frame, 1);
  append16(frame, options.fragment);
  frame.push_back(64);
  frame.push_back(options.protocol);
  append16(frame, 0);
  frame.insert(frame.end(), options.source.begin(), options.source.end());
  frame.insert(frame.end(), options.destination.begin(), options.destination.end());
  frame.insert(frame.end(), 4 * options.option_words, 1);  // no operation
  set16(frame, 24, reference_checksum(std::span(frame).subspan(14, header_size)));
  frame.insert(frame.end(), payload.begin(), payload.end());
  return frame;
}

Frame udp(std::span<const std::uint8_t> payload, const Ipv4Options& options = {}, std::uint16_t from = 40000,
          std::uint16_t to = kBoardPort) {
  Frame datagram;
  append16(datagram, from);
  append16(datagram, to);
  append16(datagram, 8 + payload.size());
  append16(datagram, 0);
  datagram.insert(datagram.end(), payload.begin(), payload.end());
  const std::uint16_t sum =
      reference_checksum(datagram, pseudo_header_sum(options.source, options.destination, datagram.size()));
  set16(datagram, 6, sum == 0 ? 0xFFFF : sum);
  return datagram;
}

}  // namespace
}  // namespace vbar::test

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

// Nothing that arrives can make the endpoint read past a frame, answer where it must not, or deliver what was not sent.
// Frames are given as vectors of exactly their length, so that the address sanitizer sees any byte read beyond.

namespace {

constexpr std::array<std::uint8_t, 5> kPayload{0xDE, 0xAD, 0xBE, 0xEF, 0x01};

class HostileFramesTest : public testing::Test {
 protected:
  UdpEvent receive(const Frame& frame) { return endpoint_.receive(Frame(frame), reply_).event; }
  void expect_malformed(const Frame& frame) {
    const std::uint32_t before = endpoint_.counters().malformed;
    EXPECT_EQ(receive(frame), UdpEvent::kNothing);
    EXPECT_EQ(endpoint_.counters().malformed, before + 1);
  }
  void expect_not_for_us(const Frame& frame) {
    const std::uint32_t before = endpoint_.counters().not_for_us;
    EXPECT_EQ(receive(frame), UdpEvent::kNothing);
    EXPECT_EQ(endpoint_.counters().not_for_us, before + 1);
  }

  UdpEndpoint endpoint_{kBoardMac, kBoardAddress, kBoardPort};
  std::array<std::uint8_t, kMaxEthernetFrameBytes> reply_{};
};

TEST_F(HostileFramesTest, TruncatedAnywhere) {
  for (const Frame& whole : {recorded_arp_request(), recorded_datagram(), ipv4_frame(udp(kPayload))}) {
    // The recorded ARP request is padded: its last 18 bytes may go.
    const std::size_t needed = whole[13] == 0x06 ? 42 : whole.size();
    for (std::size_t size = 0; size < needed; ++size) {
      expect_malformed(Frame(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)));
    }
  }
}

// Past the Ethernet header every bit is covered by a checksum or must have one value.
TEST_F(HostileFramesTest, AnyFlippedBitOfADatagramIsSeen) {
  const Frame good = ipv4_frame(udp(kPayload));
  ASSERT_EQ(receive(good), UdpEvent::kDatagram);
  for (std::size_t bit = 8 * kEthernetHeaderBytes; bit < 8 * good.size(); ++bit) {
    Frame bad = good;
    bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ (1U << (bit % 8)));
    EXPECT_EQ(receive(bad), UdpEvent::kNothing) << "bit " << bit;
  }
}

TEST_F(HostileFramesTest, LengthsThatLie) {
  const Frame good = ipv4_frame(udp(kPayload));
  for (const std::size_t total :
       {std::size_t{0}, std::size_t{19}, std::size_t{27}, good.size() - 13, std::size_t{65535}}) {
    Frame bad = good;
    set16(bad, 16, total);
    set16(bad, 24, 0);
    set16(bad, 24, reference_checksum(std::span(bad).subspan(14, 20)));
    expect_malformed(bad);
  }
  for (const std::size_t size : {0, 7, 14, 65535}) {
    Frame datagram = udp(kPayload);
    set16(datagram, 4, size);
    set16(datagram, 6, 0);  // no checksum that could give it away
    expect_malformed(ipv4_frame(datagram));
  }
  Frame short_header = good;
  short_header[14] = 0x44;  // 16 bytes of header
  set16(short_header, 24, 0);
  set16(short_header, 24, reference_checksum(std::span(short_header).subspan(14, 16)));
  expect_malformed(short_header);
  Frame long_header = good;
  long_header[14] = 0x4F;  // 60 bytes of header in a packet of 33
  expect_malformed(long_header);
  expect_malformed(Frame(kMaxEthernetFrameBytes + 1, 0));
}

TEST_F(HostileFramesTest, Fragments) {
  expect_malformed(ipv4_frame(udp(kPayload), {.fragment = 0x2000}));  // more to come
  expect_malformed(ipv4_frame(udp(kPayload), {.fragment = 0x0001}));  // not the first
}

TEST_F(HostileFramesTest, SendersThatCannotBe) {
  for (const Ipv4Address& source : {Ipv4Address{0, 0, 0, 0}, Ipv4Address{127, 0, 0, 1}, Ipv4Address{224, 0, 0, 1},
                                    Ipv4Address{255, 255, 255, 255}, kBoardAddress}) {
    Ipv4Options options;
    options.source = source;
    expect_malformed(ipv4_frame(udp(kPayload, options), options));
  }
  expect_malformed(ipv4_frame(udp(kPayload), {.source_mac = {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}}));
  expect_malformed(ipv4_frame(udp(kPayload, {}, 0)));
}

TEST_F(HostileFramesTest, GroupsAndOthersAreNotServed) {
  expect_not_for_us(ipv4_frame(udp(kPayload), {.destination_mac = {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}}));
  expect_not_for_us(ipv4_frame(udp(kPayload), {.destination_mac = {0x02, 0, 0, 0, 0, 1}}));
  for (const Ipv4Address& destination : {Ipv4Address{10, 0, 2, 255}, Ipv4Address{255, 255, 255, 255}}) {
    Ipv4Options options;
    options.destination = destination;
    expect_not_for_us(ipv4_frame(udp(kPayload, options), options));
  }
  expect_not_for_us(ipv4_frame(udp(kPayload, {}, 40000, 5001)));
  expect_not_for_us(ipv4_frame(kPayload, {.protocol = 6}));
  Frame version6 = recorded_datagram();
  set16(version6, 12, 0x86DD);
  expect_not_for_us(version6);
}

TEST_F(HostileFramesTest, EchoThatIsNone) {
  Frame reply = {0, 0, 0xFF, 0xFF, 0, 0, 0, 0};  // an echo reply: answering it would never end
  expect_not_for_us(ipv4_frame(reply, {.protocol = 1}));
  expect_malformed(ipv4_frame(Frame{8, 0, 0, 0, 1, 2, 3, 4}, {.protocol = 1}));  // checksum
  expect_malformed(ipv4_frame(Frame{8, 0, 0xF7}, {.protocol = 1}));
}

TEST_F(HostileFramesTest, ArpThatLies) {
  Frame claims_our_address = recorded_arp_request();
  claims_our_address[31] = 15;
  expect_malformed(claims_our_address);
  Frame from_group = recorded_arp_request();
  from_group[22] = 0xFF;
  expect_malformed(from_group);
  Frame other_lengths = recorded_arp_request();
  other_lengths[18] = 255;
  expect_malformed(other_lengths);
  Frame unasked = recorded_arp_request();
  unasked[21] = 2;
  expect_not_for_us(unasked);
}

TEST_F(HostileFramesTest, ReplyBufferTooSmallIsNoReply) {
  std::array<std::uint8_t, 59> small{};
  EXPECT_EQ(endpoint_.receive(recorded_arp_request(), small).event, UdpEvent::kNothing);
  Frame ping = {8, 0, 0, 0, 0, 0, 0, 0};
  set16(ping, 2, reference_checksum(ping));
  EXPECT_EQ(endpoint_.receive(ipv4_frame(ping, {.protocol = 1}), small).event, UdpEvent::kNothing);
}

// 300,000 good frames with random bytes in random places: every one is counted exactly once, whatever it is taken for,
// and no datagram is delivered that lies outside its frame.
TEST_F(HostileFramesTest, RandomDamage) {
  std::mt19937 random(20240521);  // NOLINT: the same frames in every run
  Frame ping = {8, 0, 0, 0, 1, 2, 3, 4};
  set16(ping, 2, reference_checksum(ping));
  const std::array<Frame, 4> seeds{recorded_arp_request(), recorded_datagram(), ipv4_frame(udp(kPayload)),
                                   ipv4_frame(ping, {.protocol = 1})};
  constexpr std::uint32_t kFrames = 300'000;
  for (std::uint32_t i = 0; i < kFrames; ++i) {
    Frame frame = seeds[random() % seeds.size()];
    frame.resize(1 + random() % (2 * frame.size()));
    for (std::uint32_t changes = random() % 4; changes > 0; --changes) {
      frame[random() % frame.size()] = static_cast<std::uint8_t>(random());
    }
    const UdpReceived received = endpoint_.receive(frame, reply_);
    if (received.event == UdpEvent::kDatagram) {
      ASSERT_GE(received.bytes.data(), frame.data());
      ASSERT_LE(received.bytes.data() + received.bytes.size(), frame.data() + frame.size());
    }
  }
  const UdpCounters& counters = endpoint_.counters();
  EXPECT_EQ(
      counters.datagrams + counters.arp_replies + counters.echo_replies + counters.not_for_us + counters.malformed,
      kFrames);
  EXPECT_GT(counters.datagrams, 0U);
  EXPECT_GT(counters.echo_replies, 0U);
}

}  // namespace

}  // namespace vbar::boards::zynq7000
