// Whole messages out of a stream of bytes: against NovAtel's own vectors and against a search of the whole stream by
// brute force.

#include "fsw/gnss/oem_stream.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "fsw/gnss/oem_ephemeris.h"
#include "fsw/gnss/receiver_decoder.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/paths.h"
#include "tests/support/receiver_promises.h"
#include "tests/unit/fsw/gnss/oem_messages.h"

namespace vbar::fsw::gnss {

namespace {

using test::append;
using test::Body;
using test::Bytes;

struct Found {
  std::size_t end = 0;  ///< bytes taken when it was reported
  unsigned id = 0;
  Bytes body;
  bool operator==(const Found&) const = default;
};

std::vector<Found> decode(OemStream& stream, const Bytes& bytes) {
  std::vector<Found> found;
  for (std::size_t k = 0; k < bytes.size(); ++k) {
    if (!stream.push(bytes[k])) continue;
    const OemMessage message = stream.message();
    found.push_back({k + 1, message.id, {message.body.begin(), message.body.end()}});
  }
  return found;
}

std::vector<Found> decode(const Bytes& bytes) {
  const auto stream = std::make_unique<OemStream>();
  return decode(*stream, bytes);
}

/// The same by brute force over the whole stream: of all places at which a message of right CRC stands, the one that
/// ends first, then on from its end.
std::vector<Found> search(const Bytes& bytes) {
  std::vector<Found> found;
  const auto at = [&bytes](std::size_t k) { return static_cast<std::size_t>(bytes[k]); };
  for (std::size_t from = 0; from < bytes.size();) {
    std::size_t best_end = bytes.size() + 1;
    Found best;
    for (std::size_t k = from; k + 12 <= bytes.size(); ++k) {
      if (at(k) != 0xAA || at(k + 1) != 0x44 || (at(k + 2) != 0x12 && at(k + 2) != 0x13)) continue;
      const bool is_short = at(k + 2) == 0x13;
      const std::size_t header = is_short ? 12 : at(k + 3);
      if (header < 12 || (!is_short && header < 28)) continue;
      const std::size_t length = is_short ? at(k + 3) : at(k + 8) + 256 * at(k + 9);
      const std::size_t end = k + header + length + 4;
      if (end > bytes.size() || end >= best_end || end - k > kMaxOemMessageBytes) continue;
      if (test::crc_bit_by_bit(std::span(bytes).subspan(k, end - k)) != 0) continue;
      best_end = end;
      best = {end, static_cast<unsigned>(at(k + 4) + 256 * at(k + 5)), {}};
      best.body.assign(bytes.begin() + static_cast<std::ptrdiff_t>(k + header),
                       bytes.begin() + static_cast<std::ptrdiff_t>(end - 4));
    }
    if (best_end > bytes.size()) break;
    found.push_back(best);
    from = best_end;
  }
  return found;
}

Bytes random_bytes(std::size_t count, std::mt19937& random) {
  Bytes bytes(count);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random() >> 24U);
  return bytes;
}

Bytes bytes_of_hex(const std::string& text) {
  Bytes bytes;
  for (std::size_t k = 0; k + 1 < text.size(); k += 2) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(text.substr(k, 2), nullptr, 16)));
  }
  return bytes;
}

TEST(OemStream, ReadsTheManufacturersVectors) {
  std::ifstream file(vbar::tests::source_path("tests/data/receiver/novatel_binary_logs.hex"));
  std::string name;
  std::string hex;
  std::getline(file, name);  // the source
  int count = 0;
  while (std::getline(file, name) && std::getline(file, hex)) {
    const Bytes bytes = bytes_of_hex(hex);
    const unsigned id = static_cast<unsigned>(std::stoi(name.substr(name.find("id=") + 3)));
    const std::vector<Found> found = decode(bytes);
    ASSERT_EQ(found.size(), 1U) << name;
    EXPECT_EQ(found[0].id, id) << name;
    EXPECT_EQ(found[0].end, bytes.size()) << name;
    ++count;
  }
  EXPECT_EQ(count, 28);
}

