#pragma once
// Lights of the emulator on the network: a UDP port that the emulator empties at the beginning of each robot
// cycle, so that a packet sent before an answer acts before the cycle of that answer.

#include <cstdint>
#include <memory>
#include <string>

#include <boost/asio/io_context.hpp>

#include "hil_drivers/tron/bench/lights/light_rig.h"
#include "hil_drivers/tron/bench/lights/source_arbiter.h"
#include "hil_drivers/tron/bench_file/bench_file.h"

namespace vbar::tron::bench {

class LightReceiver {
 public:
  /// Listens at `settings.address`, `port` (0: any free one). Throws std::runtime_error.
  LightReceiver(boost::asio::io_context& context, const SacnSettings& settings, std::uint16_t port, LightRig& rig);
  ~LightReceiver();
  LightReceiver(const LightReceiver&) = delete;
  LightReceiver& operator=(const LightReceiver&) = delete;

  /// Processes what has arrived, drops silent sources and moves the lamp. Without a source the lights are off.
  void begin_cycle(double bench_s);

  [[nodiscard]] std::uint16_t port() const;
  /// Returns the address for addresses.json: "127.0.20.4:40001".
  [[nodiscard]] std::string address() const;
  [[nodiscard]] const SourceCounts& counts() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vbar::tron::bench
