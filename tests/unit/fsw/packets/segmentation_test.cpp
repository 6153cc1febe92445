// Long messages over packets: whatever a line does to the segments, a message comes out whole or not at all.

#include "fsw/packets/segmentation.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace vbar::fsw::packets {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kCapacity = 4000;
constexpr Stream kStream{Apid::kIdealNavigation, 1, 2};

Bytes message(std::size_t size, std::uint8_t seed = 1) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(seed + i * 7 + i / 251);
  return bytes;
}

PacketHeader header_at(std::int64_t time_ns, std::uint16_t sequence_count = 0) {
  PacketHeader header;
  header.apid = kStream.apid;
  header.spacecraft = kStream.spacecraft;
  header.unit = kStream.unit;
  header.time = GpsTime{time_ns};
  header.sequence_count = sequence_count;
  return header;
}

std::vector<Bytes> cut(const PacketHeader& header, const Bytes& payload, std::size_t segment_bytes = kMaxPayloadBytes) {
  std::vector<Bytes> packets;
  Segmenter segmenter(header, payload, segment_bytes);
  while (!segmenter.done()) {
    Bytes packet(kMaxPacketBytes);
    const Result<std::size_t> size = segmenter.next(packet);
    EXPECT_TRUE(size.ok());
    packet.resize(size.value());
    packets.push_back(packet);
  }
  return packets;
}

template <class Receiver>
Result<PacketView> push(Receiver& receiver, const Bytes& packet) {
  const Result<PacketView> view = parse_packet(packet);
  EXPECT_TRUE(view.ok());
  return receiver.push(view.value());
}

void expect_message(const Result<PacketView>& result, const Bytes& expected) {
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result.value().header.flags, SequenceFlags::kUnsegmented);
  EXPECT_EQ(Bytes(result.value().payload.begin(), result.value().payload.end()), expected);
}

TEST(Segmenter, FlagsAndCountsAreThoseOfTheStandard) {
  const std::vector<Bytes> packets = cut(header_at(5, 0x3FFE), message(25), 10);
  ASSERT_EQ(packets.size(), 3U);
  const std::vector<SequenceFlags> flags{SequenceFlags::kFirst, SequenceFlags::kContinuation, SequenceFlags::kLast};
  const std::vector<std::uint16_t> counts{0x3FFE, 0x3FFF, 0};  // 14 bits, then from zero again
  const std::vector<std::size_t> sizes{10, 10, 5};
  for (std::size_t i = 0; i < 3; ++i) {
    const Result<PacketView> view = parse_packet(packets[i]);
    ASSERT_TRUE(view.ok());
    EXPECT_EQ(view.value().header.flags, flags[i]);
    EXPECT_EQ(view.value().header.sequence_count, counts[i]);
    EXPECT_EQ(view.value().header.time, GpsTime{5});
    EXPECT_EQ(view.value().payload.size(), sizes[i]);
  }
}

TEST(Segmenter, WhatFitsOnePacketIsNotCut) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, kMaxPayloadBytes}) {
    const std::vector<Bytes> packets = cut(header_at(0), message(size));
    ASSERT_EQ(packets.size(), 1U) << size;
    EXPECT_EQ(parse_packet(packets[0]).value().header.flags, SequenceFlags::kUnsegmented);
  }
  EXPECT_EQ(cut(header_at(0), message(kMaxPayloadBytes + 1)).size(), 2U);
}

TEST(Segmenter, AShortOutputLosesNothing) {
  const Bytes payload = message(30);
  Segmenter segmenter(header_at(0), payload, 20);
  Bytes small(20);
  EXPECT_EQ(segmenter.next(small).status(), Status::kTooLong);
  EXPECT_EQ(segmenter.header().sequence_count, 0);
  Bytes large(kMaxPacketBytes);
  EXPECT_TRUE(segmenter.next(large).ok());
  EXPECT_TRUE(segmenter.next(large).ok());
  EXPECT_TRUE(segmenter.done());
  EXPECT_EQ(segmenter.next(large).status(), Status::kNotReady);
}

