#pragma once
// A serial line (or the slave end of a pseudo-terminal) whose rate changes while it is open and whose other end may
// hang up. Raw, 8N1, no flow control, modem lines ignored.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host_sim/io/byte_channel.h"

namespace vbar::io {

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

}  // namespace vbar::io
