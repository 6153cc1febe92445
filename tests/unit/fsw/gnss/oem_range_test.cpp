// Observations out of RANGE and RANGECMP: NovAtel's own pairs of both logs, and what is refused.

#include "fsw/gnss/oem_range.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>

#include <gtest/gtest.h>

#include "fsw/gnss/gps_week.h"
#include "fsw/gnss/oem_fields.h"
#include "tests/support/accuracy.h"
#include "tests/unit/fsw/gnss/oem_messages.h"

namespace vbar::fsw::gnss {

namespace {

using test::Body;
using test::Bytes;
using test::Signal44;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr float kNaNf = std::numeric_limits<float>::quiet_NaN();

struct Read {
  Status status = Status::kOk;
  ObservationEpoch epoch;
  ObservationTally tally;
};

OemMessage of_body(std::uint16_t id, const Bytes& body, unsigned week = 1643, double time_of_week_s = 100'000.0) {
  return test::log_of(id, body, start_of_week(week) + Duration{std::llround(time_of_week_s * 1000.0) * 1'000'000});
}

Read read(const OemMessage& message) {
  Read result;
  result.epoch.count = 7;  // whatever was there before
  result.status = message.id == kOemRange ? read_range(message, result.epoch, result.tally)
                                          : read_range_compressed(message, result.epoch, result.tally);
  return result;
}

Read read(const std::vector<Signal44>& signals) {
  const Bytes body = test::range_body(signals);
  return read(of_body(kOemRange, body));
}

// ------------------------------------------------------------------------------------------ against NovAtel's vectors

/// RANGECMPA's records are the bytes of the binary log in hexadecimal.
Bytes compressed_body(const test::AsciiLog& log) {
  Body body;
  body.u32(static_cast<std::uint32_t>(log.body.size() - 1));
  for (std::size_t k = 1; k < log.body.size(); ++k) {
    for (std::size_t i = 0; i < 48; i += 2)
      body.u8(static_cast<unsigned>(std::stoul(log.body[k].substr(i, 2), nullptr, 16)));
  }
  return body.bytes;
}

struct Expected {
  double pseudorange_m, sigma_m, adr, adr_sigma, doppler, cn0, lock;
  std::uint32_t status;
};

/// RANGEA's records of the signals used on board, by (system, prn, code).
std::map<std::tuple<int, int, int>, Expected> expected_of(const test::AsciiLog& log) {
  std::map<std::tuple<int, int, int>, Expected> expected;
  for (std::size_t k = 1; k + 9 < log.body.size(); k += 10) {
    const auto number = [&log, k](std::size_t i) { return std::stod(log.body[k + i]); };
    const auto status = static_cast<std::uint32_t>(std::stoul(log.body[k + 9], nullptr, 16));
    const auto used = used_signal(tracking_status(status));
    const int prn = std::stoi(log.body[k]);
    if (!used || prn < 1 || prn > highest_prn(used->constellation)) continue;
    const auto key =
        std::tuple(static_cast<int>(used->constellation), prn, static_cast<int>(tracking_status(status).signal));
    expected[key] = {number(2), number(3), number(4), number(5), number(6), number(7), number(8), status};
  }
  return expected;
}

struct Differences {
  accuracy::Largest pseudorange, phase, others;
  std::size_t signals = 0;
};

/// RANGECMPA of test vector `name` through the decoder, against the RANGEA that NovAtel's own decoder makes of it.
void compare_pair(const std::string& name, Differences& largest) {
  const test::AsciiLog packed = test::ascii_log(name, "RANGECMPA");
  const Bytes body = compressed_body(packed);
  const Read result = read(of_body(kOemRangeCompressed, body, packed.week, packed.time_of_week_s));
  ASSERT_EQ(result.status, Status::kOk);
  EXPECT_EQ(result.epoch.receiver_time.ns,
            (packed.week * 604'800LL) * 1'000'000'000 + std::llround(packed.time_of_week_s * 1000.0) * 1'000'000);
  const auto expected = expected_of(test::ascii_log(name, "RANGEA"));
  for (std::size_t k = 0; k < result.epoch.count; ++k) {
    const Observation& o = result.epoch.observations[k];
    const auto found = expected.find({static_cast<int>(o.satellite.constellation), o.satellite.prn, o.code});
    ASSERT_NE(found, expected.end());
    const Expected& e = found->second;
    largest.pseudorange.add(std::abs(o.pseudorange_m - e.pseudorange_m));
    largest.phase.add(std::abs(o.carrier_phase_cycles + e.adr));
    for (const double difference : {o.doppler_hz - e.doppler, o.cn0_dbhz - e.cn0, o.lock_time_s - e.lock,
                                    o.pseudorange_sigma_m - e.sigma_m, o.phase_sigma_cycles - e.adr_sigma}) {
      largest.others.add(std::abs(difference));
    }
    EXPECT_EQ(o.phase_usable, (e.status & 0xC00U) == 0xC00U);
  }
  largest.signals += result.epoch.count;
  // Everything used on board is there, but for the second and third code of a satellite's L2.
  EXPECT_EQ(result.epoch.count + result.tally.duplicate, expected.size());
}

TEST(OemRangeCompressed, IsWhatTheManufacturerUnpacks) {
  Differences largest;
  for (const char* name : {"DECOMPRESS_RANGECMPA_1", "DECOMPRESS_RANGECMPA_2", "DECOMPRESS_RANGECMPA_3"}) {
    compare_pair(name, largest);
  }
  EXPECT_GT(largest.signals, 100U);
  // The vectors' decimals: three, six, three; half a unit of the last, and doubles of 1e8.
  accuracy::expect_below("pseudoranges out of RANGECMP", "NovAtel's own decoder, three test vectors",
                         largest.pseudorange, 0.5e-3 + 1e-8, "m");
  accuracy::expect_below("carrier phases out of RANGECMP", "NovAtel's own decoder, three test vectors", largest.phase,
                         0.5e-6 + 2e-8, "cycles");
  EXPECT_LT(largest.others, 0.5e-3 + 1e-8);
}

// ------------------------------------------------------------------------------------------------------------- RANGE

TEST(OemRange, ReadsEveryField) {
  const Read result = read(std::vector<Signal44>(1));
  ASSERT_EQ(result.status, Status::kOk);
  ASSERT_EQ(result.epoch.count, 1U);
  const Observation& o = result.epoch.observations[0];
  const Signal44 sent;
  EXPECT_EQ(o.satellite, (SatelliteId{Constellation::kGps, 7}));
  EXPECT_EQ(o.signal, Signal::kGpsL1);
  EXPECT_TRUE(o.phase_usable);
  EXPECT_EQ(o.pseudorange_m, sent.pseudorange_m);
  EXPECT_EQ(o.carrier_phase_cycles, -sent.adr_cycles);
  EXPECT_EQ(o.doppler_hz, static_cast<double>(sent.doppler_hz));
  EXPECT_EQ(o.pseudorange_sigma_m, static_cast<double>(sent.pseudorange_sigma_m));
  EXPECT_EQ(o.phase_sigma_cycles, static_cast<double>(sent.adr_sigma_cycles));
  EXPECT_EQ(o.cn0_dbhz, static_cast<double>(sent.cn0_dbhz));
  EXPECT_EQ(o.lock_time_s, static_cast<double>(sent.lock_time_s));
}

TEST(OemRange, PhaseIsUsableWithPhaseLockAndKnownParityOnly) {
  for (const std::uint32_t missing : {0x400U, 0x800U, 0xC00U}) {
    const Read result = read({{.status = Signal44().status & ~missing}});
    ASSERT_EQ(result.epoch.count, 1U);
    EXPECT_FALSE(result.epoch.observations[0].phase_usable);
  }
  const Read without_code = read({{.status = Signal44().status & ~0x1000U}});
  EXPECT_EQ(without_code.epoch.count, 0U);
  EXPECT_EQ(without_code.tally.not_locked, 1U);
}

std::uint32_t status_word(unsigned system, unsigned signal) {
  return 0x1C04U | (system << 16U) | (signal << 21U);
}

TEST(OemRange, KeepsTheUsedSignalsInOrder) {
  const Read result = read({{.prn = 30, .status = status_word(4, 0)},   // BeiDou B1I
                            {.prn = 11, .status = status_word(3, 2)},   // Galileo E1C
                            {.prn = 9, .status = status_word(0, 9)},    // GPS L2 P(Y)
                            {.prn = 2, .status = status_word(4, 4)},    // BeiDou B1I, geostationary
                            {.prn = 9, .status = status_word(0, 0)},    // GPS L1
                            {.prn = 45, .status = status_word(1, 0)},   // GLONASS
                            {.prn = 120, .status = status_word(2, 0)},  // SBAS
                            {.prn = 9, .status = status_word(0, 14)},   // GPS L5
                            {.prn = 33, .status = status_word(0, 0)},   // no such satellite of GPS
                            {.prn = 0, .status = status_word(3, 2)}});  // nor of Galileo
  ASSERT_EQ(result.epoch.count, 5U);
  EXPECT_EQ(result.tally.not_used, 5U);
  const auto at = [&result](std::size_t k) { return result.epoch.observations[k]; };
  EXPECT_EQ(at(0).satellite, (SatelliteId{Constellation::kGps, 9}));
  EXPECT_EQ(at(0).signal, Signal::kGpsL1);
  EXPECT_EQ(at(1).signal, Signal::kGpsL2);
  EXPECT_EQ(at(2).satellite, (SatelliteId{Constellation::kGalileo, 11}));
  EXPECT_EQ(at(3).satellite, (SatelliteId{Constellation::kBeidou, 2}));
  EXPECT_EQ(at(4).satellite, (SatelliteId{Constellation::kBeidou, 30}));
}

TEST(OemRange, OfSeveralCodesOnL2TheOneOfAllSatellitesIsTaken) {
  const std::vector<Signal44> codes{{.pseudorange_m = 2.1e7, .status = status_word(0, 17)},
                                    {.pseudorange_m = 2.2e7, .status = status_word(0, 9)},
                                    {.pseudorange_m = 2.3e7, .status = status_word(0, 5)}};
  std::vector<std::size_t> order{0, 1, 2};
  do {  // whatever the channels' order
    const Read result = read({codes[order[0]], codes[order[1]], codes[order[2]]});
    ASSERT_EQ(result.epoch.count, 1U);
    EXPECT_EQ(result.epoch.observations[0].code, 9);
    EXPECT_EQ(result.epoch.observations[0].pseudorange_m, 2.2e7);
    EXPECT_EQ(result.tally.duplicate, 2U);
  } while (std::next_permutation(order.begin(), order.end()));
}

TEST(OemRange, OfDuplicatesTheFirstIsKept) {
  const Read result = read({{.pseudorange_m = 2.1e7}, {.pseudorange_m = 2.2e7}});
  ASSERT_EQ(result.epoch.count, 1U);
  EXPECT_EQ(result.epoch.observations[0].pseudorange_m, 2.1e7);
  EXPECT_EQ(result.tally.duplicate, 1U);
}

TEST(OemRange, RefusesWhatCannotBe) {
  const std::vector<Signal44> impossible{
      {.pseudorange_m = kNaN},  {.pseudorange_m = INFINITY},    {.pseudorange_m = -2.2e7},      {.pseudorange_m = 0.0},
      {.pseudorange_m = 9.9e6}, {.pseudorange_m = 6.1e7},       {.pseudorange_m = 1e300},       {.doppler_hz = kNaNf},
      {.doppler_hz = 1.1e5F},   {.pseudorange_sigma_m = kNaNf}, {.pseudorange_sigma_m = -1.0F}, {.cn0_dbhz = kNaNf},
      {.cn0_dbhz = -1.0F},      {.lock_time_s = kNaNf},         {.lock_time_s = -1.0F},
  };
  for (const Signal44& signal : impossible) {
    const Read result = read({{.prn = 3}, signal, {.prn = 12}});
    EXPECT_EQ(result.status, Status::kOk);
    EXPECT_EQ(result.epoch.count, 2U);  // the others are as good as before
    EXPECT_EQ(result.tally.implausible, 1U);
  }
}

TEST(OemRange, APhaseThatIsNoneLeavesThePseudorange) {
  for (const Signal44& signal : std::vector<Signal44>{
           {.adr_cycles = kNaN}, {.adr_cycles = -INFINITY}, {.adr_cycles = 1e10}, {.adr_sigma_cycles = kNaNf}}) {
    const Read result = read({signal});
    ASSERT_EQ(result.epoch.count, 1U);
    EXPECT_FALSE(result.epoch.observations[0].phase_usable);
    EXPECT_EQ(result.epoch.observations[0].carrier_phase_cycles, 0.0);
    EXPECT_EQ(result.epoch.observations[0].phase_sigma_cycles, 0.0);
    EXPECT_EQ(result.tally.phase_refused, 1U);
  }
}

TEST(OemRange, MoreThanThereIsRoomForIsCounted) {
  std::vector<Signal44> signals;
  for (unsigned prn = 32; prn > 0; --prn) {
    signals.push_back({.prn = prn, .status = status_word(0, 9)});
    signals.push_back({.prn = prn, .status = status_word(0, 0)});
  }
  for (unsigned prn = 1; prn <= 36; ++prn) signals.push_back({.prn = prn, .status = status_word(3, 2)});
  const Read result = read(signals);
  EXPECT_EQ(result.status, Status::kOk);
  EXPECT_EQ(result.epoch.count, kMaxObservations);
  EXPECT_EQ(result.tally.no_room, 64U + 36U - kMaxObservations);
  for (std::size_t k = 1; k < result.epoch.count; ++k) {
    const Observation& a = result.epoch.observations[k - 1];
    const Observation& b = result.epoch.observations[k];
    EXPECT_TRUE(a.satellite < b.satellite || (a.satellite == b.satellite && a.signal < b.signal));
  }
}

TEST(OemRange, ACountThatTheBodyDoesNotHoldIsRefused) {
  Bytes body = test::range_body(std::vector<Signal44>(2));
  const auto with_count = [&body](std::uint32_t count) {
    const Bytes field = Body().u32(count).bytes;
    std::copy(field.begin(), field.end(), body.begin());
    return read(of_body(kOemRange, body));
  };
  EXPECT_EQ(with_count(2).status, Status::kOk);
  EXPECT_EQ(with_count(1).epoch.count, 1U);
  // 97,612,894 records of 44 bytes are 2^32 + 40 bytes.
  for (const std::uint32_t count : {3U, 97'612'894U, 0x80000000U, 0xFFFFFFFFU}) {
    const Read result = with_count(count);
    EXPECT_EQ(result.status, Status::kTooShort);
    EXPECT_EQ(result.epoch.count, 0U);
  }
  body.resize(3);
  EXPECT_EQ(read(of_body(kOemRange, body)).status, Status::kTooShort);
  body.clear();
  EXPECT_EQ(read(of_body(kOemRange, body)).status, Status::kTooShort);
}

TEST(OemRange, NoSatelliteIsAnEpochToo) {
  const Read result = read(std::vector<Signal44>());
  EXPECT_EQ(result.status, Status::kOk);
  EXPECT_EQ(result.epoch.count, 0U);
}

// ---------------------------------------------------------------------------------------------------------- RANGECMP

/// One record of RANGECMP: 24 bytes as one number, lowest bit first.
Bytes compressed(std::uint32_t status, double pseudorange_m, double adr_cycles, unsigned prn) {
  std::vector<bool> bits;
  const auto put = [&bits](std::int64_t value, int count) {
    for (int k = 0; k < count; ++k) bits.push_back(((value >> k) & 1) != 0);
  };
  put(status, 32);
  put(-1000 * 256, 28);
  put(std::llround(pseudorange_m * 128.0), 36);
  put(std::llround(adr_cycles * 256.0), 32);
  put(2, 4);
  put(3, 4);
  put(prn, 8);
  put(64 * 32, 21);
  put(25, 5);
  put(0, 22);
  Body body;
  body.u32(1);
  for (std::size_t k = 0; k < bits.size(); k += 8) {
    unsigned byte = 0;
    for (std::size_t i = 0; i < 8; ++i) byte |= bits[k + i] ? 1U << i : 0U;
    body.u8(byte);
  }
  return body.bytes;
}

TEST(OemRangeCompressed, PhaseIsUnrolledForEveryNumberOfTurns) {
  // The receiver's phase is the pseudorange in cycles to within some cycles; 8,388,608 of them are one turn.
  for (double pseudorange_m = 1.9e7; pseudorange_m < 5.0e7; pseudorange_m += 123'456.789) {
    for (const unsigned signal : {0U, 9U}) {
      const double wavelength_m = 299'792'458.0 / (signal == 0 ? 1575.42e6 : 1227.60e6);
      const double phase = std::floor(pseudorange_m / wavelength_m * 256.0) / 256.0 + 1000.0;
      const double rolled = -std::remainder(phase, 8'388'608.0);
      const Bytes body = compressed(status_word(0, signal), pseudorange_m, rolled, 5);
      const Read result = read(of_body(kOemRangeCompressed, body));
      ASSERT_EQ(result.epoch.count, 1U);
      EXPECT_EQ(result.epoch.observations[0].carrier_phase_cycles, phase);
    }
  }
}

TEST(OemRangeCompressed, ReadsEveryField) {
  const Bytes body = compressed(status_word(0, 0), 22'000'000.5, -1234.5, 31);
  const Read result = read(of_body(kOemRangeCompressed, body));
  ASSERT_EQ(result.epoch.count, 1U);
  const Observation& o = result.epoch.observations[0];
  EXPECT_EQ(o.satellite.prn, 31);
  EXPECT_EQ(o.pseudorange_m, 22'000'000.5);
  EXPECT_EQ(o.doppler_hz, -1000.0);
  EXPECT_EQ(o.pseudorange_sigma_m, 0.113);
  EXPECT_EQ(o.phase_sigma_cycles, 4.0 / 512.0);
  EXPECT_EQ(o.lock_time_s, 64.0);
  EXPECT_EQ(o.cn0_dbhz, 45.0);
}

TEST(OemRangeCompressed, RefusesTheSameAsRange) {
  Bytes body = compressed(status_word(0, 0), 5.0e6, 0.0, 31);
  EXPECT_EQ(read(of_body(kOemRangeCompressed, body)).tally.implausible, 1U);
  body[0] = 2;
  EXPECT_EQ(read(of_body(kOemRangeCompressed, body)).status, Status::kTooShort);
  ObservationEpoch epoch;
  ObservationTally tally;
  EXPECT_EQ(read_range(of_body(kOemRangeCompressed, body), epoch, tally), Status::kWrongType);
  EXPECT_EQ(read_range_compressed(of_body(kOemRange, body), epoch, tally), Status::kWrongType);
}

}  // namespace

// The time tags of epochs: exact, over the ends of weeks, and only from a receiver with a valid time.

namespace {

TEST(OemTime, TimeTagsAreExact) {
  const Bytes body = test::range_body(std::vector<Signal44>(1));
  OemMessage message = test::log_of(kOemRange, body, start_of_week(1643));
  const auto epoch = std::make_unique<ObservationEpoch>();
  ObservationTally tally;
  for (const std::uint32_t ms : {0U, 1U, 333U, 604'799'999U}) {
    message.week = 2400;
    message.time_of_week_ms = ms;
    ASSERT_EQ(read_range(message, *epoch, tally), Status::kOk);
    EXPECT_EQ(epoch->receiver_time.ns, 2400LL * 604'800 * 1'000'000'000 + ms * 1'000'000LL);
  }
  // A millisecond after the last one of a week is the first of the next, also where ten bits of the week run over.
  for (const std::uint16_t week : {1643, 2047, 4095}) {
    message.week = week;
    message.time_of_week_ms = 604'799'999;
    const GpsTime before = time_of(message).value();
    message.week = static_cast<std::uint16_t>(week + 1);
    message.time_of_week_ms = 0;
    EXPECT_EQ((time_of(message).value() - before).ns, 1'000'000);
  }
}

TEST(OemTime, WithoutTimeThereIsNoEpoch) {
  const Bytes body = test::range_body(std::vector<Signal44>(1));
  OemMessage message = test::log_of(kOemRange, body, start_of_week(1643));
  const auto epoch = std::make_unique<ObservationEpoch>();
  ObservationTally tally;
  const auto expect = [&](Status status) {
    EXPECT_EQ(read_range(message, *epoch, tally), status);
    EXPECT_EQ(epoch->count, status == Status::kOk ? 1U : 0U);
  };
  for (const int known : {80, 100, 120, 130, 140, 160, 170, 180, 200}) {
    message.time_status = static_cast<std::uint8_t>(known);
    expect(Status::kOk);
  }
  for (const int unknown : {20, 60}) {
    message.time_status = static_cast<std::uint8_t>(unknown);
    expect(Status::kNotReady);
  }
  for (const int nonsense : {0, 21, 181, 255}) {
    message.time_status = static_cast<std::uint8_t>(nonsense);
    expect(Status::kOutOfRange);
  }
  message.time_status = 180;
  message.week = 0;
  expect(Status::kNotReady);
  message.week = 65'535;  // would not fit an instant in nanoseconds
  expect(Status::kOutOfRange);
  message.week = 1643;
  message.time_of_week_ms = 604'800'000;
  expect(Status::kOutOfRange);
}

}  // namespace

}  // namespace vbar::fsw::gnss
