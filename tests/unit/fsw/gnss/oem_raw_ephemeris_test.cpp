// The GPS navigation message's own bits: real records packed by IS-GPS-200's tables, sets that are none, weeks that
// roll over.

#include <cmath>

#include <gtest/gtest.h>

#include "fsw/gnss/gps_week.h"
#include "fsw/gnss/oem_ephemeris.h"
#include "tests/unit/fsw/gnss/broadcast_records.h"
#include "tests/unit/fsw/gnss/oem_bytes_writer.h"

namespace vbar::fsw::gnss {
namespace {

using test::Body;
using test::Bytes;
using test::overwrite;

OemMessage raw_log_of(std::uint16_t id, const Bytes& body) {
  return test::raw_log_of(id, body, start_of_week(1643));
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
  raw.three.set(10, 1, 8, 99);  // a new issue has begun to come in
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
