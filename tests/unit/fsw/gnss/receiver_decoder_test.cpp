// A whole line: a real receiver's log, and messages of every kind through one decoder.

#include "fsw/gnss/receiver_decoder.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <set>

#include <gtest/gtest.h>

#include "fsw/gnss/oem_ephemeris.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/paths.h"
#include "tests/support/receiver_promises.h"
#include "tests/unit/fsw/gnss/oem_bytes_writer.h"

namespace vbar::fsw::gnss {
namespace {

using test::Bytes;

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
