#pragma once
// The host's side of a receiver that is wired to the flight computer: waits until the flight computer has what the
// receiver sent, and takes the bytes that the flight software was given out of the answer.

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>

#include "host_sim/io/terminal_queue.h"
#include "host_sim/io/wired_receiver.h"
#include "pil_bridge/flight_computer.h"
#include "pil_bridge/transport.h"

namespace vbar::pil {

class WiredBytes {
 public:
  /// Is made when the flight computer has answered its hello: counts begin there.
  WiredBytes(io::WiredReceiver receiver, std::chrono::milliseconds limit);

  /// Asks for the number of bytes that have arrived at the flight computer; nothing if there is no answer by a
  /// deadline.
  using AskCount = std::function<std::optional<std::uint64_t>(Clock::time_point deadline)>;

  /// Returns, in lock-step, when everything the receiver has sent has arrived, or when nothing more has arrived within
  /// the limit. What has not arrived by then is missing: it is counted once and not waited for again.
  void wait(const AskCount& ask);

  /// Returns the gnss_bytes that the flight software was given, if `packet` is a wired_bytes. Throws LinkError if its
  /// content is invalid.
  std::optional<Packet> take(const Packet& packet);

  [[nodiscard]] const WiredStatistics& statistics() const { return statistics_; }

 private:
  /// Bytes sent and not arrived, negative if more have arrived; 0 if the receiver does not count.
  [[nodiscard]] std::int64_t difference() const;

  io::WiredReceiver receiver_;
  io::TerminalQueue under_way_;
  std::chrono::milliseconds limit_;
  std::uint64_t sent_before_ = 0;
  std::uint64_t arrived_ = 0;  ///< as last reported by the flight computer
  std::int64_t missing_ = 0;   ///< sent and arrived differ by this number after the last wait
  WiredStatistics statistics_;
};

}  // namespace vbar::pil