TEST(Reassembler, CompletesMessagesOfEverySize) {
  Reassembler<kCapacity> receiver(kStream);
  std::uint16_t count = 0x3FF0;  // wraps on the way
  for (std::size_t size = 0; size <= kCapacity; size += 97) {
    const Bytes payload = message(size);
    const std::vector<Bytes> packets = cut(header_at(static_cast<std::int64_t>(size), count), payload, 1000);
    for (std::size_t i = 0; i + 1 < packets.size(); ++i) {
      EXPECT_EQ(push(receiver, packets[i]).status(), Status::kNotReady);
    }
    expect_message(push(receiver, packets.back()), payload);
    count = static_cast<std::uint16_t>((count + packets.size()) & 0x3FFFU);
  }
  EXPECT_EQ(receiver.counters().messages, kCapacity / 97 + 1);
}

TEST(Reassembler, DuplicatesAreCountedAndDoNoHarm) {
  Reassembler<kCapacity> receiver(kStream);
  const Bytes payload = message(3500);
  const std::vector<Bytes> packets = cut(header_at(0), payload, 1000);
  for (std::size_t i = 0; i + 1 < packets.size(); ++i) {
    EXPECT_EQ(push(receiver, packets[i]).status(), Status::kNotReady);
    EXPECT_EQ(push(receiver, packets[i]).status(), Status::kBadSequence);
  }
  expect_message(push(receiver, packets.back()), payload);
  // Repeated when it is already complete: not delivered a second time.
  for (const Bytes& packet : packets) EXPECT_EQ(push(receiver, packet).status(), Status::kBadSequence);
  EXPECT_EQ(receiver.counters().duplicates, packets.size() - 1 + packets.size());
  EXPECT_EQ(receiver.counters().messages, 1U);
}

TEST(Reassembler, ASegmentTooEarlyIsRefusedUntilTheMissingOneComes) {
  Reassembler<kCapacity> receiver(kStream);
  const Bytes payload = message(2500);
  const std::vector<Bytes> packets = cut(header_at(0), payload, 1000);
  EXPECT_EQ(push(receiver, packets[0]).status(), Status::kNotReady);
  EXPECT_EQ(push(receiver, packets[2]).status(), Status::kBadSequence);
  EXPECT_EQ(push(receiver, packets[1]).status(), Status::kNotReady);
  expect_message(push(receiver, packets[2]), payload);
  EXPECT_EQ(receiver.counters().misplaced, 1U);
}

TEST(Reassembler, ALostSegmentLosesItsMessageOnly) {
  Reassembler<kCapacity> receiver(kStream);
  const std::vector<Bytes> lost = cut(header_at(0, 0), message(2500, 1), 1000);
  EXPECT_EQ(push(receiver, lost[0]).status(), Status::kNotReady);
  EXPECT_EQ(push(receiver, lost[2]).status(), Status::kBadSequence);
  const Bytes payload = message(1500, 2);
  const std::vector<Bytes> next = cut(header_at(1, 3), payload, 1000);
  EXPECT_EQ(push(receiver, next[0]).status(), Status::kNotReady);
  expect_message(push(receiver, next[1]), payload);
  EXPECT_EQ(receiver.counters().abandoned, 1U);
}

TEST(Reassembler, SegmentsWithoutABeginningAreMisplaced) {
  Reassembler<kCapacity> receiver(kStream);
  const std::vector<Bytes> packets = cut(header_at(0), message(2500), 1000);
  EXPECT_EQ(push(receiver, packets[1]).status(), Status::kBadSequence);
  EXPECT_EQ(push(receiver, packets[2]).status(), Status::kBadSequence);
  EXPECT_EQ(receiver.counters().misplaced, 2U);
}

