// The space packet's bytes against CCSDS 133.0-B-2, written out by hand, and what a hostile wire may do to them.

#include "fsw/packets/packet.h"

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/core/crc32.h"
#include "fsw/packets/crc.h"

namespace vbar::fsw::packets {

namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes written(const PacketHeader& header, const Bytes& payload) {
  Bytes out(kMaxPacketBytes);
  const Result<std::size_t> size = write_packet(header, payload, out);
  EXPECT_TRUE(size.ok());
  out.resize(size.value());
  return out;
}

/// Puts the right CRC behind whatever the test did to the bytes before it.
void sign(Bytes& packet) {
  const std::uint16_t crc = crc16_ccitt_false(std::span(packet).first(packet.size() - 2));
  packet[packet.size() - 2] = static_cast<std::uint8_t>(crc >> 8U);
  packet[packet.size() - 1] = static_cast<std::uint8_t>(crc & 0xFFU);
}

PacketHeader example_header() {
  PacketHeader header;
  header.apid = Apid::kIdealNavigation;
  header.sequence_count = 0x1234;
  header.time = GpsTime{0x0102030405060708};
  header.spacecraft = 0xAB;
  header.unit = 0xCD;
  return header;
}

TEST(Packet, FieldsStandWhereTheStandardPutsThem) {
  const Bytes packet = written(example_header(), {0xDE, 0xAD});
  // 000 1 1 000_0001_0000: version 0, telecommand, secondary header, APID 0x010. 11 01_0010_0011_0100: unsegmented,
  // 0x1234. Length field: octets of the data field less one = 16 - 6 + 2 + 2 - 1 = 13.
  const Bytes expected{0x18, 0x10, 0xD2, 0x34, 0x00, 0x0D, 0x01, 0x02, 0x03,
                       0x04, 0x05, 0x06, 0x07, 0x08, 0xAB, 0xCD, 0xDE, 0xAD};
  ASSERT_EQ(packet.size(), expected.size() + kPacketCrcBytes);
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), packet.begin()));
}

TEST(Packet, TelemetryHasNoTelecommandBit) {
  PacketHeader header;
  header.apid = Apid::kTelemetryHealth;
  EXPECT_EQ(written(header, {})[0], 0x0D);
  EXPECT_EQ(written(header, {})[1], 0x03);
}

TEST(Packet, ParsesWhatWasWritten) {
  PacketHeader header = example_header();
  header.flags = SequenceFlags::kContinuation;
  header.time = GpsTime{-1};
  const Bytes payload{1, 2, 3, 0, 255};
  const Bytes packet = written(header, payload);
  const Result<PacketView> view = parse_packet(packet);
  ASSERT_TRUE(view.ok());
  EXPECT_EQ(view.value().header.apid, header.apid);
  EXPECT_EQ(view.value().header.flags, header.flags);
  EXPECT_EQ(view.value().header.sequence_count, header.sequence_count);
  EXPECT_EQ(view.value().header.time, header.time);
  EXPECT_EQ(view.value().header.spacecraft, header.spacecraft);
  EXPECT_EQ(view.value().header.unit, header.unit);
  EXPECT_TRUE(std::equal(payload.begin(), payload.end(), view.value().payload.begin(), view.value().payload.end()));
}

TEST(Packet, SequenceCountKeepsFourteenBits) {
  PacketHeader header = example_header();
  header.sequence_count = 0xFFFF;
  const Result<PacketView> view = parse_packet(written(header, {}));
  ASSERT_TRUE(view.ok());
  EXPECT_EQ(view.value().header.sequence_count, 0x3FFF);
  EXPECT_EQ(view.value().header.flags, SequenceFlags::kUnsegmented);
}

TEST(Packet, LargestPayloadFitsAndOneMoreByteDoesNot) {
  const Bytes largest(kMaxPayloadBytes, 0x5A);
  EXPECT_EQ(written(example_header(), largest).size(), kMaxPacketBytes);
  EXPECT_TRUE(parse_packet(written(example_header(), largest)).ok());
  Bytes out(kMaxPacketBytes + 1);
  EXPECT_EQ(write_packet(example_header(), Bytes(kMaxPayloadBytes + 1), out).status(), Status::kTooLong);
}

TEST(Packet, ShortOutputIsRefused) {
  Bytes out(kPacketHeaderBytes + kPacketCrcBytes + 3);
  EXPECT_EQ(write_packet(example_header(), Bytes(4), out).status(), Status::kTooLong);
  EXPECT_TRUE(write_packet(example_header(), Bytes(3), out).ok());
}

TEST(Packet, ApidOfMoreThanElevenBitsIsRefused) {
  PacketHeader header;
  header.apid = static_cast<Apid>(0x800);
  Bytes out(64);
  EXPECT_EQ(write_packet(header, {}, out).status(), Status::kInvalidArgument);
}

TEST(Packet, EveryTruncationIsTooShort) {
  const Bytes packet = written(example_header(), {1, 2, 3});
  for (std::size_t size = 0; size < packet.size(); ++size) {
    EXPECT_EQ(parse_packet(std::span(packet).first(size)).status(), Status::kTooShort) << size;
  }
}

TEST(Packet, BytesBeyondTheStatedLengthAreTooLong) {
  Bytes packet = written(example_header(), {1, 2, 3});
  packet.push_back(0);
  EXPECT_EQ(parse_packet(packet).status(), Status::kTooLong);
}

TEST(Packet, StatedLengthBelowTheHeadersIsTooShort) {
  Bytes packet = written(example_header(), {});
  packet[5] = 10;  // 17 octets: no room for secondary header and CRC
  sign(packet);
  EXPECT_EQ(parse_packet(packet).status(), Status::kTooShort);
}

