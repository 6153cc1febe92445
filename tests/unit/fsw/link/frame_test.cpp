// The link frame's bytes against the layout of frame.h, written out by hand, and what a hostile wire may do to them.

#include "fsw/link/frame.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/packets/crc.h"

namespace vbar::fsw::link {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes written(const FrameHeader& header, const Bytes& payload) {
  Bytes out(kMaxFrameBytes);
  const Result<std::size_t> size = write_frame(header, payload, out);
  EXPECT_TRUE(size.ok());
  out.resize(size.value());
  return out;
}

/// Puts the right CRC behind whatever the test did to the bytes before it.
void sign(Bytes& frame) {
  const std::uint32_t crc = packets::crc32_ieee(std::span(frame).first(frame.size() - 4));
  for (std::size_t i = 0; i < 4; ++i) frame[frame.size() - 4 + i] = static_cast<std::uint8_t>(crc >> (8 * i));
}

FrameHeader example_header() {
  FrameHeader header;
  header.type = FrameType::kData;
  header.session = 0xA1B2C3D4;
  header.step = 0x01020304;
  header.index = 0x0506;
  header.last = true;
  header.acknowledge_now = true;
  return header;
}

TEST(Frame, FieldsStandWhereTheHeaderSaysTheyDo) {
  const Bytes frame = written(example_header(), {0x77, 0x88});
  const Bytes expected{0x01, 0x03, 0xA1, 0xB2, 0xC3, 0xD4, 0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x03, 0x00, 0x77, 0x88};
  ASSERT_EQ(frame.size(), expected.size() + kFrameCrcBytes);
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), frame.begin()));
}

// A CRC that is sent low byte first leaves a constant remainder over frame and CRC: 0x2144DF1C for CRC-32 (IEEE
// 802.3, 3.2.9).
TEST(Frame, ChecksumIsInTheOrderOfTheStandard) {
  EXPECT_EQ(packets::crc32_ieee(written(example_header(), {1, 2, 3})), 0x2144DF1CU);
}

TEST(Frame, ParsesWhatWasWritten) {
  for (const FrameType type :
       {FrameType::kHello, FrameType::kHelloAck, FrameType::kData, FrameType::kAck, FrameType::kPoll,
        FrameType::kGoodbye, FrameType::kReceiverPoll, FrameType::kReceiverCount, FrameType::kSnapshotPoll,
        FrameType::kSnapshotPiece, FrameType::kSnapshotHeld}) {
    for (int flags = 0; flags < 4; ++flags) {
      FrameHeader header = example_header();
      header.type = type;
      header.last = (flags & 1) != 0;
      header.acknowledge_now = (flags & 2) != 0;
      const Bytes frame = written(header, {9, 0, 255});
      const Result<FrameView> view = parse_frame(frame);
      ASSERT_TRUE(view.ok());
      EXPECT_EQ(view.value().header.type, type);
      EXPECT_EQ(view.value().header.session, header.session);
      EXPECT_EQ(view.value().header.step, header.step);
      EXPECT_EQ(view.value().header.index, header.index);
      EXPECT_EQ(view.value().header.last, header.last);
      EXPECT_EQ(view.value().header.acknowledge_now, header.acknowledge_now);
      EXPECT_EQ(Bytes(view.value().payload.begin(), view.value().payload.end()), (Bytes{9, 0, 255}));
    }
  }
}

TEST(Frame, LargestFrameFitsAndOneMoreByteDoesNot) {
  constexpr std::size_t kLargestPayload = kMaxFrameBytes - kFrameHeaderBytes - kFrameCrcBytes;
  EXPECT_TRUE(parse_frame(written(example_header(), Bytes(kLargestPayload))).ok());
  Bytes out(kMaxFrameBytes + 1);
  EXPECT_EQ(write_frame(example_header(), Bytes(kLargestPayload + 1), out).status(), Status::kTooLong);
  EXPECT_EQ(parse_frame(Bytes(kMaxFrameBytes + 1)).status(), Status::kTooLong);
}

TEST(Frame, ShortOutputIsRefused) {
  Bytes out(kFrameHeaderBytes + kFrameCrcBytes + 2);
  EXPECT_TRUE(write_frame(example_header(), Bytes(2), out).ok());
  EXPECT_EQ(write_frame(example_header(), Bytes(3), out).status(), Status::kTooLong);
}

TEST(Frame, TruncationsAreRefused) {
  const Bytes frame = written(example_header(), {1, 2, 3});
  for (std::size_t size = 0; size < frame.size(); ++size) {
    const Status expected = size < kFrameHeaderBytes + kFrameCrcBytes ? Status::kTooShort : Status::kBadChecksum;
    EXPECT_EQ(parse_frame(std::span(frame).first(size)).status(), expected) << size;
  }
}

// CRC-32 detects every single-bit error.
TEST(Frame, EveryFlippedBitIsABadChecksum) {
  Bytes frame = written(example_header(), {1, 2, 3, 4});
  for (std::size_t bit = 0; bit < frame.size() * 8; ++bit) {
    const auto mask = static_cast<std::uint8_t>(1U << (bit % 8));
    frame[bit / 8] ^= mask;
    EXPECT_EQ(parse_frame(frame).status(), Status::kBadChecksum) << "bit " << bit;
    frame[bit / 8] ^= mask;
  }
}

TEST(Frame, AnotherVersionTypeOrFlagIsTheWrongType) {
  const struct {
    std::size_t at;
    std::uint8_t value;
  } cases[] = {{0, 0}, {0, 2}, {1, 0}, {1, 12}, {1, 255}, {12, 4}, {12, 0x80}, {13, 1}};
  for (const auto& c : cases) {
    Bytes frame = written(example_header(), {});
    frame[c.at] = c.value;
    sign(frame);
    EXPECT_EQ(parse_frame(frame).status(), Status::kWrongType) << c.at << ' ' << int{c.value};
  }
}

}  // namespace
}  // namespace vbar::fsw::link
