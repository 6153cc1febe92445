#pragma once
// Source of sACN: sends levels of lights to one receiver, unicast. Nothing acknowledges them.

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "hil_drivers/tron/bench_file/bench_file.h"
#include "hil_drivers/tron/sacn/wire/data_packet.h"

namespace vbar::tron::sacn {

/// Returns the CID of the source that controls the lights of a testbed: the same whenever it is started. A UUID of
/// version 8 (RFC 9562).
[[nodiscard]] Cid cid_of_bench(const std::string& bench);

class Sender {
 public:
  static constexpr int kTerminatedPackets = 3;
  static constexpr double kKeepAliveSeconds = 0.8;  ///< E1.31 6.6.1: between 800 and 1000 ms

  /// Sends to `settings.address`. Throws std::runtime_error, std::invalid_argument.
  Sender(const SacnSettings& settings, const std::string& bench);
  /// Ends the source if it is still active.
  ~Sender();
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;

  /// Sends values from the start slot of the settings; the other slots are zero. Throws std::runtime_error if the
  /// system does not accept the datagram, std::invalid_argument if the values do not fit into the universe.
  void send(std::span<const std::uint16_t> values);
  /// Sends the last values again; nothing if there are none or the source has ended. It has to be called at least every
  /// kKeepAliveSeconds: a receiver drops a source after 2.5 s.
  void keep_alive();
  /// Sends three packets with the option "terminated"; send() starts the source again.
  void terminate() noexcept;

  [[nodiscard]] std::uint64_t packets() const;
  /// Returns the name for messages: "lights at 127.0.20.4:5568, universe 1".
  [[nodiscard]] std::string description() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vbar::tron::sacn
