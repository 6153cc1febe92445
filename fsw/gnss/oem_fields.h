#pragma once
// Fields of NovAtel's binary messages: little-endian numbers (IEEE 754 for the real ones) and strings of bits. The
// caller has checked that the bytes exist.

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "fsw/core/gps_time.h"
#include "fsw/core/result.h"
#include "fsw/gnss/oem_stream.h"

namespace vbar::fsw::gnss {

/// Reads sizeof(Integer) bytes from `offset` on.
template <std::unsigned_integral Integer>
[[nodiscard]] constexpr Integer read_little_endian(std::span<const std::uint8_t> bytes, std::size_t offset) {
  std::uint64_t value = 0;
  for (std::size_t i = sizeof(Integer); i > 0; --i) value = (value << 8U) | bytes[offset + i - 1];
  return static_cast<Integer>(value);
}

[[nodiscard]] constexpr std::uint32_t read_u32(std::span<const std::uint8_t> bytes, std::size_t offset) {
  return read_little_endian<std::uint32_t>(bytes, offset);
}

/// Reads four bytes of single precision. Any value is possible, NaN and infinity included.
[[nodiscard]] constexpr double read_f32(std::span<const std::uint8_t> bytes, std::size_t offset) {
  return static_cast<double>(std::bit_cast<float>(read_little_endian<std::uint32_t>(bytes, offset)));
}

/// Reads eight bytes of double precision. Any value is possible, NaN and infinity included.
[[nodiscard]] constexpr double read_f64(std::span<const std::uint8_t> bytes, std::size_t offset) {
  return std::bit_cast<double>(read_little_endian<std::uint64_t>(bytes, offset));
}

/// Returns the number whose lowest `count` bits (1 to 32) are two's complement.
[[nodiscard]] constexpr std::int32_t sign_extended(std::uint32_t value, unsigned count) {
  const std::uint32_t sign = 1U << (count - 1);
  const std::uint32_t magnitude = value & (sign - 1);
  return (value & sign) == 0 ? static_cast<std::int32_t>(magnitude)
                             : static_cast<std::int32_t>(static_cast<std::int64_t>(magnitude) - sign);
}

/// Reads `count` bits (at most 64) of a string whose bit 0 is the lowest of its first byte, as in RANGECMP.
[[nodiscard]] constexpr std::uint64_t read_low_first_bits(std::span<const std::uint8_t> bytes, std::size_t first,
                                                          unsigned count) {
  std::uint64_t value = 0;
  for (unsigned i = 0; i < count; ++i) {
    const std::size_t bit = first + i;
    value |= static_cast<std::uint64_t>((static_cast<unsigned>(bytes[bit / 8]) >> (bit % 8)) & 1U) << i;
  }
  return value;
}

/// Reads `count` bits (at most 32) of a string whose bit 0 is the highest of its first byte, as navigation data are
/// sent.
[[nodiscard]] constexpr std::uint32_t read_high_first_bits(std::span<const std::uint8_t> bytes, std::size_t first,
                                                           unsigned count) {
  std::uint32_t value = 0;
  for (std::size_t bit = first; bit < first + count; ++bit) {
    value = (value << 1U) | ((static_cast<unsigned>(bytes[bit / 8]) >> (7U - bit % 8)) & 1U);
  }
  return value;
}

// The time in the header of a NovAtel message (OEM7 Commands and Logs Reference Manual, 1.2 "GPS reference time
// status").

/// The receiver's status of GPS time.
enum class OemTimeStatus : std::uint8_t {
  kUnknown = 20,
  kApproximate = 60,
  kCoarseAdjusting = 80,
  kCoarse = 100,
  kCoarseSteering = 120,
  kFreewheeling = 130,
  kFineAdjusting = 140,
  kFine = 160,
  kFineBackupSteering = 170,
  kFineSteering = 180,
  kSatTime = 200,
};

/// Returns the receiver's own time of the message, exact. kNotReady: the receiver does not have the time (unknown,
/// approximate within seconds, or week 0). kOutOfRange: an unknown status, a week after 2171, a time of week beyond a
/// week.
Result<GpsTime> time_of(const OemMessage& message);

}  // namespace vbar::fsw::gnss
