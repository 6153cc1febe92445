#pragma once
// Serial line on which a GNSS receiver is wired to a flight computer under a POSIX system.

#include <cstddef>
#include <cstdint>
#include <span>

namespace vbar::boards::posix {

class ReceiverLine {
 public:
  /// `device` is a serial device or pseudo-terminal, opened when a session requires it. Null: there is none.
  explicit ReceiverLine(const char* device) : device_(device) {}
  ~ReceiverLine() { close(); }
  ReceiverLine(const ReceiverLine&) = delete;
  ReceiverLine& operator=(const ReceiverLine&) = delete;

  /// Opens the device at this rate and discards earlier bytes. Returns false if it cannot be opened or the rate is
  /// unknown.
  bool open(std::uint32_t baud);
  void close();

  /// Moves received bytes to `out` without waiting; returns their number. A line that was hung up gives none and is
  /// opened again as soon as that is possible.
  std::size_t read(std::span<std::uint8_t> out);

  /// Descriptor to wait for bytes; -1 while the line is closed or hung up.
  [[nodiscard]] int fd() const { return fd_; }

 private:
  bool open_device();
  void hang_up();

  const char* device_;
  std::uint32_t baud_ = 0;  ///< 0: closed
  int fd_ = -1;
};

}  // namespace vbar::boards::posix
