#pragma once
// Messages as a NovAtel receiver sends them, packed by the manual for the decoder's tests, with a CRC of its own: bit
// by bit, where the decoder works by table.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fsw/gnss/gps_week.h"
#include "fsw/gnss/oem_stream.h"
#include "tests/support/paths.h"

namespace vbar::fsw::gnss::test {

using Bytes = std::vector<std::uint8_t>;

/// A body, field after field.
class Body {
 public:
  Body& u8(unsigned value) { return put(value, 1); }
  Body& u16(unsigned value) { return put(value, 2); }
  Body& u32(std::uint32_t value) { return put(value, 4); }
  Body& f32(float value) { return put(std::bit_cast<std::uint32_t>(value), 4); }
  Body& f64(double value) { return put(std::bit_cast<std::uint64_t>(value), 8); }
  Body& zeros(std::size_t count) {
    bytes.insert(bytes.end(), count, 0);
    return *this;
  }

  Bytes bytes;

 private:
  Body& put(std::uint64_t value, int count) {
    for (int k = 0; k < count; ++k) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * k)));
    return *this;
  }
};

inline std::uint32_t crc_bit_by_bit(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? (crc >> 1U) ^ 0xEDB88320U : crc >> 1U;
  }
  return crc;
}

inline void append(Bytes& bytes, std::span<const std::uint8_t> more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

inline Bytes with_crc(Bytes bytes) {
  append(bytes, Body().u32(crc_bit_by_bit(bytes)).bytes);
  return bytes;
}

struct Header {
  unsigned type = 0;
  unsigned time_status = 180;
  unsigned week = 1643;
  std::uint32_t time_of_week_ms = 100'000'000;
  unsigned header_bytes = 28;
};

inline Bytes message(unsigned id, const Bytes& body, const Header& header = {}) {
  Body all;
  all.u8(0xAA).u8(0x44).u8(0x12).u8(header.header_bytes).u16(id).u8(header.type).u8(0x20);
  all.u16(static_cast<unsigned>(body.size())).u16(0).u8(100).u8(header.time_status).u16(header.week);
  all.u32(header.time_of_week_ms).u32(0).u16(0).u16(0).zeros(header.header_bytes - 28);
  append(all.bytes, body);
  return with_crc(all.bytes);
}

inline Bytes short_message(unsigned id, const Bytes& body) {
  Body all;
  all.u8(0xAA).u8(0x44).u8(0x13).u8(static_cast<unsigned>(body.size())).u16(id).u16(1643).u32(100'000'000);
  append(all.bytes, body);
  return with_crc(all.bytes);
}

/// One signal of RANGE.
struct Signal44 {
  unsigned prn = 7;
  double pseudorange_m = 22'000'000.25;
  double adr_cycles = -115'600'000.125;
  float doppler_hz = -1234.5F;
  float pseudorange_sigma_m = 0.05F;
  float adr_sigma_cycles = 0.01F;
  float cn0_dbhz = 45.5F;
  float lock_time_s = 120.25F;
  std::uint32_t status = 0x08101C04;  // GPS L1 C/A, phase and code lock, parity known
};

inline Bytes range_body(std::span<const Signal44> signals) {
  Body body;
  body.u32(static_cast<std::uint32_t>(signals.size()));
  for (const Signal44& s : signals) {
    body.u16(s.prn).u16(0).f64(s.pseudorange_m).f32(s.pseudorange_sigma_m).f64(s.adr_cycles).f32(s.adr_sigma_cycles);
    body.f32(s.doppler_hz).f32(s.cn0_dbhz).f32(s.lock_time_s).u32(s.status);
  }
  return body.bytes;
}

inline Bytes range(std::span<const Signal44> signals, const Header& header = {}) {
  return message(43, range_body(signals), header);
}

/// Field `field` written over the bytes at `offset`.
inline void overwrite(Bytes& bytes, std::size_t offset, const Bytes& field) {
  std::copy(field.begin(), field.end(), bytes.begin() + static_cast<std::ptrdiff_t>(offset));
}

/// A log as the stream reports it, of a receiver with a valid time. The body must live as long.
inline OemMessage log_of(std::uint16_t id, const Bytes& body, GpsTime time) {
  OemMessage message;
  message.id = id;
  message.time_status = 180;
  message.week = static_cast<std::uint16_t>(time.ns / kNanosecondsPerWeek);
  message.time_of_week_ms = static_cast<std::uint32_t>(time_of_week(time).ns / 1'000'000);
  message.body = body;
  return message;
}

// NovAtel's own ASCII test logs (tests/data/receiver/novatel_ascii_logs.txt), cut into fields.

inline std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

struct AsciiLog {
  unsigned week = 0;
  double time_of_week_s = 0.0;
  std::vector<std::string> body;
};

/// The log `name` (as RANGEA) of test case `test`.
inline AsciiLog ascii_log(const std::string& test, const std::string& name) {
  std::ifstream file(vbar::tests::source_path("tests/data/receiver/novatel_ascii_logs.txt"));
  AsciiLog log;
  std::string title;
  std::string line;
  std::getline(file, title);  // the source
  while (std::getline(file, title) && std::getline(file, line)) {
    if (title != "# " + test || line.rfind("#" + name + ",", 0) != 0) continue;
    const auto header = split(line.substr(0, line.find(';')), ',');
    log.week = static_cast<unsigned>(std::stoul(header[5]));
    log.time_of_week_s = std::stod(header[6]);
    log.body = split(line.substr(line.find(';') + 1, line.find('*') - line.find(';') - 1), ',');
    return log;
  }
  ADD_FAILURE() << "no log " << name << " of " << test;
  return log;
}

}  // namespace vbar::fsw::gnss::test
