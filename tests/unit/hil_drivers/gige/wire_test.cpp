// Commands and acknowledges written by hand from the tables of GigE Vision 1.2.

#include <numeric>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "hil_drivers/gige/protocol/big_endian.h"
#include "hil_drivers/gige/protocol/gvcp.h"
#include "hil_drivers/gige/protocol/gvsp.h"
#include "hil_drivers/gige/protocol/stream_setup.h"

namespace vbar::gige::wire::test {
namespace {

/// "01 a0 ff" to bytes.
Bytes hex(std::string_view text) {
  Bytes bytes;
  for (std::size_t k = 0; k + 1 < text.size();) {
    if (text[k] == ' ') {
      ++k;
      continue;
    }
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(std::string(text.substr(k, 2)), nullptr, 16)));
    k += 2;
  }
  return bytes;
}

}  // namespace
}  // namespace vbar::gige::wire::test

namespace vbar::gige::wire {
namespace {

using test::hex;

struct Case {
  const char* datagram;
  CommandMessage message;
};

const Case kCommands[] = {
    {"42 01 0002 0000 0001", {true, 1, Discovery{}}},
    {"42 01 0080 0004 0102 00000a00", {true, 0x102, ReadRegisters{{0xA00}}}},
    {"42 01 0080 0008 0102 00000938 00000d04", {true, 0x102, ReadRegisters{{0x938, 0xD04}}}},
    {"42 00 0082 0008 0003 00000a00 00000002", {false, 3, WriteRegisters{{{0xA00, 2}}}}},
    {"42 01 0084 0008 0004 00000200 0000 0200", {true, 4, ReadMemory{0x200, 512}}},
    {"42 01 0086 000c 0005 00010070 40a00000 00000000",
     {true, 5, WriteMemory{0x10070, {0x40, 0xA0, 0, 0, 0, 0, 0, 0}}}},
    {"42 00 0040 000c 0006 0000 0007 00000064 00ffffff", {false, 6, PacketResend{0, 7, 100, 0xFFFFFF}}},
};

TEST(Gvcp, CommandsAreReadAndWritten) {
  for (const Case& one : kCommands) {
    const auto decoded = decode_command(hex(one.datagram));
    ASSERT_TRUE(std::holds_alternative<CommandMessage>(decoded)) << one.datagram;
    EXPECT_EQ(std::get<CommandMessage>(decoded), one.message) << one.datagram;
    EXPECT_EQ(encode_command(one.message), hex(one.datagram)) << one.datagram;
  }
}

TEST(Gvcp, InvalidCommandsAreAnsweredWithTheirStatus) {
  const std::pair<const char*, Status> cases[] = {
      {"42 01 0002 0000 0000", Status::kInvalidHeader},                                 // id 0
      {"42 01 0080 0008 0001 00000a00", Status::kInvalidHeader},                        // a length that is not there
      {"42 01 0080 0003 0001 00000a", Status::kInvalidHeader},                          // a part of a word
      {"42 01 0080 0000 0001", Status::kInvalidHeader},                                 // no address
      {"42 01 0082 0004 0001 00000a00", Status::kInvalidHeader},                        // no value
      {"42 01 0084 0008 0001 00000201 0000 0004", Status::kBadAlignment},               // an odd address
      {"42 01 0084 0008 0001 00000200 0000 0003", Status::kBadAlignment},               // a part of a word
      {"42 01 0084 0008 0001 00000200 0000 ffff", Status::kInvalidParameter},           // more than fits
      {"42 01 0086 0004 0001 00000200", Status::kInvalidHeader},                        // no bytes
      {"42 01 0040 000c 0001 0000 0001 00000005 00000004", Status::kInvalidParameter},  // backwards
      {"42 01 0099 0000 0001", Status::kNotImplemented},
  };
  for (const auto& [datagram, status] : cases) {
    const auto decoded = decode_command(hex(datagram));
    ASSERT_TRUE(std::holds_alternative<RefusedCommand>(decoded)) << datagram;
    EXPECT_EQ(std::get<RefusedCommand>(decoded).status, status) << datagram;
    EXPECT_FALSE(std::get<RefusedCommand>(decoded).reason.empty());
  }
}

TEST(Gvcp, ForeignDatagramsAreNotAnswered) {
  for (const char* datagram : {"", "42", "42 01 0002 0000 00", "43 01 0002 0000 0001"})
    EXPECT_TRUE(std::holds_alternative<ForeignDatagram>(decode_command(hex(datagram)))) << datagram;
}

TEST(Gvcp, AcknowledgesAreWrittenAndRead) {
  const Acknowledge acknowledge{Status::kAccessDenied, 0x82, 9, hex("0000 0000")};
  const Bytes datagram = hex("8006 0083 0004 0009 0000 0000");
  EXPECT_EQ(encode_acknowledge(acknowledge), datagram);
  const Acknowledge decoded = decode_acknowledge(datagram);
  EXPECT_EQ(decoded.status, Status::kAccessDenied);
  EXPECT_EQ(decoded.command, 0x82);
  EXPECT_EQ(decoded.id, 9);
  EXPECT_EQ(decoded.body, acknowledge.body);
  for (const char* wrong : {"", "8006 0083 0004", "0000 0083 0005 0009 0000 0000", "0000 0082 0000 0001"})
    EXPECT_THROW((void)decode_acknowledge(hex(wrong)), std::invalid_argument) << wrong;
}

TEST(Gvcp, BodyThatDoesNotFitIsNotWritten) {
  EXPECT_THROW((void)encode_command({true, 1, WriteMemory{0, Bytes(kMaxGvcpBody)}}), std::length_error);
}

}  // namespace

// Stream packets written by hand from the tables of GigE Vision 1.2.

namespace {

const char* const kLeader =
    "0000 0001 01 000000 0000 0001 0000000102030405 01100007 000001f4 00000350 000002c6 00000098 0000 0000";

TEST(Gvsp, Leader) {
  const Leader leader{PayloadType::kImage, 0x102030405, PixelFormat::kMono16, 500, 848, 710, 152};
  Bytes datagram;
  encode_leader(Status::kSuccess, 1, leader, datagram);
  EXPECT_EQ(datagram, hex(kLeader));
  const StreamPacket packet = decode_stream_packet(datagram);
  EXPECT_EQ(packet.header, (StreamHeader{Status::kSuccess, 1, PacketKind::kLeader, 0}));
  EXPECT_EQ(std::get<Leader>(packet.body), leader);
}

TEST(Gvsp, DataAndTrailer) {
  Bytes datagram;
  encode_data(Status::kPacketResend, 0xFFFF, 0x010203, hex("f0ff 1000"), datagram);
  EXPECT_EQ(datagram, hex("0100 ffff 03 010203 f0ff 1000"));
  const StreamPacket data = decode_stream_packet(datagram);
  const ByteSpan bytes = std::get<Data>(data.body).bytes;
  EXPECT_EQ(Bytes(bytes.begin(), bytes.end()), hex("f0ff 1000"));
  EXPECT_EQ(data.header.packet, 0x010203U);

  encode_trailer(Status::kSuccess, 2, 623, {PayloadType::kImage, 848}, datagram);
  EXPECT_EQ(datagram, hex("0000 0002 02 00026f 0000 0001 00000350"));
  EXPECT_EQ(std::get<Trailer>(decode_stream_packet(datagram).body), (Trailer{PayloadType::kImage, 848}));
}

TEST(Gvsp, UnavailablePacketHasNoPayload) {
  Bytes datagram;
  encode_unavailable(3, 5, datagram);
  EXPECT_EQ(datagram, hex("800c 0003 03 000005"));
  EXPECT_TRUE(std::holds_alternative<NoPayload>(decode_stream_packet(datagram).body));
}

TEST(Gvsp, HostilePacketsAreRefused) {
  for (const char* wrong : {"", "0000 0001 03 0000", "0000 0000 03 000001 00", "0000 0001 09 000001 00",
                            "0000 0001 01 000000 0000 0001", "0000 0001 02 000001 0000",
                            "0000 0001 01 000000 0000 0009 0000000102030405 01100007 000001f4 00000350 000002c6 "
                            "00000098 0000 0000",
                            "0000 0001 01 000000 0000 0001 0000000102030405 ffffffff 000001f4 00000350 000002c6 "
                            "00000098 0000 0000"})
    EXPECT_THROW((void)decode_stream_packet(hex(wrong)), std::invalid_argument) << wrong;
}

}  // namespace

// Mono12Packed by hand: GigE Vision puts pixels ABCh and 123h into ABh 3Ch 12h.

namespace {

using Numbers = std::vector<std::uint16_t>;

TEST(Pixels, TwelveBitsInThreeHalvesOfAByte) {
  const Numbers dn{0xABC, 0x123, 0xFFF};
  const Bytes bytes = pack_pixels(PixelFormat::kMono12Packed, 12, dn);
  EXPECT_EQ(bytes, hex("ab 3c 12 ff 0f"));
  EXPECT_EQ(unpack_pixels(PixelFormat::kMono12Packed, 3, bytes), dn);
}

TEST(Pixels, SixteenBitsAreLeftAlignedAndLittleEndian) {
  EXPECT_EQ(pack_pixels(PixelFormat::kMono16, 12, Numbers{0xABC, 0x001}), hex("c0 ab 10 00"));
  EXPECT_EQ(pack_pixels(PixelFormat::kMono16, 10, Numbers{0x3FF}), hex("c0 ff"));
  EXPECT_EQ(unpack_pixels(PixelFormat::kMono16, 1, hex("c0 ab")), Numbers{0xABC0});
}

TEST(Pixels, EightBitsAreTheUpperOnes) {
  EXPECT_EQ(pack_pixels(PixelFormat::kMono8, 12, Numbers{0xABC}), hex("ab"));
  EXPECT_EQ(unpack_pixels(PixelFormat::kMono8, 1, hex("ab")), Numbers{0xAB});
}

TEST(Pixels, MissingBytesAreNamed) {
  EXPECT_THROW((void)unpack_pixels(PixelFormat::kMono12Packed, 3, hex("ab 3c 12 ff")), std::invalid_argument);
  EXPECT_THROW((void)unpack_pixels(PixelFormat::kMono16, 2, hex("ab 3c 12")), std::invalid_argument);
}

}  // namespace

}  // namespace vbar::gige::wire
namespace vbar::gige {

namespace {

/// All numbers of a converter, left-aligned.
std::vector<std::uint16_t> all_numbers(int bits) {
  std::vector<std::uint16_t> pixels(std::size_t{1} << bits);
  for (std::size_t k = 0; k < pixels.size(); ++k) pixels[k] = static_cast<std::uint16_t>(k << (16 - bits));
  return pixels;
}

TEST(PixelPadding, ConvertersOfEvenBitsAreFound) {
  for (const int bits : {8, 10, 12, 14, 16}) {
    PixelPadding padding(12);
    padding.observe(all_numbers(bits));
    EXPECT_EQ(padding.bits(), bits);
    EXPECT_EQ(padding.shift(), 16 - bits);
    EXPECT_TRUE(padding.is_decided());
  }
}

TEST(PixelPadding, EvenImageDecidesNothing) {
  PixelPadding padding(12);
  // The offset of 64, left-aligned, has ten zeros.
  padding.observe(std::vector<std::uint16_t>(1000, 64 << 4));
  EXPECT_FALSE(padding.is_decided());
  EXPECT_EQ(padding.shift(), 4);
  EXPECT_EQ(padding.bits(), 12);
}

TEST(PixelPadding, LaterImagesCorrectTheFirst) {
  PixelPadding padding(12);
  padding.observe(std::vector<std::uint16_t>(1000, 0));
  EXPECT_EQ(padding.shift(), 4);
  padding.observe(all_numbers(10));
  EXPECT_EQ(padding.bits(), 10);
  padding.observe(all_numbers(12));
  EXPECT_EQ(padding.bits(), 12);
}

TEST(PixelPadding, RightAlignedNumbersAreRecognised) {
  PixelPadding padding(12);
  std::vector<std::uint16_t> pixels(4096);
  std::iota(pixels.begin(), pixels.end(), std::uint16_t{0});
  padding.observe(pixels);
  EXPECT_EQ(padding.shift(), 0);
  EXPECT_EQ(padding.bits(), 12);
}

// A packet of 1400 bytes takes a slab of 2048 bytes and a descriptor of 256.
TEST(PacketPacing, PacketInTheBuffer) {
  EXPECT_EQ(bytes_in_buffer(1400), 2304U);
}

TEST(PacketPacing, BufferThatHoldsTheImageNeedsNoPause) {
  constexpr std::size_t kImage = 500 * 848 * 2;                    // 622 packets of 1364 bytes, leader and trailer
  EXPECT_EQ(packet_delay_ns({0, 832 * 2304}, kImage, 1400), 0.0);  // 624 = 0.75 * 832
  EXPECT_GT(packet_delay_ns({0, 831 * 2304}, kImage, 1400), 0.0);
}

TEST(PacketPacing, PauseOfTheReceiverFitsTheBuffer) {
  // Debian's limit of 212992 bytes, doubled by the kernel, holds 184.9 packets, of which three quarters are usable.
  EXPECT_NEAR(packet_delay_ns({0, 2 * 212992}, 848'000, 1400), 10e6 / (0.75 * 2 * 212992 / 2304), 1e-6);
}

TEST(PacketPacing, BufferAsWantedNeedsNoPause) {
  for (const std::size_t image : {std::size_t{500 * 848 * 2}, std::size_t{1920 * 1200 * 2}})
    EXPECT_EQ(packet_delay_ns({0, 2 * wanted_socket_buffer(image, 1400)}, image, 1400), 0.0);
}

TEST(PacketPacing, WholeSensorIsPacedWithFourMebibytes) {
  // 1920 x 1200 pixels of 16 bits are 3381 packets; 8 MiB hold 3640, but only 2730 while packets are read.
  EXPECT_NEAR(packet_delay_ns({4 << 20, 8 << 20}, 1920 * 1200 * 2, 1400), 10e6 / 2730.67, 0.01);
}

TEST(PacketPacing, KernelGrantsWhatIsRequestedUpToItsLimit) {
  const SocketBuffer small = granted_socket_buffer(16384);
  EXPECT_EQ(small.granted_bytes, 32768U);  // socket(7): the kernel doubles the value
  const SocketBuffer large = granted_socket_buffer(std::size_t{1} << 30);
  EXPECT_GE(large.granted_bytes, small.granted_bytes);
  EXPECT_FALSE(description(large, 0.0, 1400).empty());
}

}  // namespace

}  // namespace vbar::gige
