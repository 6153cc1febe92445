#include "hil_drivers/grand/wire/pps_datagram.h"

#include <algorithm>

#include "hil_drivers/grand/wire/bytes.h"

namespace vbar::grand::wire {
namespace {

bool is_within_limits(std::int64_t ns) {
  return ns >= 0 && ns < kPpsTimeLimit_ns;
}

}  // namespace

std::array<std::uint8_t, kPpsDatagramBytes> encode_pps_datagram(const PpsDatagram& datagram) {
  std::array<std::uint8_t, kPpsDatagramBytes> bytes{};
  auto next = bytes.begin();
  const auto put = [&](auto number) { next = std::ranges::copy(bytes_of(number, ByteOrder::kLsbFirst), next).out; };
  put(datagram.gps.ns);
  put(datagram.monotonic_ns);
  put(datagram.count);
  return bytes;
}

std::optional<PpsDatagram> decode_pps_datagram(std::span<const std::uint8_t> bytes) {
  if (bytes.size() != kPpsDatagramBytes) return std::nullopt;
  ByteReader reader(bytes, "PPS datagram");
  PpsDatagram datagram;
  datagram.gps.ns = reader.get<std::int64_t>("GPS time");
  datagram.monotonic_ns = reader.get<std::int64_t>("monotonic time");
  datagram.count = reader.get<std::uint32_t>("count");
  if (!is_within_limits(datagram.gps.ns) || !is_within_limits(datagram.monotonic_ns)) return std::nullopt;
  return datagram;
}

}  // namespace vbar::grand::wire