TEST(Packet, StatedLengthBeyondTheLargestPacketIsTooLong) {
  Bytes packet = written(example_header(), Bytes(kMaxPayloadBytes));
  packet.push_back(0);
  const std::size_t field = packet.size() - 7;
  packet[4] = static_cast<std::uint8_t>(field >> 8U);
  packet[5] = static_cast<std::uint8_t>(field & 0xFFU);
  sign(packet);
  EXPECT_EQ(parse_packet(packet).status(), Status::kTooLong);
}

// CRC-16/CCITT detects every error of one or two bits in messages of this length (its order is 32767 bits).
TEST(Packet, EveryFlippedBitIsRefused) {
  Bytes packet = written(example_header(), {1, 2, 3, 4, 5, 6, 7, 8});
  for (std::size_t bit = 0; bit < packet.size() * 8; ++bit) {
    const auto mask = static_cast<std::uint8_t>(1U << (bit % 8));
    packet[bit / 8] ^= mask;
    EXPECT_FALSE(parse_packet(packet).ok()) << "bit " << bit;
    packet[bit / 8] ^= mask;
  }
  EXPECT_TRUE(parse_packet(packet).ok());
}

TEST(Packet, AnotherVersionTypeOrMissingSecondaryHeaderIsTheWrongType) {
  for (const std::uint8_t mask : {0x80, 0x40, 0x20, 0x10, 0x08}) {
    Bytes packet = written(example_header(), {1});
    packet[0] ^= mask;
    sign(packet);
    EXPECT_EQ(parse_packet(packet).status(), Status::kWrongType) << int{mask};
  }
}

TEST(Packet, RandomBytesAreNeverAPacket) {
  std::mt19937 random(1);
  int accepted = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    Bytes noise(random() % 64);
    for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random());
    accepted += parse_packet(noise).ok() ? 1 : 0;
  }
  // The stated length (2^-16), the CRC (2^-16) and the flags (2^-5) must all agree by chance: 1e-7 expected of 20,000
  // trials.
  EXPECT_EQ(accepted, 0);
}

}  // namespace

// Check values of the catalogue of parametrised CRC algorithms (G. Cook, "CRC RevEng"): the checksum of "123456789".
// And the definition: the remainder of a division of polynomials, one bit at a time.

namespace {

constexpr std::array<std::uint8_t, 9> kCheckInput{'1', '2', '3', '4', '5', '6', '7', '8', '9'};

TEST(Crc, Crc16CcittFalseHasItsCatalogueCheckValue) {
  EXPECT_EQ(crc16_ccitt_false(kCheckInput), 0x29B1);  // CRC-16/IBM-3740, also known as CCITT-FALSE
}

TEST(Crc, Crc32HasItsCatalogueCheckValue) {
  EXPECT_EQ(crc32_ieee(kCheckInput), 0xCBF43926U);  // CRC-32/ISO-HDLC
}

TEST(Crc, NothingHasTheStartValue) {
  EXPECT_EQ(crc16_ccitt_false({}), 0xFFFF);
  EXPECT_EQ(crc32_ieee({}), 0U);  // start and final XOR cancel
}

std::uint16_t crc16_by_bits(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xFFFF;
  for (const std::uint8_t byte : bytes)
    for (int bit = 7; bit >= 0; --bit) {
      const bool divides = (crc >> 15U & 1U) != (static_cast<std::uint32_t>(byte) >> bit & 1U);
      crc = (crc << 1U ^ (divides ? 0x1021U : 0U)) & 0xFFFFU;
    }
  return static_cast<std::uint16_t>(crc);
}

std::uint32_t crc32_register_by_bits(std::uint32_t crc, std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes)
    for (int bit = 0; bit < 8; ++bit) {
      const bool divides = (crc & 1U) != (static_cast<std::uint32_t>(byte) >> bit & 1U);
      crc = crc >> 1U ^ (divides ? 0xEDB88320U : 0U);
    }
  return crc;
}

// All lengths up to several times the bytes that are taken at once, from every alignment.
TEST(Crc, EveryLengthAndAlignmentGivesTheRemainderOfTheDivision) {
  std::mt19937 random(1);
  std::array<std::uint8_t, 80> bytes{};
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random() & 0xFFU);
  for (std::size_t begin = 0; begin < 8; ++begin)
    for (std::size_t size = 0; begin + size <= bytes.size(); ++size) {
      const auto piece = std::span(bytes).subspan(begin, size);
      ASSERT_EQ(crc16_ccitt_false(piece), crc16_by_bits(piece)) << size << " bytes from " << begin;
      ASSERT_EQ(crc32_ieee(piece), ~crc32_register_by_bits(0xFFFFFFFFU, piece)) << size << " bytes from " << begin;
      ASSERT_EQ(crc32_after(0, piece), crc32_register_by_bits(0, piece)) << size << " bytes from " << begin;
    }
}

// A polynomial with more than one term divides no single-bit error: every flipped bit must show.
TEST(Crc, EveryFlippedBitChangesBothChecksums) {
  std::array<std::uint8_t, 64> bytes{};
  const std::uint16_t crc16 = crc16_ccitt_false(bytes);
  const std::uint32_t crc32 = crc32_ieee(bytes);
  for (std::size_t bit = 0; bit < bytes.size() * 8; ++bit) {
    const auto mask = static_cast<std::uint8_t>(1U << (bit % 8));
    bytes[bit / 8] ^= mask;
    EXPECT_NE(crc16_ccitt_false(bytes), crc16) << "bit " << bit;
    EXPECT_NE(crc32_ieee(bytes), crc32) << "bit " << bit;
    bytes[bit / 8] ^= mask;
  }
}

}  // namespace

}  // namespace vbar::fsw::packets
