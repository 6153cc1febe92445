#include "hil_drivers/wire/line_buffer.h"

#include <fmt/format.h>

namespace vbar::wire {

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