TEST(OemStream, TellsTheHeader) {
  const auto stream = std::make_unique<OemStream>();
  const Bytes bytes = test::message(
      43, {1, 2, 3},
      {.type = 0x81, .time_status = 160, .week = 2200, .time_of_week_ms = 604'799'999, .header_bytes = 40});
  EXPECT_EQ(decode(*stream, bytes).size(), 1U);
  const OemMessage message = stream->message();
  EXPECT_EQ(message.id, 43);
  EXPECT_TRUE(message.is_response);
  EXPECT_EQ(message.format, 0);
  EXPECT_EQ(message.source, 1);
  EXPECT_EQ(message.time_status, 160);
  EXPECT_EQ(message.week, 2200);
  EXPECT_EQ(message.time_of_week_ms, 604'799'999U);
  // A header longer than today's: the body begins where the header says that it ends.
  EXPECT_EQ(Bytes(message.body.begin(), message.body.end()), Bytes({1, 2, 3}));
}

TEST(OemStream, ReadsShortHeaders) {
  const auto stream = std::make_unique<OemStream>();
  const std::vector<Found> found = decode(*stream, test::short_message(325, {9, 8, 7, 6}));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].id, 325U);
  EXPECT_EQ(found[0].body, Bytes({9, 8, 7, 6}));
  EXPECT_EQ(stream->message().week, 1643);
  EXPECT_EQ(stream->message().time_of_week_ms, 100'000'000U);
  EXPECT_EQ(stream->message().time_status, 0);
}

TEST(OemStream, FindsMessagesBetweenGarbage) {
  std::mt19937 random(1);
  const auto stream = std::make_unique<OemStream>();
  Bytes bytes;
  std::uint64_t garbage = 0;
  for (unsigned k = 0; k < 50; ++k) {
    Bytes between = random_bytes(random() % 300, random);
    append(between, Bytes({0xAA, 0xAA, 0x44}));  // the beginnings of sync patterns, before a real one too
    garbage += between.size();
    append(bytes, between);
    append(bytes, test::message(k, random_bytes(random() % 600, random)));
  }
  const std::vector<Found> found = decode(*stream, bytes);
  EXPECT_EQ(found, search(bytes));
  EXPECT_EQ(found.size(), 50U);
  EXPECT_EQ(stream->counters().messages, 50U);
  EXPECT_EQ(stream->skipped_bytes(), garbage);
  EXPECT_EQ(stream->counters().bytes, bytes.size());
}

TEST(OemStream, ACopyDecodesOn) {
  const Bytes bytes = test::message(43, Bytes(100, 5));
  const auto stream = std::make_unique<OemStream>();
  const auto half = static_cast<std::ptrdiff_t>(bytes.size() / 2);
  EXPECT_TRUE(decode(*stream, Bytes(bytes.begin(), bytes.begin() + half)).empty());
  const auto copy = std::make_unique<OemStream>(*stream);
  *stream = OemStream();
  EXPECT_EQ(decode(*copy, Bytes(bytes.begin() + half, bytes.end())).size(), 1U);
}

TEST(OemStream, TakesTheLongestMessageAndNoLonger) {
  const auto stream = std::make_unique<OemStream>();
  const std::size_t longest_body = kMaxOemMessageBytes - 28 - 4;
  const Bytes good = test::message(43, Bytes(longest_body, 1));
  EXPECT_EQ(decode(*stream, good).size(), 1U);
  EXPECT_EQ(decode(*stream, test::message(43, Bytes(longest_body + 1, 1))).size(), 0U);
  EXPECT_EQ(stream->counters().oversized, 1U);
  EXPECT_EQ(decode(*stream, good).size(), 1U);
}

// What a hostile or broken line may bring.

TEST(OemStreamHostile, EveryTruncationLosesOneMessageOnly) {
  const Bytes cut = test::range(std::vector<test::Signal44>(3));
  const Bytes next = test::message(101, Bytes(44, 7));
  for (std::size_t length = 0; length < cut.size(); ++length) {
    Bytes bytes(cut.begin(), cut.begin() + static_cast<std::ptrdiff_t>(length));
    append(bytes, next);
    const std::vector<Found> found = decode(bytes);
    ASSERT_EQ(found.size(), 1U) << length;
    EXPECT_EQ(found[0].id, 101U);
    EXPECT_EQ(found[0].end, bytes.size());  // without waiting for what the truncated one announced
  }
}

