#pragma once
// A GNSS receiver whose log port is connected to the flight computer, not to this program.

#include <cstdint>
#include <functional>
#include <string>

namespace vbar::io {

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
