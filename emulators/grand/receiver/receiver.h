#pragma once
// Emulated NovAtel OEM628 behind its antenna connector and its serial ports. Its measurements result from tracking
// loops (tracking_loops.h) on the radio field (../rf_block.h); its data come from the messages of the satellites and
// from commands.

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "emulators/grand/radio_field/rf_block.h"
#include "emulators/grand/receiver/measurements.h"
#include "emulators/grand/receiver/receiver_settings.h"
#include "fsw/core/gps_time.h"
#include "host_sim/twins/gnss/constellation.h"

namespace vbar::grand::bench {

/// Number of serial ports. They are numbered from 0: port 0 is COM1.
inline constexpr int kReceiverPorts = 2;

class Receiver {
 public:
  /// Makes a receiver that is switched off. Every random stream is named "grand/receiver/<vehicle>/...".
  /// `constellation` gives the content of the navigation messages, nothing else. Throws std::invalid_argument without a
  /// constellation.
  Receiver(const ReceiverSettings& settings, std::shared_ptr<const twins::gnss::Constellation> constellation,
           std::uint64_t seed, std::string_view vehicle);
  /// Makes a receiver with the same ports, commands and logs on the measurements of `measurements`.
  Receiver(const ReceiverSettings& settings, std::shared_ptr<const twins::gnss::Constellation> constellation,
           std::uint64_t seed, std::string_view vehicle, std::unique_ptr<Measurements> measurements);
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;
  Receiver(Receiver&&) noexcept;
  Receiver& operator=(Receiver&&) noexcept;
  ~Receiver();

  /// Advances by the 100 ms of the block. Blocks follow each other; a gap counts as time without power of the
  /// generator, during which the receiver's oscillator does not advance.
  void advance(const RfBlock& block);

  /// Advances by `span` before the generator runs or after it has stopped: bytes leave, a restart proceeds, nothing is
  /// measured, and no random number is drawn, so that later measurements do not depend on it.
  void idle(fsw::Duration span);
  /// Returns true while an answer, a log or a restart is under way; idle() is called until it is not.
  [[nodiscard]] bool busy() const;

  /// Processes bytes that have arrived at the port, at the receiver's present time. At another baud rate than the
  /// port's they arrive as garbage.
  void listen(int port, std::span<const std::uint8_t> bytes, unsigned host_baud);
  /// Processes a line break of at least 250 ms; a second one within 3 s resets the port to its factory state.
  void line_break(int port);

  /// Returns the bytes that have left the port by now, each once. With a `host_baud` (0: that of the port) other than
  /// the rate at which they were sent they are garbage.
  [[nodiscard]] std::vector<std::uint8_t> speak(int port, unsigned host_baud = 0);

  [[nodiscard]] unsigned baud(int port) const;

  /// Switches the power. Off: everything but the permanent memory is lost. On: the receiver boots, then prompts.
  void power(bool on);

  /// Sets the offset of every signal's C/N0 (fault injection).
  void set_cn0_offset_db(double offset_db);

  [[nodiscard]] ReceiverReport report() const;

 private:
  class Core;
  std::unique_ptr<Core> core_;
};

}  // namespace vbar::grand::bench