TEST(OemStreamHostile, EveryFlippedBitLosesOneMessageOnly) {
  const Bytes good = test::range(std::vector<test::Signal44>(2));
  const Bytes next = test::message(101, Bytes(44, 7));
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    Bytes bytes = good;
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    append(bytes, next);
    const std::vector<Found> found = decode(bytes);
    ASSERT_EQ(found.size(), 1U) << bit;
    EXPECT_EQ(found[0].id, 101U);
    EXPECT_EQ(found[0].end, bytes.size());
  }
}

TEST(OemStreamHostile, AFalseStartNeitherSwallowsNorDelays) {
  // A header that announces 8 kB, and real messages from every place behind it on.
  for (std::size_t gap = 0; gap < 40; ++gap) {
    Bytes bytes = Body().u8(0xAA).u8(0x44).u8(0x12).u8(28).u16(43).u16(0).u16(8000).zeros(gap).bytes;
    const std::size_t first = bytes.size();
    const Bytes real = test::message(241, Bytes(112, 3));
    append(bytes, real);
    append(bytes, real);
    const std::vector<Found> found = decode(bytes);
    ASSERT_EQ(found.size(), 2U) << gap;
    EXPECT_EQ(found[0].end, first + real.size());
    EXPECT_EQ(found[1].end, bytes.size());
  }
}

TEST(OemStreamHostile, InterleavedMessagesGiveNothingFalse) {
  const Bytes a = test::message(43, Bytes(90, 1));
  const Bytes b = test::message(43, Bytes(90, 2));
  Bytes bytes;
  for (std::size_t k = 0; k < a.size(); ++k) append(bytes, Bytes({a[k], b[k]}));
  EXPECT_TRUE(decode(bytes).empty());
  // One whole message inside another's bytes is read; the torn one is not.
  bytes.assign(a.begin(), a.begin() + 60);
  append(bytes, b);
  append(bytes, Bytes(a.begin() + 60, a.end()));
  const std::vector<Found> found = decode(bytes);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].body, Bytes(90, 2));
}

TEST(OemStreamHostile, OversizedHeadersAreLeftAtOnce) {
  const auto stream = std::make_unique<OemStream>();
  Bytes bytes;
  for (int k = 0; k < 100; ++k) append(bytes, Body().u8(0xAA).u8(0x44).u8(0x12).u8(28).u32(43).u16(0xFFFF).bytes);
  append(bytes, test::message(8, Bytes(108, 0)));
  EXPECT_EQ(decode(*stream, bytes).size(), 1U);
  EXPECT_EQ(stream->counters().oversized, 100U);
}

TEST(OemStreamHostile, HeadersTooShortToBeAreLeftAtOnce) {
  const auto stream = std::make_unique<OemStream>();
  Bytes bytes;
  for (unsigned length = 0; length < 28; ++length) {
    append(bytes, Body().u8(0xAA).u8(0x44).u8(0x12).u8(length).zeros(6).bytes);
  }
  append(bytes, test::message(8, Bytes(108, 0)));
  EXPECT_EQ(decode(*stream, bytes).size(), 1U);
  EXPECT_EQ(stream->counters().bad_header, 28U);
}

TEST(OemStreamHostile, NeverEndingInputFindsWhatBruteForceFinds) {
  // Sync patterns, headers and messages, whole and broken, denser than any line could have them.
  std::mt19937 random(3);
  Bytes bytes;
  while (bytes.size() < 60'000) {
    switch (random() % 6) {
      case 0:
        append(bytes, random_bytes(random() % 40, random));
        break;
      case 1:
        append(bytes, Bytes({0xAA, 0x44, static_cast<std::uint8_t>(0x12 + random() % 2)}));
        break;
      case 2:
        append(bytes, Body().u8(0xAA).u8(0x44).u8(0x12).u8(28).u32(43).u16(random() % 3000).bytes);
        break;
      case 3: {
        Bytes broken = test::message(140, random_bytes(random() % 200, random));
        broken[random() % broken.size()] ^= 0x10U;
        append(bytes, broken);
        break;
      }
      case 4:
        append(bytes, test::short_message(325, random_bytes(random() % 60, random)));
        break;
      default:
        append(bytes, test::message(43, random_bytes(random() % 400, random)));
        break;
    }
  }
  const std::vector<Found> found = decode(bytes);
  EXPECT_GT(found.size(), 80U);
  EXPECT_EQ(found, search(bytes));
}

