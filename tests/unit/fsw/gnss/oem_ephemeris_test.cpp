// Ephemerides out of a receiver's messages: NovAtel's own decoded GPSEPHEM, real ones packed again field by field,
// weeks that roll over, and what is refused. Against RTKLIB's convbin: tests/peers/rtklib.

#include "fsw/gnss/oem_ephemeris.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "fsw/gnss/gps_week.h"
#include "tests/unit/fsw/gnss/broadcast_records.h"
#include "tests/unit/fsw/gnss/oem_messages.h"

namespace vbar::fsw::gnss {

namespace {

using test::Body;
using test::Bytes;
using test::overwrite;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

OemMessage log_of(std::uint16_t id, const Bytes& body, GpsTime time = start_of_week(1643)) {
  return test::log_of(id, body, time);
}

// ---------------------------------------------------------------------------------------------------------- GPSEPHEM

/// PRN 3 of week 2098 as NovAtel's own decoder printed it (novatel/novatel_edie, test data, MIT License).
Bytes novatel_gps_body() {
  Body body;
  body.u32(3).f64(427'560.0).u32(0).u32(68).u32(68).u32(2098).u32(2098).f64(432'000.0).f64(2.6559425980e+07);
  body.f64(4.844487507e-09).f64(5.4111299713e-01).f64(2.6812178548e-03).f64(6.9765460014e-01);
  body.f64(-7.003545761e-07).f64(4.092231393e-06).f64(3.008750000e+02).f64(-1.359375000e+01);
  body.f64(1.490116119e-08).f64(3.352761269e-08).f64(9.6490477291e-01).f64(-2.146517983e-10);
  body.f64(-1.0423004440e+00).f64(-8.37642034e-09).u32(68).f64(432'000.0).f64(1.862645149e-09);
  body.f64(-1.28527e-04).f64(-1.02318e-11).f64(0.0).u32(1).f64(1.458664175e-04).f64(4.0);
  return body.bytes;
}

TEST(GpsEphemeris, ReadsTheManufacturersExample) {
  const Bytes body = novatel_gps_body();
  ASSERT_EQ(body.size(), 224U);
  const Result<Ephemeris> result = read_gps_ephemeris(log_of(kOemGpsEphemeris, body));
  ASSERT_EQ(result.status(), Status::kOk);
  const Ephemeris& e = result.value();
  EXPECT_EQ(e.satellite, (SatelliteId{Constellation::kGps, 3}));
  EXPECT_EQ(e.issue, 68);
  EXPECT_TRUE(e.healthy);
  EXPECT_EQ(e.toe.ns, (2098LL * 604'800 + 432'000) * 1'000'000'000);
  EXPECT_EQ(e.toc.ns, e.toe.ns);
  EXPECT_EQ(e.toe_of_week_s, 432'000.0);
  EXPECT_DOUBLE_EQ(e.sqrt_a * e.sqrt_a, 2.6559425980e+07);
  EXPECT_EQ(e.crs, -1.359375000e+01);
  EXPECT_EQ(e.omega_dot, -8.37642034e-09);
  EXPECT_EQ(e.group_delay_s, 1.862645149e-09);
  EXPECT_EQ(e.af1, -1.02318e-11);
  // The log's own corrected mean motion follows from A and delta n: 1.458664175e-4 rad/s, ten digits.
  const double a = e.sqrt_a * e.sqrt_a;
  EXPECT_NEAR(std::sqrt(kGmGps / (a * a * a)) + e.delta_n, 1.458664175e-04, 5e-14);
}

TEST(GpsEphemeris, RefusesWhatCannotBe) {
  const auto status_with = [](std::size_t offset, const Bytes& field) {
    Bytes body = novatel_gps_body();
    overwrite(body, offset, field);
    return read_gps_ephemeris(log_of(kOemGpsEphemeris, body)).status();
  };
  EXPECT_EQ(status_with(0, Body().u32(0).bytes), Status::kOutOfRange);
  EXPECT_EQ(status_with(0, Body().u32(259).bytes), Status::kOutOfRange);  // 3, if cut to eight bits
  EXPECT_EQ(status_with(16, Body().u32(69).bytes), Status::kBadSequence);
  EXPECT_EQ(status_with(24, Body().u32(0).bytes), Status::kOutOfRange);
  EXPECT_EQ(status_with(24, Body().u32(0xFFFFFFFF).bytes), Status::kOutOfRange);
  EXPECT_EQ(status_with(32, Body().f64(604'800.0).bytes), Status::kOutOfRange);
  EXPECT_EQ(status_with(32, Body().f64(kNaN).bytes), Status::kOutOfRange);
  EXPECT_EQ(status_with(40, Body().f64(-2.6e7).bytes), Status::kOutOfRange);
  EXPECT_EQ(status_with(40, Body().f64(kNaN).bytes), Status::kOutOfRange);
  EXPECT_EQ(status_with(64, Body().f64(0.9).bytes), Status::kOutOfRange);
  for (const std::size_t offset : {48, 56, 64, 72, 80, 88, 96, 104, 112, 120, 128, 136, 144, 152, 172, 180, 188, 196}) {
    EXPECT_EQ(status_with(offset, Body().f64(kNaN).bytes), Status::kNotFinite) << offset;
  }
  EXPECT_EQ(status_with(164, Body().f64(kNaN).bytes), Status::kOutOfRange);
  Bytes body = novatel_gps_body();
  body.pop_back();
  EXPECT_EQ(read_gps_ephemeris(log_of(kOemGpsEphemeris, body)).status(), Status::kTooShort);
  EXPECT_EQ(read_gps_ephemeris(log_of(8, body)).status(), Status::kWrongType);
}

TEST(GpsEphemeris, AnUnhealthySatelliteSaysSo) {
  Bytes body = novatel_gps_body();
  overwrite(body, 12, Body().u32(0x3F).bytes);
  const Result<Ephemeris> result = read_gps_ephemeris(log_of(kOemGpsEphemeris, body));
  ASSERT_TRUE(result.ok());
  EXPECT_FALSE(result.value().healthy);
}

TEST(GpsEphemeris, ClockAndOrbitMayStandOnBothSidesOfTheWeeksEnd) {
  Bytes body = novatel_gps_body();
  overwrite(body, 32, Body().f64(0.0).bytes);
  overwrite(body, 24, Body().u32(2099).bytes);
  overwrite(body, 164, Body().f64(604'784.0).bytes);
  const Result<Ephemeris> result = read_gps_ephemeris(log_of(kOemGpsEphemeris, body));
  ASSERT_TRUE(result.ok());
  EXPECT_EQ((result.value().toe - result.value().toc).ns, 16LL * 1'000'000'000);
}

// -------------------------------------------------------------------------------------------------- Galileo, BeiDou

Ephemeris record_of(Constellation constellation) {
  for (const Ephemeris& record : test::broadcast_records()) {
    if (record.satellite.constellation == constellation) return record;
  }
  return {};
}

void put_harmonics(Body& body, const Ephemeris& e) {
  body.f64(e.cuc).f64(e.cus).f64(e.crc).f64(e.crs).f64(e.cic).f64(e.cis);
}

Bytes galileo_body(const Ephemeris& e) {
  Body body;
  body.u32(e.satellite.prn).u32(1).u32(1).zeros(8).u32(static_cast<std::uint32_t>(e.issue));
  body.u32(static_cast<std::uint32_t>(e.toe_of_week_s)).f64(e.sqrt_a).f64(e.delta_n).f64(e.m0).f64(e.e).f64(e.omega);
  put_harmonics(body, e);
  body.f64(e.i0).f64(e.i_dot).f64(e.omega0).f64(e.omega_dot);
  const auto toc_s = static_cast<std::uint32_t>(time_of_week(e.toc).ns / kNanosecondsPerSecond);
  body.u32(toc_s).f64(kNaN).f64(kNaN).f64(kNaN);  // F/NAV clock: not for E1
  body.u32(toc_s).f64(e.af0).f64(e.af1).f64(e.af2).f64(kNaN).f64(e.group_delay_s);
  return body.bytes;
}

TEST(GalileoEphemeris, TakesTheWeekNearestToTheMessagesTime) {
  const Ephemeris record = record_of(Constellation::kGalileo);
  const Bytes body = galileo_body(record);
  ASSERT_EQ(body.size(), 220U);
  for (const std::int64_t hours : {-80, -2, 0, 2, 80}) {
    const GpsTime time = record.toe + duration_of_seconds(3600 * hours);
    const Result<Ephemeris> result = read_galileo_ephemeris(log_of(kOemGalileoEphemeris, body, time));
    ASSERT_EQ(result.status(), Status::kOk);
    EXPECT_EQ(result.value().toe, record.toe);
    EXPECT_EQ(result.value().toc, record.toc);
    EXPECT_EQ(result.value().af0, record.af0);
    EXPECT_EQ(result.value().group_delay_s, record.group_delay_s);
  }
}

TEST(GalileoEphemeris, RefusesWhatCannotBeUsed) {
  const Ephemeris record = record_of(Constellation::kGalileo);
  const auto read_with = [&record](std::size_t offset, const Bytes& field) {
    Bytes body = galileo_body(record);
    overwrite(body, offset, field);
    return read_galileo_ephemeris(log_of(kOemGalileoEphemeris, body, record.toe));
  };
  EXPECT_EQ(read_with(8, Body().u32(0).bytes).status(), Status::kNotReady);  // no I/NAV
  EXPECT_EQ(read_with(0, Body().u32(37).bytes).status(), Status::kOutOfRange);
  EXPECT_EQ(read_with(20, Body().u32(1024).bytes).status(), Status::kOutOfRange);
  EXPECT_EQ(read_with(24, Body().u32(604'800).bytes).status(), Status::kOutOfRange);
  EXPECT_EQ(read_with(176, Body().u32(604'800).bytes).status(), Status::kOutOfRange);
  EXPECT_EQ(read_with(28, Body().f64(kNaN).bytes).status(), Status::kNotFinite);
  EXPECT_EQ(read_with(212, Body().f64(kNaN).bytes).status(), Status::kNotFinite);
  EXPECT_FALSE(read_with(12, Body().u8(1).bytes).value().healthy);  // E1 out of service
  EXPECT_FALSE(read_with(15, Body().u8(1).bytes).value().healthy);  // E1 without guarantee
  EXPECT_TRUE(read_with(13, Body().u8(1).bytes).value().healthy);   // E5a is another matter
  const Bytes body = galileo_body(record);
  OemMessage without_time = log_of(kOemGalileoEphemeris, body, record.toe);
  without_time.time_status = 20;
  EXPECT_EQ(read_galileo_ephemeris(without_time).status(), Status::kNotReady);
}

Bytes beidou_body(const Ephemeris& e) {
  const GpsTime toe_bdt = e.toe - duration_of_seconds(14) - Duration{1356 * kNanosecondsPerWeek};
  const GpsTime toc_bdt = e.toc - duration_of_seconds(14) - Duration{1356 * kNanosecondsPerWeek};
  Body body;
  body.u32(e.satellite.prn).u32(static_cast<std::uint32_t>(toe_bdt.ns / kNanosecondsPerWeek)).f64(2.0).u32(0);
  body.f64(e.group_delay_s).f64(kNaN).u32(1);
  body.u32(static_cast<std::uint32_t>(time_of_week(toc_bdt).ns / kNanosecondsPerSecond));
  body.f64(e.af0).f64(e.af1).f64(e.af2).u32(static_cast<std::uint32_t>(e.issue));
  body.u32(static_cast<std::uint32_t>(time_of_week(toe_bdt).ns / kNanosecondsPerSecond));
  body.f64(e.sqrt_a).f64(e.e).f64(e.omega).f64(e.delta_n).f64(e.m0).f64(e.omega0).f64(e.omega_dot).f64(e.i0);
  body.f64(e.i_dot);
  put_harmonics(body, e);
  return body.bytes;
}

TEST(BeidouEphemeris, TurnsBeidouTimeIntoGpsTime) {
  const Ephemeris record = record_of(Constellation::kBeidou);
  Bytes body = beidou_body(record);
  ASSERT_EQ(body.size(), 196U);
  const Result<Ephemeris> result = read_beidou_ephemeris(log_of(kOemBeidouEphemeris, body));
  ASSERT_EQ(result.status(), Status::kOk);
  EXPECT_EQ(result.value().toe, record.toe);
  EXPECT_EQ(result.value().toc, record.toc);
  // BeiDou's week begins 14 s after that of GPS: its second 0 of week 394 is second 14 of GPS week 1750.
  overwrite(body, 4, Body().u32(394).bytes);
  overwrite(body, 72, Body().u32(0).bytes);
  overwrite(body, 40, Body().u32(604'792).bytes);
  const Result<Ephemeris> over = read_beidou_ephemeris(log_of(kOemBeidouEphemeris, body));
  ASSERT_EQ(over.status(), Status::kOk);
  EXPECT_EQ(over.value().toe.ns, (1750LL * 604'800 + 14) * 1'000'000'000);
  EXPECT_EQ(over.value().toc.ns, (1750LL * 604'800 + 6) * 1'000'000'000);
}

TEST(BeidouEphemeris, RefusesWhatCannotBe) {
  const Ephemeris record = record_of(Constellation::kBeidou);
  const auto status_with = [&record](std::size_t offset, const Bytes& field) {
    Bytes body = beidou_body(record);
    overwrite(body, offset, field);
    return read_beidou_ephemeris(log_of(kOemBeidouEphemeris, body)).status();
  };
  EXPECT_EQ(status_with(0, Body().u32(64).bytes), Status::kOutOfRange);
  EXPECT_EQ(status_with(4, Body().u32(0xFFFFFFFF).bytes), Status::kOutOfRange);
  EXPECT_EQ(status_with(40, Body().u32(604'800).bytes), Status::kOutOfRange);
  EXPECT_EQ(status_with(68, Body().u32(32).bytes), Status::kOutOfRange);
  EXPECT_EQ(status_with(72, Body().u32(604'800).bytes), Status::kOutOfRange);
  EXPECT_EQ(status_with(20, Body().f64(kNaN).bytes), Status::kNotFinite);
  EXPECT_EQ(status_with(76, Body().f64(kNaN).bytes), Status::kNotFinite);
  EXPECT_EQ(status_with(188, Body().f64(kNaN).bytes), Status::kNotFinite);
}

}  // namespace

// The GPS navigation message's own bits: real records packed by IS-GPS-200's tables, sets that are none, weeks that
// roll over.

namespace {

OemMessage raw_log_of(std::uint16_t id, const Bytes& body) {
  return test::log_of(id, body, start_of_week(1643));
}

/// One subframe of 240 bits, fields set by word and bit as the interface document numbers them.
class Subframe {
 public:
  explicit Subframe(unsigned number) {
    set(1, 1, 8, 0x8B);
    set(2, 20, 3, number);
  }
  void set(std::size_t word, std::size_t bit, unsigned count, std::int64_t value) {
    for (unsigned k = 0; k < count; ++k) {
      const std::size_t place = (word - 1) * 24 + bit - 1 + k;
      const auto mask = static_cast<std::uint8_t>(0x80U >> (place % 8));
      const bool one = ((value >> (count - 1 - k)) & 1) != 0;
      bytes[place / 8] = static_cast<std::uint8_t>(one ? bytes[place / 8] | mask : bytes[place / 8] & ~mask);
    }
  }
  Bytes bytes = Bytes(30, 0);
};

struct RawEphemeris {
  Subframe one{1}, two{2}, three{3};
  std::uint32_t week = 2098;
  std::uint32_t toe_s = 432'000;

  [[nodiscard]] Bytes body() const {
    Body body;
    body.u32(3).u32(week).u32(toe_s);
    for (const Subframe* subframe : {&one, &two, &three}) test::append(body.bytes, subframe->bytes);
    return body.bytes;
  }
};

/// A record as its satellite sends it: every number in the units of IS-GPS-200N, tables 20-I and 20-III.
RawEphemeris packed(const Ephemeris& e) {
  const auto counts = [](double value, int power) { return std::llround(std::ldexp(value, -power)); };
  const auto turns = [counts](double angle, int power) { return counts(angle / 3.1415926535898, power); };
  RawEphemeris raw;
  raw.week = static_cast<std::uint32_t>(e.toe.ns / kNanosecondsPerWeek);
  raw.toe_s = static_cast<std::uint32_t>(e.toe_of_week_s);
  raw.one.set(3, 1, 10, raw.week % 1024);
  raw.one.set(3, 17, 6, e.healthy ? 0 : 63);
  raw.one.set(7, 17, 8, counts(e.group_delay_s, -31));
  raw.one.set(8, 1, 8, e.issue);
  raw.one.set(8, 9, 16, time_of_week(e.toc).ns / 16'000'000'000);
  raw.one.set(9, 1, 8, counts(e.af2, -55));
  raw.one.set(9, 9, 16, counts(e.af1, -43));
  raw.one.set(10, 1, 22, counts(e.af0, -31));
  raw.two.set(3, 1, 8, e.issue);
  raw.two.set(3, 9, 16, counts(e.crs, -5));
  raw.two.set(4, 1, 16, turns(e.delta_n, -43));
  raw.two.set(4, 17, 32, turns(e.m0, -31));
  raw.two.set(6, 1, 16, counts(e.cuc, -29));
  raw.two.set(6, 17, 32, counts(e.e, -33));
  raw.two.set(8, 1, 16, counts(e.cus, -29));
  raw.two.set(8, 17, 32, counts(e.sqrt_a, -19));
  raw.two.set(10, 1, 16, counts(e.toe_of_week_s, 4));
  raw.three.set(3, 1, 16, counts(e.cic, -29));
  raw.three.set(3, 17, 32, turns(e.omega0, -31));
  raw.three.set(5, 1, 16, counts(e.cis, -29));
  raw.three.set(5, 17, 32, turns(e.i0, -31));
  raw.three.set(7, 1, 16, counts(e.crc, -5));
  raw.three.set(7, 17, 32, turns(e.omega, -31));
  raw.three.set(9, 1, 24, turns(e.omega_dot, -43));
  raw.three.set(10, 1, 8, e.issue);
  raw.three.set(10, 9, 14, turns(e.i_dot, -43));
  return raw;
}

TEST(RawEphemeris, GivesRealRecordsBack) {
  int count = 0;
  for (const Ephemeris& record : test::broadcast_records()) {
    if (record.satellite.constellation != Constellation::kGps) continue;
    Bytes body = packed(record).body();
    overwrite(body, 0, Body().u32(record.satellite.prn).bytes);
    const Result<Ephemeris> result = read_raw_ephemeris(raw_log_of(kOemRawEphemeris, body));
    ASSERT_EQ(result.status(), Status::kOk);
    const Ephemeris& e = result.value();
    EXPECT_EQ(e.satellite, record.satellite);
    EXPECT_EQ(e.issue, record.issue);
    EXPECT_EQ(e.toe, record.toe);
    EXPECT_EQ(e.toc, record.toc);
    // The file has twelve digits and more.
    for (double Ephemeris::*field : test::kEphemerisNumbers) {
      EXPECT_NEAR(e.*field, record.*field, 6e-12 * std::abs(record.*field));
    }
    ++count;
  }
  EXPECT_EQ(count, 5);
}

RawEphemeris example() {
  return packed(test::broadcast_records().front());
}

Status status_of(const RawEphemeris& raw) {
  return read_raw_ephemeris(raw_log_of(kOemRawEphemeris, raw.body())).status();
}

TEST(RawEphemeris, RefusesSubframesThatAreNotOneSet) {
  ASSERT_EQ(status_of(example()), Status::kOk);
  RawEphemeris raw = example();
  raw.three.set(10, 1, 8, 99);  // the first part of a new issue
  EXPECT_EQ(status_of(raw), Status::kBadSequence);
  raw = example();
  raw.one.set(8, 1, 8, 99);
  EXPECT_EQ(status_of(raw), Status::kBadSequence);
  raw = example();
  std::swap(raw.two, raw.three);
  EXPECT_EQ(status_of(raw), Status::kBadSequence);
  raw = example();
  raw.one.set(1, 1, 8, 0x74);  // the preamble upside down
  EXPECT_EQ(status_of(raw), Status::kBadSequence);
  raw = example();
  raw.toe_s += 16;
  EXPECT_EQ(status_of(raw), Status::kBadSequence);
  raw = example();
  raw.week += 2;
  EXPECT_EQ(status_of(raw), Status::kBadSequence);
}

TEST(RawEphemeris, TheWeekOfTransmissionMayBeTheOneBefore) {
  // Modulo 1024, over its rollover: transmitted in week 2047, for the first hours of week 2048.
  RawEphemeris raw = example();
  raw.week = 2048;
  raw.one.set(3, 1, 10, 1023);
  const Result<Ephemeris> result = read_raw_ephemeris(raw_log_of(kOemRawEphemeris, raw.body()));
  ASSERT_TRUE(result.ok());
  EXPECT_EQ(result.value().toe, start_of_week(2048) + duration_of_seconds(raw.toe_s));
}

TEST(RawEphemeris, RefusesAbsurdElements) {
  RawEphemeris raw = example();
  raw.two.set(8, 17, 32, 0);  // sqrt(A)
  EXPECT_EQ(status_of(raw), Status::kOutOfRange);
  raw = example();
  raw.two.set(6, 17, 32, 0xFFFFFFFF);  // e = 0.5
  EXPECT_EQ(status_of(raw), Status::kOutOfRange);
  raw = example();
  raw.one.set(8, 9, 16, 0xFFFF);  // toc after the week
  EXPECT_EQ(status_of(raw), Status::kOutOfRange);
  raw = example();
  Bytes body = raw.body();
  body.pop_back();
  EXPECT_EQ(read_raw_ephemeris(raw_log_of(kOemRawEphemeris, body)).status(), Status::kTooShort);
  body = raw.body();
  overwrite(body, 0, Body().u32(193).bytes);  // QZSS
  EXPECT_EQ(read_raw_ephemeris(raw_log_of(kOemRawEphemeris, body)).status(), Status::kOutOfRange);
  // All ones, all zeros.
  EXPECT_NE(read_raw_ephemeris(raw_log_of(kOemRawEphemeris, Bytes(102, 0xFF))).status(), Status::kOk);
  EXPECT_NE(read_raw_ephemeris(raw_log_of(kOemRawEphemeris, Bytes(102, 0))).status(), Status::kOk);
}

}  // namespace

}  // namespace vbar::fsw::gnss
