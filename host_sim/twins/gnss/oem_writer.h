#pragma once
// One binary message of an OEM6 receiver: header, fields, CRC-32; little-endian.

#include <bit>
#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string_view>

#include "host_sim/twins/gnss/oem_encoder.h"

namespace vbar::twins::gnss::oem {

/// Computes NovAtel's CRC-32: the standard polynomial, but initialised with 0 and not inverted.
std::uint32_t crc32(std::span<const std::uint8_t> bytes);

/// Writer of a message. The header is written at once, its length and the CRC by finish().
class MessageWriter {
 public:
  MessageWriter(Bytes& bytes, MessageId id, const Header& header, bool is_response = false);

  void u8(std::uint8_t value) { bytes_.push_back(value); }
  void u16(std::uint16_t value) { little_endian(value); }
  void u32(std::uint32_t value) { little_endian(value); }
  void i32(std::int32_t value) { little_endian(static_cast<std::uint32_t>(value)); }
  void f32(double value) { little_endian(std::bit_cast<std::uint32_t>(static_cast<float>(value))); }
  void f64(double value) { little_endian(std::bit_cast<std::uint64_t>(value)); }
  void f64s(std::initializer_list<double> values) {
    for (const double value : values) f64(value);
  }
  void zeros(int count) {
    for (int k = 0; k < count; ++k) u8(0);
  }
  /// Writes a field of `size` characters, cut or filled with zeros.
  void text(std::string_view value, std::size_t size) {
    for (std::size_t k = 0; k < size; ++k) u8(k < value.size() ? static_cast<std::uint8_t>(value[k]) : 0);
  }

  void finish();

 private:
  template <std::unsigned_integral T>
  void little_endian(T value) {
    for (std::size_t k = 0; k < sizeof(T); ++k)
      bytes_.push_back(static_cast<std::uint8_t>((value >> (8U * k)) & 0xFFU));
  }

  Bytes& bytes_;
  std::size_t begin_;
};

}  // namespace vbar::twins::gnss::oem
