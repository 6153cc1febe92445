#include "host_sim/twins/gnss/oem_writer.h"

#include "fsw/core/crc32.h"
#include "host_sim/twins/gnss/system_time.h"

namespace vbar::twins::gnss::oem {
namespace {

constexpr std::size_t kHeaderBytes = 28;

}  // namespace

std::uint32_t crc32(std::span<const std::uint8_t> bytes) {
  return fsw::crc32_after(0, bytes);
}

MessageWriter::MessageWriter(Bytes& bytes, MessageId id, const Header& header, bool is_response)
    : bytes_(bytes), begin_(bytes.size()) {
  const bool known = header.status != TimeStatus::kUnknown;
  const WeekTime time = week_time(System::kGps, header.time);
  constexpr std::uint8_t kResponse = 0x80;
  for (const std::uint8_t byte : {0xAA, 0x44, 0x12, static_cast<int>(kHeaderBytes)}) u8(byte);
  u16(static_cast<std::uint16_t>(id));
  u8(is_response ? kResponse : 0);  // binary
  u8(header.port);
  u16(0);   // body length, later
  u16(0);   // last of its sequence
  u8(180);  // idle time, half percents
  u8(static_cast<std::uint8_t>(header.status));
  u16(static_cast<std::uint16_t>(known ? time.week : 0));
  u32(static_cast<std::uint32_t>(known ? time.ns_of_week / 1'000'000 : 0));
  u32(header.status_word());
  u16(0);  // message definition
  u16(0);  // software version
}

void MessageWriter::finish() {
  const std::size_t body = bytes_.size() - begin_ - kHeaderBytes;
  bytes_[begin_ + 8] = static_cast<std::uint8_t>(body & 0xFFU);
  bytes_[begin_ + 9] = static_cast<std::uint8_t>(body >> 8U);
  u32(crc32(std::span(bytes_).subspan(begin_)));
}

}  // namespace vbar::twins::gnss::oem
