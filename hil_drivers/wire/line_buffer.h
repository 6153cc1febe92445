#pragma once
// Cuts a stream into lines that end with LF, CR or both; empty lines are skipped.

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "hil_drivers/wire/bytes.h"

namespace vbar::wire {

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