TEST(OemStreamHostile, HeadersWithoutEndCostTheOldestCandidatesOnly) {
  // More open candidates than are followed, all announcing 8 kB, over several times the buffer, and then a message.
  const auto stream = std::make_unique<OemStream>();
  Bytes bytes;
  while (bytes.size() < 100'000) {
    append(bytes, Body().u8(0xAA).u8(0x44).u8(0x12).u8(28).u32(43).u16(8000).bytes);
  }
  append(bytes, test::message(43, Bytes(500, 1)));
  EXPECT_EQ(decode(*stream, bytes).size(), 1U);
  EXPECT_GT(stream->counters().given_up, 9000U);
  EXPECT_EQ(stream->counters().disproved, OemStream::kMaxOpenCandidates - 1);
}

TEST(OemStreamHostile, AMinuteOfNoiseGivesNothing) {
  // 5.5 MB, a minute of a line at 921,600 baud; a false message has a chance of 1e-9 here.
  std::mt19937 random(4);
  const auto stream = std::make_unique<OemStream>();
  const Bytes noise = random_bytes(5'500'000, random);
  EXPECT_TRUE(decode(*stream, noise).empty());
  EXPECT_LE(stream->counters().bytes - stream->skipped_bytes(), kMaxOemMessageBytes);
  Bytes zeros(100'000, 0);
  append(zeros, Bytes(100'000, 0xAA));
  EXPECT_TRUE(decode(*stream, zeros).empty());
  EXPECT_EQ(decode(*stream, test::message(43, Bytes(500, 1))).size(), 1U);
}

}  // namespace

// A whole line: a real receiver's log, and messages of every kind through one decoder.

namespace {

/// An OEMV's log of 18 December 2009: its messages RANGECMP, RAWEPHEM and BESTPOS.
Bytes real_log() {
  std::ifstream file(vbar::tests::source_path("tests/data/receiver/oemv_200911218.gps"), std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

TEST(ReceiverDecoder, ReadsARealLog) {
  const auto decoder = std::make_unique<ReceiverDecoder>();
  std::map<ReceiverUpdate, int> updates;
  std::set<std::uint8_t> ephemerides;
  std::vector<GpsTime> epochs;
  std::vector<Vector3> positions;
  for (const std::uint8_t byte : real_log()) {
    const ReceiverUpdate update = decoder->push(byte);
    ++updates[update];
    if (update == ReceiverUpdate::kObservations) epochs.push_back(decoder->observations().receiver_time);
    if (update == ReceiverUpdate::kEphemeris) ephemerides.insert(decoder->ephemeris().satellite.prn);
    if (update == ReceiverUpdate::kPosition) positions.push_back(decoder->position().position_ecef);
  }
  EXPECT_EQ(updates[ReceiverUpdate::kObservations], 46);
  EXPECT_EQ(updates[ReceiverUpdate::kEphemeris], 25);
  EXPECT_EQ(ephemerides.size(), 9U);
  EXPECT_EQ(decoder->counters().refused, 0U);
  EXPECT_EQ(decoder->counters().unknown, 0U);
  EXPECT_EQ(decoder->stream().counters().bad_checksum, 0U);
  EXPECT_EQ(decoder->stream().skipped_bytes(), 0U);
  for (std::size_t k = 1; k < epochs.size(); ++k) EXPECT_EQ(epochs[k] - epochs[k - 1], duration_of_seconds(1));
  // Where RTKLIB's convbin has it (APPROX POSITION XYZ of its RINEX file, a single-point solution: metres).
  ASSERT_FALSE(positions.empty());
  for (const Vector3& p : positions) EXPECT_LT((p - Vector3(-3869295.978, 3436570.1134, 3717374.1253)).norm(), 10.0);
}

TEST(ReceiverDecoder, PhaseGrowsWithTheRangeAndAgainstTheDoppler) {
  // The conventions of Observation, told by the log itself: over a second, the phase grows as the pseudorange does, and
  // as the mean Doppler shift falls.
  const auto decoder = std::make_unique<ReceiverDecoder>();
  std::map<std::pair<SatelliteId, Signal>, Observation> before;
  int compared = 0;
  for (const std::uint8_t byte : real_log()) {
    if (decoder->push(byte) != ReceiverUpdate::kObservations) continue;
    const ObservationEpoch& epoch = decoder->observations();
    for (std::size_t k = 0; k < epoch.count; ++k) {
      const Observation& now = epoch.observations[k];
      const auto last = before.find({now.satellite, now.signal});
      if (last != before.end() && now.phase_usable && last->second.phase_usable) {
        const Observation& then = last->second;
        const double grown = now.carrier_phase_cycles - then.carrier_phase_cycles;
        // The Doppler's own noise and the receiver's clock between the two readings: some hundredths of a cycle and
        // more at the lowest satellites.
        EXPECT_NEAR(grown, -(now.doppler_hz + then.doppler_hz) / 2.0, 1.0);
        // Code noise of metres.
        EXPECT_NEAR(grown * wavelength(now.signal), now.pseudorange_m - then.pseudorange_m, 8.0);
        ++compared;
      }
      before[{now.satellite, now.signal}] = now;
    }
  }
  EXPECT_GT(compared, 700);
}

TEST(ReceiverDecoder, CountsWhatItDoesNotRead) {
  const auto decoder = std::make_unique<ReceiverDecoder>();
  const std::vector<test::Signal44> signals(1);
  const auto feed = [&decoder](const Bytes& bytes) {
    ReceiverUpdate update = ReceiverUpdate::kNone;
    for (const std::uint8_t byte : bytes) update = decoder->push(byte);
    return update;
  };
  EXPECT_EQ(feed(test::range(signals)), ReceiverUpdate::kObservations);
  EXPECT_EQ(feed(test::message(83, Bytes(100, 0))), ReceiverUpdate::kNone);      // TRACKSTAT
  EXPECT_EQ(feed(test::range(signals, {.type = 0x80})), ReceiverUpdate::kNone);  // an answer
  EXPECT_EQ(feed(test::range(signals, {.type = 0x20})), ReceiverUpdate::kNone);  // ASCII
  EXPECT_EQ(feed(test::range(signals, {.type = 0x01})), ReceiverUpdate::kNone);  // the second antenna
  EXPECT_EQ(decoder->counters().unknown, 4U);
  EXPECT_EQ(feed(test::range(signals, {.time_status = 20})), ReceiverUpdate::kNone);
  EXPECT_EQ(decoder->counters().not_ready, 1U);
  EXPECT_EQ(feed(test::message(43, {})), ReceiverUpdate::kNone);
  EXPECT_EQ(feed(test::short_message(43, test::range_body(signals))), ReceiverUpdate::kNone);  // tells no time status
  EXPECT_EQ(decoder->counters().refused, 2U);
  EXPECT_EQ(decoder->stream().counters().messages, 8U);
}

TEST(ReceiverDecoder, BodiesOfEveryLengthAreRefusedOrRead) {
  // Every kind with every length up to its own, of zeros, ones and a pattern: what is reported keeps its promises.
  const auto decoder = std::make_unique<ReceiverDecoder>();
  for (const unsigned id : {7U, 8U, 41U, 42U, 43U, 101U, 140U, 241U, 1122U, 1696U}) {
    for (std::size_t length = 0; length <= 240; ++length) {
      for (const std::uint8_t fill : {0x00, 0xFF, 0x7F, 0x5A}) {
        for (const std::uint8_t byte : test::message(id, Bytes(length, fill))) {
          ASSERT_TRUE(vbar::test::keeps_promises(*decoder, decoder->push(byte))) << id << ' ' << length;
        }
      }
    }
  }
}

TEST(ReceiverDecoder, AllocatesNothing) {
  const Bytes log = real_log();
  const auto decoder = std::make_unique<ReceiverDecoder>();
  const std::size_t before = vbar::test::allocation_count();
  std::uint32_t updates = 0;
  for (const std::uint8_t byte : log) updates += decoder->push(byte) == ReceiverUpdate::kNone ? 0 : 1;
  const Result<SatelliteState> state = satellite_state(decoder->ephemeris(), decoder->observations().receiver_time);
  EXPECT_EQ(vbar::test::allocation_count(), before);
  EXPECT_GT(updates, 100U);
  EXPECT_TRUE(state.ok());
}

}  // namespace

}  // namespace vbar::fsw::gnss
