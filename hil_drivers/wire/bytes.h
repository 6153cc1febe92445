#pragma once
// Numbers in bytes, in either byte order, with the position of every error.

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "fsw/core/types.h"

namespace vbar::wire {

using Bytes = std::vector<std::uint8_t>;

/// Error of a message that does not decode, or of a value that cannot be encoded: one sentence with the position.
class WireError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

enum class ByteOrder { kLsbFirst, kMsbFirst };

template <class Number>
concept WireNumber = std::integral<Number> || std::floating_point<Number>;

/// Returns the bytes of `value` in `order`; the function is its own inverse with respect to the order of this computer.
template <WireNumber Number>
std::array<std::uint8_t, sizeof(Number)> bytes_of(Number value, ByteOrder order) {
  std::array<std::uint8_t, sizeof(Number)> bytes{};
  std::memcpy(bytes.data(), &value, sizeof value);
  const bool is_native = (std::endian::native == std::endian::little) == (order == ByteOrder::kLsbFirst);
  if (!is_native) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

class ByteWriter {
 public:
  explicit ByteWriter(Bytes& bytes, ByteOrder order = ByteOrder::kLsbFirst) : bytes_(bytes), order_(order) {}

  template <WireNumber Number>
  void put(Number value) {
    const auto raw = bytes_of(value, order_);
    bytes_.insert(bytes_.end(), raw.begin(), raw.end());
  }
  void put(const fsw::Vector3& vector);
  void put(std::string_view text) { bytes_.insert(bytes_.end(), text.begin(), text.end()); }

 private:
  Bytes& bytes_;
  ByteOrder order_;
};

class ByteReader {
 public:
  /// Reads `bytes`. `what` is the name of the message in errors; it outlives the reader.
  ByteReader(std::span<const std::uint8_t> bytes, std::string_view what, ByteOrder order = ByteOrder::kLsbFirst)
      : bytes_(bytes), what_(what), order_(order) {}

  template <WireNumber Number>
  Number get(std::string_view field) {
    const std::span<const std::uint8_t> raw = take(sizeof(Number), field);
    std::array<std::uint8_t, sizeof(Number)> copy{};
    std::copy(raw.begin(), raw.end(), copy.begin());
    const bool is_native = (std::endian::native == std::endian::little) == (order_ == ByteOrder::kLsbFirst);
    if (!is_native) std::reverse(copy.begin(), copy.end());
    return std::bit_cast<Number>(copy);
  }
  /// Reads a number and rejects one that is not finite.
  double finite(std::string_view field);
  fsw::Vector3 vector(std::string_view field);
  std::span<const std::uint8_t> take(std::size_t count, std::string_view field);

  [[nodiscard]] std::size_t position() const { return position_; }
  [[nodiscard]] std::size_t remaining() const { return bytes_.size() - position_; }
  /// Rejects bytes behind the last field.
  void finish() const;
  [[noreturn]] void fail(std::string_view field, std::string_view problem) const;

 private:
  std::span<const std::uint8_t> bytes_;
  std::string_view what_;
  ByteOrder order_;
  std::size_t position_ = 0;
};

/// Bytes of unknown origin as they can stand in a message: printable characters, others as \xNN; at most 80 of them.
std::string printable(std::string_view text);

// Cuts a stream into lines that end with LF, CR or both; empty lines are skipped.

class LineBuffer {
 public:
  void append(std::span<const std::uint8_t> bytes) { buffer_.insert(buffer_.end(), bytes.begin(), bytes.end()); }
  /// Returns the next complete line. Throws WireError if more than 8192 characters arrive without a line end; they are
  /// discarded.
  std::optional<std::string> next();

 private:
  std::string buffer_;
};

}  // namespace vbar::wire
