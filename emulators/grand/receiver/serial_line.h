#pragma once
// Baud rates of the receiver's serial ports (OEM6 Firmware Reference Manual OM-20000129, command SERIALCONFIG).

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "host_sim/engine/random_stream.h"

namespace vbar::grand::bench {

inline constexpr std::array<unsigned, 9> kBaudRates{2400, 4800, 9600, 19200, 38400, 57600, 115200, 230400, 460800};
inline constexpr unsigned kFactoryBaud = 9600;

constexpr bool is_baud_rate(unsigned baud) {
  return std::ranges::find(kBaudRates, baud) != kBaudRates.end();
}

// Output of a serial port: whole messages wait in a buffer and leave byte by byte at the baud rate (8N1: ten bits a
// byte). Times are the receiver's own local time, ns since it was made.

using Bytes = std::vector<std::uint8_t>;

class SerialLine {
 public:
  SerialLine(unsigned baud, int buffer_bytes, engine::RandomStream garbage);

  /// Queues a message that is ready at `ready_ns`, not before the one queued last. Returns false if it does not fit
  /// into the buffer: it is dropped as a whole.
  bool queue(std::span<const std::uint8_t> message, std::int64_t ready_ns);
  /// Sets the rate of messages queued from now on.
  void set_baud(unsigned baud) { baud_ = baud; }
  [[nodiscard]] unsigned baud() const { return baud_; }
  /// Discards everything that has not left.
  void clear();

  /// Returns the bytes whose stop bit has passed by `now_ns`, as a listener at `host_baud` (0: the right rate) receives
  /// them.
  [[nodiscard]] Bytes take(std::int64_t now_ns, unsigned host_baud);
  /// Returns true if a byte has not left yet.
  [[nodiscard]] bool busy(std::int64_t now_ns) const { return free_ns_ > now_ns; }

  /// Returns what arrives of `bytes` sent at another rate than the listener's: random bytes, in proportion to the
  /// rates.
  Bytes garbage(std::span<const std::uint8_t> bytes, unsigned sent_baud, unsigned heard_baud);

 private:
  struct Message {
    Bytes bytes;
    std::size_t left = 0;  ///< bytes that have left
    std::int64_t begin_ns = 0;
    unsigned baud = 0;
  };
  [[nodiscard]] std::size_t waiting_at(std::int64_t ns) const;
  void forget_unheard(std::int64_t ns);

  unsigned baud_;
  std::size_t buffer_bytes_;
  engine::RandomStream garbage_;
  std::deque<Message> queue_;
  std::int64_t free_ns_ = 0;  ///< time at which the last byte queued will have left
};

}  // namespace vbar::grand::bench
