// The link frame's bytes against the layout of frame.h, written out by hand, and what a hostile wire may do to them.

#include "fsw/link/frame.h"

#include <algorithm>
#include <numeric>
#include <random>
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

// Consistent Overhead Byte Stuffing: the code table of Cheshire & Baker (1999), and its promises on random and hostile
// bytes.

namespace {

Bytes encoded(const Bytes& data) {
  Bytes out(kMaxCobsFrameBytes);
  const Result<std::size_t> size = cobs_encode(data, out);
  EXPECT_TRUE(size.ok());
  out.resize(size.value());
  return out;
}

/// The frames that a decoder sees in `stream`.
std::vector<Bytes> frames_in(CobsDecoder& decoder, const Bytes& stream) {
  std::vector<Bytes> frames;
  for (const std::uint8_t byte : stream) {
    if (decoder.push(byte)) frames.emplace_back(decoder.frame().begin(), decoder.frame().end());
  }
  return frames;
}

std::vector<Bytes> frames_in(const Bytes& stream) {
  CobsDecoder decoder;
  return frames_in(decoder, stream);
}

Bytes counting(std::uint8_t first, std::size_t size) {
  Bytes bytes(size);
  std::iota(bytes.begin(), bytes.end(), first);
  return bytes;
}

Bytes joined(std::initializer_list<Bytes> parts) {
  Bytes all;
  for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

struct Example {
  Bytes data;
  Bytes code;
};

// By the definition in the paper: each code byte c stands for c - 1 literal bytes and a zero, 0xFF for 254 bytes and no
// zero; a zero is appended to the data first and the one it stands for at the end is not sent.
std::vector<Example> examples() {
  return {
      {{}, {1, 0}},
      {{0}, {1, 1, 0}},
      {{0, 0}, {1, 1, 1, 0}},
      {{0x11, 0x22, 0, 0x33}, {3, 0x11, 0x22, 2, 0x33, 0}},
      {{0x11, 0x22, 0x33, 0x44}, {5, 0x11, 0x22, 0x33, 0x44, 0}},
      {{0x11, 0, 0, 0}, {2, 0x11, 1, 1, 1, 0}},
      {{0x45, 0, 0, 0x2C, 0x4C, 0x79, 0, 0, 0x40, 6, 0x4F, 0x37},
       {2, 0x45, 1, 4, 0x2C, 0x4C, 0x79, 1, 5, 0x40, 6, 0x4F, 0x37, 0}},  // the example of the paper's figure
      {counting(1, 253), joined({{0xFE}, counting(1, 253), {0}})},
      {counting(1, 254), joined({{0xFF}, counting(1, 254), {0}})},
      {joined({{0}, counting(1, 254)}), joined({{1, 0xFF}, counting(1, 254), {0}})},
      {counting(1, 255), joined({{0xFF}, counting(1, 254), {2, 0xFF, 0}})},
      {joined({counting(1, 254), {0}}), joined({{0xFF}, counting(1, 254), {1, 1, 0}})},
      {joined({counting(2, 254), {0, 1}}), joined({{0xFF}, counting(2, 254), {1, 2, 1, 0}})},
  };
}

TEST(Cobs, EncodesTheKnownExamples) {
  for (const Example& example : examples()) EXPECT_EQ(encoded(example.data), example.code);
}

TEST(Cobs, DecodesTheKnownExamples) {
  for (const Example& example : examples()) EXPECT_EQ(frames_in(example.code), std::vector<Bytes>{example.data});
}

// Some encoders end a full last group with an empty one (code 1): the same data.
TEST(Cobs, DecodesTheOtherEndingOfAFullGroup) {
  const Bytes data = counting(1, 254);
  EXPECT_EQ(frames_in(joined({{0xFF}, data, {1, 0}})), std::vector<Bytes>{data});
}

TEST(Cobs, RoundTripsAndStaysWithinItsOverhead) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 3000; ++trial) {
    Bytes data(random() % (kMaxFrameBytes + 1));
    const std::uint32_t zeros = random() % 4;  // none, rare, frequent, only
    for (std::uint8_t& byte : data) {
      const bool zero = zeros == 3 || (zeros == 2 && random() % 4 == 0) || (zeros == 1 && random() % 300 == 0);
      byte = zero ? std::uint8_t{0} : static_cast<std::uint8_t>(1 + random() % 255);
    }
    const Bytes code = encoded(data);
    EXPECT_EQ(std::count(code.begin(), code.end(), 0), 1);
    EXPECT_EQ(code.back(), 0);
    EXPECT_LE(code.size(), data.size() + data.size() / 254 + 2);
    EXPECT_EQ(frames_in(code), std::vector<Bytes>{data});
  }
}

