#pragma once
// Fields of one message in Protocol Buffers wire format (protobuf.dev, "Encoding"), read within bounds from foreign
// datagrams: nothing is allocated, and a malformed field ends the message.

#include <bit>
#include <cstdint>
#include <optional>
#include <span>

namespace vbar::grand::bench {

class ProtobufReader {
 public:
  explicit ProtobufReader(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  /// Field of one of the four wire types that are in use; `number` is that of a varint or a fixed number, `bytes` those
  /// of a string or a message.
  struct Field {
    enum class Type : std::uint8_t { kVarint = 0, kFixed64 = 1, kBytes = 2, kFixed32 = 5 };
    std::uint64_t tag = 0;
    Type type = Type::kVarint;
    std::uint64_t number = 0;
    std::span<const std::uint8_t> bytes;

    [[nodiscard]] double as_double() const { return type == Type::kFixed64 ? std::bit_cast<double>(number) : 0.0; }
    [[nodiscard]] bool is_varint() const { return type == Type::kVarint; }
  };

  /// Returns the next field; nothing at the end or where the bytes are malformed.
  std::optional<Field> next();
  /// Returns true if the end was reached without a malformed field.
  [[nodiscard]] bool complete() const { return !malformed_ && rest_.empty(); }

 private:
  std::optional<std::uint64_t> varint();
  std::optional<std::uint64_t> fixed(std::size_t count);

  std::span<const std::uint8_t> rest_;
  bool malformed_ = false;
};

}  // namespace vbar::grand::bench
