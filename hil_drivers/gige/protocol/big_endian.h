#pragma once
// Big-endian numbers in datagrams. The caller has checked that the bytes are there.

#include <cstdint>
#include <span>
#include <vector>

#include <boost/endian/conversion.hpp>

namespace vbar::gige::wire {

using Bytes = std::vector<std::uint8_t>;
using ByteSpan = std::span<const std::uint8_t>;

inline std::uint16_t load_u16(ByteSpan bytes, std::size_t at) {
  return boost::endian::load_big_u16(bytes.data() + at);
}
inline std::uint32_t load_u24(ByteSpan bytes, std::size_t at) {
  return boost::endian::load_big_u24(bytes.data() + at);
}
inline std::uint32_t load_u32(ByteSpan bytes, std::size_t at) {
  return boost::endian::load_big_u32(bytes.data() + at);
}
inline std::uint64_t load_u64(ByteSpan bytes, std::size_t at) {
  return boost::endian::load_big_u64(bytes.data() + at);
}

inline void append_u16(Bytes& bytes, std::uint16_t value) {
  bytes.resize(bytes.size() + 2);
  boost::endian::store_big_u16(bytes.data() + bytes.size() - 2, value);
}
inline void append_u24(Bytes& bytes, std::uint32_t value) {
  bytes.resize(bytes.size() + 3);
  boost::endian::store_big_u24(bytes.data() + bytes.size() - 3, value & 0xFFFFFFU);
}
inline void append_u32(Bytes& bytes, std::uint32_t value) {
  bytes.resize(bytes.size() + 4);
  boost::endian::store_big_u32(bytes.data() + bytes.size() - 4, value);
}
inline void append_u64(Bytes& bytes, std::uint64_t value) {
  bytes.resize(bytes.size() + 8);
  boost::endian::store_big_u64(bytes.data() + bytes.size() - 8, value);
}

}  // namespace vbar::gige::wire