TEST(Cobs, EncodeNeedsRoomForAll) {
  for (const Example& example : examples()) {
    Bytes out(example.code.size());
    EXPECT_TRUE(cobs_encode(example.data, out).ok());
    for (std::size_t size = 0; size < example.code.size(); ++size) {
      Bytes small(size);
      EXPECT_EQ(cobs_encode(example.data, small).status(), Status::kTooLong) << size;
    }
  }
}

TEST(CobsDecoder, ZerosBetweenFramesAreNothing) {
  CobsDecoder decoder;
  EXPECT_EQ(frames_in(decoder, {0, 0, 0, 2, 5, 0, 0, 2, 6, 0}), (std::vector<Bytes>{{5}, {6}}));
  EXPECT_EQ(decoder.rejected(), 0U);
}

TEST(CobsDecoder, FrameIsShownUntilTheNextPushOnly) {
  CobsDecoder decoder;
  EXPECT_EQ(frames_in(decoder, {2, 5, 0}).size(), 1U);
  EXPECT_EQ(decoder.frame().size(), 1U);
  EXPECT_FALSE(decoder.push(0));
  EXPECT_TRUE(decoder.frame().empty());
}

TEST(CobsDecoder, ACodeThatRunsPastItsZeroIsRejectedAndTheNextFrameIsRead) {
  CobsDecoder decoder;
  EXPECT_EQ(frames_in(decoder, {5, 1, 2, 0, 3, 7, 8, 0}), (std::vector<Bytes>{{7, 8}}));
  EXPECT_EQ(decoder.rejected(), 1U);
}

TEST(CobsDecoder, LargestFramePassesAndALongerOneIsRejected) {
  CobsDecoder decoder;
  const Bytes largest(kMaxFrameBytes, 0x55);
  EXPECT_EQ(frames_in(decoder, encoded(largest)), std::vector<Bytes>{largest});
  Bytes code(2 * kMaxFrameBytes);
  const Result<std::size_t> size = cobs_encode(Bytes(kMaxFrameBytes + 1, 0x55), code);
  code.resize(size.value());
  EXPECT_TRUE(frames_in(decoder, code).empty());
  EXPECT_EQ(decoder.rejected(), 1U);
  // Implied zeros count as well.
  EXPECT_TRUE(frames_in(decoder, joined({Bytes(kMaxFrameBytes + 2, 1), {0}})).empty());
  EXPECT_EQ(decoder.rejected(), 2U);
  EXPECT_EQ(frames_in(decoder, encoded(largest)), std::vector<Bytes>{largest});
}

TEST(CobsDecoder, EndlessNoiseWithoutAZeroIsOneRejection) {
  CobsDecoder decoder;
  EXPECT_TRUE(frames_in(decoder, Bytes(100'000, 0xFF)).empty());
  EXPECT_EQ(decoder.rejected(), 0U);
  EXPECT_EQ(frames_in(decoder, {0, 2, 9, 0}), (std::vector<Bytes>{{9}}));
  EXPECT_EQ(decoder.rejected(), 1U);
}

// A byte lost anywhere spoils its own frame at most (and the one after it, if it was the zero between them).
TEST(CobsDecoder, ALostByteNeverCostsMoreThanTwoFrames) {
  const Bytes stream = joined({encoded({1, 0, 2}), encoded({3, 4, 0}), encoded({5, 6, 7})});
  for (std::size_t lost = 0; lost < stream.size(); ++lost) {
    Bytes damaged = stream;
    damaged.erase(damaged.begin() + static_cast<std::ptrdiff_t>(lost));
    const std::vector<Bytes> frames = frames_in(joined({damaged, encoded({8}), encoded({9})}));
    ASSERT_GE(frames.size(), 3U) << lost;
    EXPECT_EQ(frames.back(), Bytes{9}) << lost;
  }
}

}  // namespace

}  // namespace vbar::fsw::link
