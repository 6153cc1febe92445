#include "hil_drivers/grand/bursts.h"

#include <algorithm>

#include <boost/crc.hpp>

#include "fsw/gnss/oem_fields.h"

namespace vbar::grand {
namespace {

using fsw::gnss::OemMessage;

constexpr std::uint16_t kGpsEphem = 7, kRawEphem = 41, kRange = 43, kTime = 101, kBestXyz = 241;
constexpr std::uint32_t kHeightOrVelocityLimit = 7;  // solution status (OEM6 manual, BESTPOS)
constexpr std::size_t kChecksumBytes = 4;

bool is_log(const OemMessage& message) {
  return !message.is_response && message.format == 0;
}

TimeTag tag_of(const OemMessage& message) {
  const auto time = fsw::gnss::time_of(message);
  return {message.time_status, time.ok() ? time.value() : fsw::GpsTime{}};
}

/// Header, body and checksum of the message that ends with the last of `bytes`; empty if its header is not there.
std::span<std::uint8_t> whole_message(std::span<std::uint8_t> bytes, std::size_t body_size) {
  constexpr std::size_t kShortHeader = 12;
  const std::size_t fixed = body_size + kChecksumBytes;
  for (std::size_t header = kShortHeader; header < 256 && header + fixed <= bytes.size(); ++header) {
    const auto whole = bytes.last(header + fixed);
    if (whole[0] != 0xAA || whole[1] != 0x44) continue;
    if (whole[2] == 0x12 && whole[3] == header) return whole;
    if (whole[2] == 0x13 && header == kShortHeader) return whole;
  }
  return {};
}

void add_to_u16(std::span<std::uint8_t> bytes, std::size_t offset, int weeks) {
  const int value = fsw::gnss::read_little_endian<std::uint16_t>(bytes, offset) + weeks;
  bytes[offset] = static_cast<std::uint8_t>(value & 0xFF);
  bytes[offset + 1] = static_cast<std::uint8_t>((value >> 8) & 0xFF);
}

void shift_message(std::span<std::uint8_t> whole, std::uint16_t id, std::size_t body_size, int weeks) {
  const bool is_long = whole[2] == 0x12;
  const std::size_t week_at = is_long ? 14 : 6;
  if (fsw::gnss::read_little_endian<std::uint16_t>(whole, week_at) == 0) return;  // the receiver has no time yet
  add_to_u16(whole, week_at, weeks);
  const std::size_t body = whole.size() - kChecksumBytes - body_size;
  if (id == kRawEphem && body_size >= 8) add_to_u16(whole, body + 4, weeks);
  if (id == kGpsEphem && body_size >= 32)
    for (const std::size_t offset : {24, 28}) add_to_u16(whole, body + offset, weeks);
  boost::crc_optimal<32, 0x04C11DB7, 0, 0, true, true> crc;
  crc.process_bytes(whole.data(), whole.size() - kChecksumBytes);
  for (std::size_t k = 0; k < kChecksumBytes; ++k)
    whole[whole.size() - kChecksumBytes + k] = static_cast<std::uint8_t>(crc.checksum() >> (8 * k));
}

}  // namespace

bool TimeTag::is_fine() const {
  return status >= static_cast<std::uint8_t>(fsw::gnss::OemTimeStatus::kFine) &&
         status < static_cast<std::uint8_t>(fsw::gnss::OemTimeStatus::kSatTime);
}

std::vector<Burst> BurstCutter::push(std::span<const std::uint8_t> bytes) {
  std::vector<Burst> bursts;
  for (const std::uint8_t byte : bytes) {
    rest_.push_back(byte);
    if (!stream_.push(byte)) continue;
    const OemMessage message = stream_.message();
    if (!is_log(message)) continue;
    if (message.id == kRange && message.body.size() >= 4)
      next_.tracked_signals = static_cast<int>(fsw::gnss::read_u32(message.body, 0));
    if (message.id == kBestXyz && message.body.size() >= 4)
      next_.limit_exceeded = fsw::gnss::read_u32(message.body, 0) == kHeightOrVelocityLimit;
    if (message.id != kTime) continue;
    next_.tag = tag_of(message);
    next_.bytes = take_rest();
    bursts.push_back(std::exchange(next_, {}));
  }
  return bursts;
}

void shift_weeks(std::span<std::uint8_t> bytes, int weeks) {
  fsw::gnss::OemStream stream;
  for (std::size_t k = 0; k < bytes.size(); ++k) {
    if (!stream.push(bytes[k])) continue;
    const OemMessage message = stream.message();
    const auto whole = whole_message(bytes.first(k + 1), message.body.size());
    if (!whole.empty()) shift_message(whole, message.id, message.body.size(), weeks);
  }
}

}  // namespace vbar::grand
