#include "hil_drivers/wire/bytes.h"

#include <cmath>

#include <fmt/format.h>

namespace vbar::wire {

void ByteWriter::put(const fsw::Vector3& vector) {
  for (const double component : vector) put(component);
}

void ByteReader::fail(std::string_view field, std::string_view problem) const {
  throw WireError(fmt::format("{}, byte {}: {} {}", what_, position_, field, problem));
}

std::span<const std::uint8_t> ByteReader::take(std::size_t count, std::string_view field) {
  if (count > remaining()) fail(field, fmt::format("needs {} bytes, {} are left", count, remaining()));
  const auto taken = bytes_.subspan(position_, count);
  position_ += count;
  return taken;
}

double ByteReader::finite(std::string_view field) {
  const std::size_t begin = position_;
  const double value = get<double>(field);
  if (!std::isfinite(value)) {
    position_ = begin;
    fail(field, "is not finite");
  }
  return value;
}

fsw::Vector3 ByteReader::vector(std::string_view field) {
  fsw::Vector3 value;
  for (double& component : value) component = finite(field);
  return value;
}

void ByteReader::finish() const {
  if (remaining() > 0) fail("the message", fmt::format("has {} bytes too many", remaining()));
}

std::string printable(std::string_view text) {
  constexpr std::size_t kLimit = 80;
  std::string shown;
  for (const char c : text.substr(0, kLimit)) {
    if (c >= 0x20 && c < 0x7f)
      shown += c;
    else
      shown += fmt::format("\\x{:02x}", static_cast<std::uint8_t>(c));
  }
  if (text.size() > kLimit) shown += "...";
  return shown;
}

std::optional<std::string> LineBuffer::next() {
  constexpr std::string_view kEnds = "\r\n";
  constexpr std::size_t kMaxLine = 8192;
  buffer_.erase(0, std::min(buffer_.find_first_not_of(kEnds), buffer_.size()));
  const std::size_t end = buffer_.find_first_of(kEnds);
  if (std::min(end, buffer_.size()) > kMaxLine) {
    const std::string begin = printable(buffer_);
    buffer_.clear();
    throw WireError(fmt::format("a line of more than {} characters that begins with \"{}\"", kMaxLine, begin));
  }
  if (end == std::string::npos) return std::nullopt;
  std::string line = buffer_.substr(0, end);
  buffer_.erase(0, end + 1);
  return line;
}

}  // namespace vbar::wire
