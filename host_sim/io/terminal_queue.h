#pragma once
// Whether a terminal holds bytes that the program at its end has not read: of a receiver on a pseudo-terminal that this
// program does not read itself.

#include <string>

#include "host_sim/io/file_descriptor.h"

namespace vbar::io {

class TerminalQueue {
 public:
  /// `device`: a serial device or pseudo-terminal. Empty: one that is always empty, as is one that cannot be opened.
  explicit TerminalQueue(std::string device) : device_(std::move(device)) {}

  /// Returns false while bytes wait to be read. A terminal that was hung up is empty, and is opened again the next
  /// time.
  [[nodiscard]] bool is_empty();

 private:
  std::string device_;
  FileDescriptor terminal_;
};

}  // namespace vbar::io