TEST(Reassembler, ASegmentOfAnotherTimeNeverMixesIn) {
  Reassembler<kCapacity> receiver(kStream);
  const std::vector<Bytes> first = cut(header_at(0, 0), message(2500, 1), 1000);
  const std::vector<Bytes> second = cut(header_at(1, 0), message(2500, 2), 1000);
  EXPECT_EQ(push(receiver, first[0]).status(), Status::kNotReady);
  EXPECT_EQ(push(receiver, second[1]).status(), Status::kBadSequence);
  EXPECT_EQ(receiver.counters().misplaced, 1U);
}

TEST(Reassembler, AMessageLongerThanTheMemoryIsDroppedWhole) {
  Reassembler<kCapacity> receiver(kStream);
  const std::vector<Bytes> packets = cut(header_at(0), message(kCapacity + 1), 1000);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(push(receiver, packets[i]).status(), Status::kNotReady);
  EXPECT_EQ(push(receiver, packets[4]).status(), Status::kTooLong);
  EXPECT_EQ(receiver.counters().oversized, 1U);
  const Bytes payload = message(kCapacity);
  const std::vector<Bytes> next = cut(header_at(1, 5), payload, 1000);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(push(receiver, next[i]).status(), Status::kNotReady);
  expect_message(push(receiver, next[3]), payload);
}

TEST(Reassembler, PacketsOfOtherStreamsAreTheWrongType) {
  Reassembler<kCapacity> receiver(kStream);
  PacketHeader header = header_at(0);
  header.unit = 3;
  EXPECT_EQ(push(receiver, cut(header, message(3))[0]).status(), Status::kWrongType);
  header = header_at(0);
  header.spacecraft = 0;
  EXPECT_EQ(push(receiver, cut(header, message(3))[0]).status(), Status::kWrongType);
  header = header_at(0);
  header.apid = Apid::kTick;
  EXPECT_EQ(push(receiver, cut(header, message(3))[0]).status(), Status::kWrongType);
}

TEST(Reassembler, ASenderThatStartsAgainAtZeroIsHeard) {
  Reassembler<kCapacity> receiver(kStream);
  expect_message(push(receiver, cut(header_at(10, 500), message(10))[0]), message(10));
  EXPECT_EQ(push(receiver, cut(header_at(10, 499), message(10))[0]).status(), Status::kBadSequence);
  expect_message(push(receiver, cut(header_at(11, 0), message(20))[0]), message(20));
}

// A line that loses, repeats and swaps: whatever comes out is one of the messages that went in, in order, at most once.
TEST(Reassembler, NothingFalseEverComesOutOfABadLine) {
  std::mt19937 random(7);
  Reassembler<kCapacity> receiver(kStream);
  std::vector<Bytes> line;
  std::vector<Bytes> sent;
  std::uint16_t count = 0;
  for (int i = 0; i < 2000; ++i) {
    sent.push_back(message(random() % kCapacity, static_cast<std::uint8_t>(i)));
    for (const Bytes& packet : cut(header_at(i, count), sent.back(), 700)) {
      count = static_cast<std::uint16_t>((count + 1U) & 0x3FFFU);
      const auto fate = random() % 20;
      if (fate == 0) continue;
      line.push_back(packet);
      if (fate == 1) line.push_back(packet);
      if (fate == 2 && line.size() > 1) std::swap(line[line.size() - 1], line[line.size() - 2]);
    }
  }
  std::int64_t last_time = -1;
  std::size_t received = 0;
  for (const Bytes& packet : line) {
    const Result<PacketView> result = push(receiver, packet);
    if (!result.ok()) continue;
    const std::int64_t time = result.value().header.time.ns;
    EXPECT_GT(time, last_time);
    last_time = time;
    expect_message(result, sent[static_cast<std::size_t>(time)]);
    ++received;
  }
  // Messages have 3.4 segments on average; 0.9^3.4 = 70 % meet no loss and no swap.
  EXPECT_GT(received, sent.size() / 2);
  EXPECT_EQ(receiver.counters().messages, received);
}

}  // namespace
}  // namespace vbar::fsw::packets
