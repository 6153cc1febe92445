#include "hil_drivers/grand/bench/samples/gnss_sdr/protobuf_reader.h"

namespace vbar::grand::bench {

std::optional<std::uint64_t> ProtobufReader::varint() {
  constexpr std::size_t kMaxBytes = 10;
  std::uint64_t value = 0;
  for (std::size_t k = 0; k < kMaxBytes && k < rest_.size(); ++k) {
    value |= static_cast<std::uint64_t>(rest_[k] & 0x7FU) << (7U * k);
    if ((rest_[k] & 0x80U) != 0) continue;
    rest_ = rest_.subspan(k + 1);
    return value;
  }
  return std::nullopt;
}

std::optional<std::uint64_t> ProtobufReader::fixed(std::size_t count) {
  if (rest_.size() < count) return std::nullopt;
  std::uint64_t value = 0;
  for (std::size_t k = 0; k < count; ++k) value |= static_cast<std::uint64_t>(rest_[k]) << (8U * k);
  rest_ = rest_.subspan(count);
  return value;
}

std::optional<ProtobufReader::Field> ProtobufReader::next() {
  if (malformed_ || rest_.empty()) return std::nullopt;
  malformed_ = true;  // until the field is complete
  const std::optional<std::uint64_t> key = varint();
  if (!key) return std::nullopt;
  Field field;
  field.tag = *key >> 3U;
  field.type = static_cast<Field::Type>(*key & 7U);
  std::optional<std::uint64_t> number;
  switch (field.type) {
    case Field::Type::kVarint:
    case Field::Type::kBytes:
      number = varint();
      break;
    case Field::Type::kFixed64:
      number = fixed(8);
      break;
    case Field::Type::kFixed32:
      number = fixed(4);
      break;
  }
  if (!number) return std::nullopt;
  field.number = *number;
  if (field.type == Field::Type::kBytes) {
    if (*number > rest_.size()) return std::nullopt;
    field.bytes = rest_.first(static_cast<std::size_t>(*number));
    rest_ = rest_.subspan(field.bytes.size());
  }
  malformed_ = false;
  return field;
}

}  // namespace vbar::grand::bench
