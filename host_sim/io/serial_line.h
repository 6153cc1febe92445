#pragma once
// Settings that all serial lines of this library share. For its own files.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host_sim/io/byte_channel.h"
#include "host_sim/io/file_descriptor.h"

namespace vbar::io {

/// 8N1, no echo, no translation, no flow control, modem lines ignored. Throws ChannelError that begins with
/// `description`.
void set_raw(int terminal, const std::string& description);

// Whether a terminal holds bytes that the program at its end has not read: of a receiver on a pseudo-terminal that this
// program does not read itself.

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

// A serial line (or the slave end of a pseudo-terminal) whose rate changes while it is open and whose other end may
// hang up. Raw, 8N1, no flow control, modem lines ignored.

class SerialLine {
 public:
  /// Bytes of an earlier use in the driver's buffers are discarded. Throws ChannelError.
  SerialLine(const std::string& device, unsigned baud);
  ~SerialLine();
  SerialLine(const SerialLine&) = delete;
  SerialLine& operator=(const SerialLine&) = delete;

  /// Changes the rate once what was written has left at the old rate. Throws ChannelError.
  void set_baud(unsigned baud);
  [[nodiscard]] unsigned baud() const { return baud_; }

  /// Writes all of `bytes`. Throws ChannelError if the line is closed or does not accept them by `deadline`.
  void write(std::span<const std::uint8_t> bytes, Clock::time_point deadline);

  /// Appends all that has arrived by now: it reads until the line is empty, which on a pseudo-terminal includes
  /// everything that its other end wrote before the call. Throws ChannelError if the other end has hung up; what came
  /// before has been appended then.
  void read_available(std::vector<std::uint8_t>& bytes);

  /// Returns when something has arrived, the other end has hung up, or at `deadline`.
  void wait_for_input(Clock::time_point deadline);

  [[nodiscard]] const std::string& device() const { return device_; }

 private:
  struct Port;
  std::string device_;
  unsigned baud_;
  std::unique_ptr<Port> port_;
};

// A GNSS receiver whose log port is connected to the flight computer, not to this program.

struct WiredReceiver {
  /// The line's end at the flight computer, if this program starts it: a serial device or pseudo-terminal. A board has
  /// its own.
  std::string device;
  unsigned baud = 115200;
  /// A step begins when everything that the receiver has sent by then has arrived. Otherwise, in real time, a step
  /// takes what has arrived by its tick.
  bool in_lock_step = false;
  /// Bytes that the receiver has sent on the line so far, if that is known: lost ones are then detected. Without it,
  /// or where it is a lower bound, what `device` holds must be all that is under way (an emulator's pseudo-terminal).
  std::function<std::uint64_t()> bytes_sent = {};
};

}  // namespace vbar::io
